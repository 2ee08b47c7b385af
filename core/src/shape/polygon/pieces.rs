//! Keeping a point out of a polygon: convex pieces, and a half-space for each.
//!
//! A polygon is cut at its notches into convex pieces about the origin, and where one would go half round; what is outside of it, into sectors beyond
//! the edges. Off each of these, behind any line that has all of it behind, keeps off the whole, corners and notches included.

use super::{Edge, MAX_VERTICES, cross, dot, plane, size, sub, vector};
use crate::shape::Place;
use crate::{Scalar, Vector};

/// See [`crate::shape::Surface::keep_out`].
pub(super) fn keep_out<S: Scalar, const D: usize>(
    edges: impl Iterator<Item = Edge<S>>,
    at: &Place<'_, S, D>,
    mut keep: impl FnMut(Vector<S, D>, S),
) {
    let here = Here { u: plane(&at.u), wish: plane(&at.wish), share: at.share };
    let fastest = at.inverse.iter().fold(S::zero(), |m, i| m.max(*i));
    let mut all: heapless::Vec<Edge<S>, MAX_VERTICES> = heapless::Vec::new();
    for edge in edges {
        // Cannot be full, and `collect` would panic if it were.
        let _ = all.push(edge);
    }
    let body = Body { edges: all, wall: at.wall };
    body.pieces(|piece| {
        if let Some(side) = body.side(&piece, &here)
            && side.gap < at.reach * fastest * size(side.normal)
        {
            keep(vector::<S, D>(side.normal).component_mul(at.inverse), side.gap);
        }
    });
}

/// The point to keep out, where it wishes to go, and the share of its distance that it may use up.
struct Here<S> {
    u: [S; 2],
    wish: [S; 2],
    share: S,
}

/// What is to be kept out of: a polygon, or as a wall all that is outside of it.
struct Body<S> {
    edges: heapless::Vec<Edge<S>, MAX_VERTICES>,
    wall: bool,
}

/// Edges that follow each other: from the `first`, so many.
#[derive(Clone, Copy)]
struct Run {
    first: usize,
    count: usize,
}

/// A line to keep behind: its normal, of any length, how far u is beyond it, and how much of the share that may be used up the wish leaves (it is cut
/// by what is lacking), times that length.
struct Side<S> {
    normal: [S; 2],
    gap: S,
    left: S,
}

impl<S: Scalar> Here<S> {
    fn side(&self, normal: [S; 2], gap: S) -> Side<S> {
        Side { normal, gap, left: gap * self.share + dot(normal, self.wish) }
    }
}

impl<S: Scalar> Body<S> {
    /// The i-th edge, for i up to twice round and more.
    fn edge(&self, i: usize) -> Option<&Edge<S>> {
        let mut i = i;
        while i >= self.edges.len() && !self.edges.is_empty() {
            i -= self.edges.len();
        }
        self.edges.get(i)
    }

    /// Does the body stick out between the i-th edge and the next, so that the line of each has the other behind it?
    fn sticks_out(&self, i: usize) -> bool {
        let (Some(a), Some(b)) = (self.edge(i), self.edge(i + 1)) else { return false };
        let turn = cross(a.along, b.along);
        if self.wall { turn <= S::zero() } else { turn >= S::zero() }
    }

    /// Calls `each` with every convex piece: of a wall what is beyond one edge, within its sector; of a body from its first notch on once round,
    /// up to the next notch or to where it would go half round the origin.
    fn pieces(&self, mut each: impl FnMut(Run)) {
        let all = self.edges.len();
        if self.wall {
            return (0..all).for_each(|first| each(Run { first, count: 1 }));
        }
        let Some(notch) = (0..all).find(|i| !self.sticks_out(i + all - 1)) else {
            return each(Run { first: 0, count: all });
        };
        let mut piece = Run { first: notch, count: 0 };
        for i in notch..notch + all {
            let (Some(begin), Some(edge)) = (self.edge(piece.first), self.edge(i)) else { return };
            if piece.count > 0 && !(self.sticks_out(i - 1) && cross(begin.from, edge.to) > S::zero()) {
                each(piece);
                piece = Run { first: i, count: 0 };
            }
            piece.count += 1;
        }
        each(piece);
    }

    /// Has the i-th edge's line all of a piece behind it?
    fn holds(&self, i: usize, piece: &Run) -> bool {
        let Some(edge) = self.edge(i) else { return false };
        // What rounding lets stick out the line is moved for; see `side`.
        let rounding = S::rounding(size(edge.normal)) * S::from_f64(4.0);
        let behind = |v| {
            let over = dot(edge.normal, v) - S::one();
            if self.wall { over >= -rounding } else { over <= rounding }
        };
        self.run(piece).all(|e| behind(e.from) && behind(e.to))
    }

    fn run(&self, run: &Run) -> impl Iterator<Item = &Edge<S>> {
        let run = *run;
        (run.first..run.first + run.count).filter_map(|i| self.edge(i))
    }

    /// A piece's edges and, where it was cut off at a corner that sticks out, the edges there that have all of it behind them.
    fn outline(&self, piece: &Run) -> Run {
        let all = self.edges.len();
        let mut outline = *piece;
        while outline.count < all
            && self.sticks_out(outline.first + outline.count - 1)
            && self.holds(outline.first + outline.count, piece)
        {
            outline.count += 1;
        }
        while outline.count < all
            && self.sticks_out(outline.first + all - 1)
            && self.holds(outline.first + all - 1, piece)
        {
            outline = Run { first: outline.first + all - 1, count: outline.count + 1 };
            outline.first = if outline.first < all { outline.first } else { outline.first - all };
        }
        outline
    }

    /// The line to keep behind for a piece: moved out to where it has every corner of that behind it, whatever rounding made of its direction.
    fn side(&self, piece: &Run, here: &Here<S>) -> Option<Side<S>> {
        let chosen = self.chosen(piece, here)?;
        let held = self.held(piece, chosen.normal, chosen.gap, here);
        let rounding = S::rounding(size(held.normal)) * S::from_f64(4.0) * (S::one() + size(here.u));
        if held.gap + rounding >= chosen.gap {
            return Some(held);
        }
        // A short edge may be turned so far that its line is no longer the piece's. Then another line will do: along another edge, across the way from a
        // corner, or one through the origin.
        let mut best = Best { side: Some(held) };
        let mut consider = |side: Side<S>| best.consider(self.held(piece, side.normal, side.gap, here));
        for edge in self.run(&self.outline(piece)) {
            consider(self.beyond(edge, here));
        }
        for corner in self.run(piece).flat_map(|edge| [edge.from, edge.to]) {
            let (length, normal) = S::unit(sub(here.u, corner));
            if length > S::zero() && (self.wall || dot(normal, here.u) >= length) {
                consider(here.side(normal, length));
            }
        }
        if piece.count < self.edges.len() {
            self.through_origin(piece, here, consider);
        }
        best.side
    }

    /// Across this normal and no farther off than this gap, with every corner of a piece behind.
    fn held(&self, piece: &Run, normal: [S; 2], gap: S, here: &Here<S>) -> Side<S> {
        let corners = self.run(piece).flat_map(|edge| [edge.from, edge.to]);
        here.side(normal, corners.fold(gap, |least, v| least.min(dot(normal, sub(here.u, v)))))
    }

    /// The same but for rounding.
    fn chosen(&self, piece: &Run, here: &Here<S>) -> Option<Side<S>> {
        let whole = piece.count == self.edges.len();
        let outline = self.outline(piece);
        if let Some(side) = self.nearest(&outline, whole, here) {
            return Some(side);
        }
        let mut best = Best { side: None };
        self.run(&outline).for_each(|edge| best.consider(self.beyond(edge, here)));
        if !whole {
            self.through_origin(piece, here, |side| best.consider(side));
        }
        best.side
    }

    /// The sides along the rays through a piece's first and last corners, and across the way to the origin where all of it is beyond that. Only whoever is
    /// beyond one keeps behind it: from within, the way out is over an edge.
    fn through_origin(&self, piece: &Run, here: &Here<S>, mut consider: impl FnMut(Side<S>)) {
        let ends = self.edge(piece.first).zip(self.edge(piece.first + piece.count - 1));
        let Some((from, to)) = ends.map(|(first, last)| (first.from, last.to)) else { return };
        for normal in [[from[1], -from[0]], [-to[1], to[0]]] {
            let side = here.side(normal, dot(normal, here.u));
            if side.gap > S::zero() {
                consider(side);
            }
        }
        let (length, out) = S::unit(here.u);
        if length > S::zero() && [from, to].iter().all(|v| dot(*v, out) <= S::zero()) {
            consider(here.side(out, length));
        }
    }

    /// Behind an edge's line.
    fn beyond(&self, edge: &Edge<S>, here: &Here<S>) -> Side<S> {
        let over = dot(edge.normal, here.u) - S::one();
        if self.wall { here.side([-edge.normal[0], -edge.normal[1]], -over) } else { here.side(edge.normal, over) }
    }

    /// Across the way to the nearest point of an outline, if that is none of its ends and it is seen from in front. That of a polygon which is `whole`
    /// has no ends; any other has, if only the two sides of a notch.
    fn nearest(&self, outline: &Run, whole: bool, here: &Here<S>) -> Option<Side<S>> {
        // A corner counts where both edges say that it is nearer than they are: a line through it has both behind it then, to the last digit.
        let rounding = S::EPSILON * S::from_f64(8.0);
        let past = |edge: &Edge<S>| dot(sub(here.u, edge.to), edge.along);
        let mut before = if whole { self.edges.last().map(past) } else { None };
        let mut nearest: Option<(S, Option<Side<S>>)> = None;
        for (k, edge) in self.run(outline).enumerate() {
            let corner = sub(here.u, edge.from);
            let (ahead, over) = (-dot(corner, edge.along), past(edge));
            let found = if ahead >= rounding {
                match before {
                    Some(before) if before < rounding => None,
                    Some(_) => {
                        let (length, normal) = S::unit(corner);
                        Some((length, Some(here.side(normal, length))))
                    }
                    None => Some((S::norm(&corner), None)),
                }
            } else if over < rounding {
                let side = self.beyond(edge, here);
                let distance = side.gap.abs() / S::norm(&side.normal);
                Some((distance, (side.gap > S::zero()).then_some(side)))
            } else if k + 1 == outline.count && !whole {
                Some((S::norm(&sub(here.u, edge.to)), None))
            } else {
                None
            };
            before = Some(over);
            if let Some(found) = found
                && nearest.as_ref().is_none_or(|(least, _)| found.0 < *least)
            {
                nearest = Some(found);
            }
        }
        nearest?.1
    }
}

/// Of the lines that u is beyond, the one that cuts its wish the least; if it is beyond none, the one it is least behind.
struct Best<S> {
    side: Option<Side<S>>,
}

impl<S: Scalar> Best<S> {
    fn consider(&mut self, side: Side<S>) {
        let better = self.side.as_ref().is_none_or(|best| {
            let (own, other) = (S::norm(&side.normal), S::norm(&best.normal));
            match (side.gap > S::zero(), best.gap > S::zero()) {
                (true, true) => side.left * other > best.left * own,
                (false, false) => side.gap * other > best.gap * own,
                (beyond, _) => beyond,
            }
        });
        if better {
            self.side = Some(side);
        }
    }
}
