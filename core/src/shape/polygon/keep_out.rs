//! Keeping a point out of a polygon: a half-space for each of its convex pieces.
//!
//! Off a piece, behind any line that has all of it behind, keeps off it exactly; off every piece, off the whole,
//! corners and notches included.

use super::pieces::{Piece, Pieces, Run};
use super::{MAX_VERTICES, dot, plane, size, sub, vector};
use crate::shape::Place;
use crate::{Scalar, Vector};

/// See [`crate::shape::Surface::keep_out`]; an edge goes from one corner to the next.
pub(super) fn keep_out<S: Scalar, const D: usize>(
    edges: impl Iterator<Item = ([S; 2], [S; 2])>,
    pieces: &Pieces,
    at: &Place<'_, S, D>,
    mut keep: impl FnMut(Vector<S, D>, S),
) {
    let fastest = at.inverse.iter().fold(S::zero(), |m, i| m.max(*i));
    let mut view =
        View { edges: heapless::Vec::new(), wall: at.wall, u: plane(&at.u), wish: plane(&at.wish), share: at.share };
    view.look(edges);
    for piece in pieces.iter() {
        if let Some(side) = view.side(piece)
            && side.gap < at.reach * fastest
        {
            keep(vector::<S, D>(side.normal).component_mul(at.inverse), side.gap);
        }
    }
}

/// A polygon's edges (of a wall: of all that is outside) as they look from the point to keep out, where that wishes
/// to go, and the share of its distance that it may use up.
struct View<S> {
    edges: heapless::Vec<Seen<S>, MAX_VERTICES>,
    wall: bool,
    u: [S; 2],
    wish: [S; 2],
    share: S,
}

/// An edge as it looks from u.
struct Seen<S> {
    from: [S; 2],
    to: [S; 2],
    /// Its line to keep behind.
    line: Side<S>,
    along: Along,
    /// Where u is before it, the distance of its first corner; where u is within it, of its line.
    distance: S,
}

/// Where a point is along an edge.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Along {
    /// Before its first corner.
    Before,
    Within,
    /// Beyond its last.
    Past,
}

/// A line to keep behind: its unit normal, and how far u is beyond it.
#[derive(Clone, Copy)]
struct Side<S> {
    normal: [S; 2],
    gap: S,
}

/// What is nearest of an outline.
#[derive(Clone, Copy)]
enum Nearest<'a, S> {
    /// A point within an edge.
    Edge(&'a Seen<S>),
    /// The corner that an edge begins with, where its outline has the one before, too.
    Corner(&'a Seen<S>),
    /// One of its ends.
    End,
}

impl<S: Scalar> View<S> {
    fn look(&mut self, edges: impl Iterator<Item = ([S; 2], [S; 2])>) {
        // A corner counts where both edges say that it is nearer than they are: a line through it has both behind it
        // then, to the last digit.
        let rounding = S::EPSILON * S::from_f64(8.0);
        for (from, to) in edges {
            let (corner, along) = (sub(self.u, from), sub(to, from));
            let ahead = S::unit(along).1;
            let normal = if self.wall { [-ahead[1], ahead[0]] } else { [ahead[1], -ahead[0]] };
            let line = Side { normal, gap: dot(normal, corner) };
            let (along, distance) = if -dot(corner, along) >= rounding {
                (Along::Before, S::norm(&corner))
            } else if dot(sub(self.u, to), along) < rounding {
                (Along::Within, line.gap.abs())
            } else {
                (Along::Past, S::MAX)
            };
            // Cannot be full: a polygon has no more.
            let _ = self.edges.push(Seen { from, to, line, along, distance });
        }
    }

    /// Calls `each` with every edge of a run.
    fn each<'a>(&'a self, run: &Run, mut each: impl FnMut(&'a Seen<S>)) {
        let mut i = usize::from(run.first);
        for _ in 0..run.count {
            let Some(edge) = self.edges.get(i) else { return };
            each(edge);
            i += 1;
            if i == self.edges.len() {
                i = 0;
            }
        }
    }

    /// The line to keep behind for a piece: moved out to where it has every corner of that behind it, whatever
    /// rounding made of its direction.
    fn side(&self, piece: &Piece) -> Option<Side<S>> {
        let chosen = self.chosen(piece)?;
        let held = self.held(piece, chosen);
        let rounding = S::rounding(S::one()) * S::from_f64(4.0) * (S::one() + size(self.u));
        if held.gap + rounding >= chosen.gap {
            return Some(held);
        }
        // A short edge may be turned so far that its line is no longer the piece's. Then another line will do: along
        // another edge, across the way from a corner, or one through the origin.
        let mut best = self.best();
        best.consider(held);
        self.each(&piece.outline, |edge| best.consider(self.held(piece, edge.line)));
        self.each(&piece.edges, |edge| {
            for corner in [edge.from, edge.to] {
                let (gap, normal) = S::unit(sub(self.u, corner));
                // Of a body the origin is to be behind it, too.
                if gap > S::zero() && (self.wall || dot(normal, self.u) >= gap) {
                    best.consider(self.held(piece, Side { normal, gap }));
                }
            }
        });
        if usize::from(piece.edges.count) < self.edges.len() {
            self.beside(&piece.edges, |side| best.consider(self.held(piece, side)));
        }
        Some(best.best?.side)
    }

    /// A line no farther out than this one that has every corner of a piece behind it.
    fn held(&self, piece: &Piece, side: Side<S>) -> Side<S> {
        let mut gap = side.gap;
        self.each(&piece.edges, |edge| {
            for corner in [edge.from, edge.to] {
                gap = gap.min(dot(side.normal, sub(self.u, corner)));
            }
        });
        Side { gap, ..side }
    }

    fn best(&self) -> Best<S> {
        Best { wish: self.wish, share: self.share, best: None }
    }

    /// The same but for rounding.
    fn chosen(&self, piece: &Piece) -> Option<Side<S>> {
        let whole = usize::from(piece.edges.count) == self.edges.len();
        match self.nearest(&piece.outline, whole) {
            Nearest::Edge(edge) if edge.line.gap > S::zero() => return Some(edge.line),
            Nearest::Corner(edge) => {
                let (gap, normal) = S::unit(sub(self.u, edge.from));
                return Some(Side { normal, gap });
            }
            _ => {}
        }
        let mut best = self.best();
        self.each(&piece.outline, |edge| best.consider(edge.line));
        if !whole {
            self.beside(&piece.edges, |side| best.consider(side));
        }
        Some(best.best?.side)
    }

    /// The sides along the rays through a piece's first and last corners, and across the way to the origin where all
    /// of it is beyond that. Only whoever is beyond one keeps behind it: from within, the way out is over an edge.
    fn beside(&self, piece: &Run, mut consider: impl FnMut(Side<S>)) {
        let (mut first, mut last) = (None, None);
        self.each(piece, |edge| {
            first = first.or(Some(edge.from));
            last = Some(edge.to);
        });
        let (Some(from), Some(to)) = (first, last) else { return };
        for normal in [[from[1], -from[0]], [-to[1], to[0]]] {
            if dot(normal, self.u) > S::zero() {
                let normal = S::unit(normal).1;
                consider(Side { normal, gap: dot(normal, self.u) });
            }
        }
        let (gap, normal) = S::unit(self.u);
        if gap > S::zero() && [from, to].iter().all(|v| dot(*v, normal) <= S::zero()) {
            consider(Side { normal, gap });
        }
    }

    /// What is nearest of an outline. That of a polygon which is `whole` has no ends; any other has, if only the two sides of a notch.
    fn nearest(&self, outline: &Run, whole: bool) -> Nearest<'_, S> {
        // Where u is along the edge before, if there is one.
        let mut before = if whole { self.edges.last().map(|e| e.along) } else { None };
        let (mut least, mut nearest) = (S::MAX, Nearest::End);
        let mut last = None;
        self.each(outline, |edge| {
            let found = match (edge.along, before) {
                (Along::Before, Some(Along::Past)) => Some(Nearest::Corner(edge)),
                (Along::Before, None) => Some(Nearest::End),
                (Along::Within, _) => Some(Nearest::Edge(edge)),
                (Along::Before, Some(_)) | (Along::Past, _) => None,
            };
            if let Some(found) = found
                && edge.distance < least
            {
                (least, nearest) = (edge.distance, found);
            }
            (before, last) = (Some(edge.along), Some(edge));
        });
        match last {
            Some(edge) if !whole && edge.along == Along::Past && S::norm(&sub(self.u, edge.to)) < least => Nearest::End,
            _ => nearest,
        }
    }
}

/// Of the lines that u is beyond, the one that cuts its wish the least (that leaves most of the share that may be
/// used up); if it is beyond none, the one it is least behind.
struct Best<S> {
    wish: [S; 2],
    share: S,
    best: Option<Candidate<S>>,
}

struct Candidate<S> {
    side: Side<S>,
    /// What the wish leaves.
    left: S,
}

impl<S: Scalar> Best<S> {
    fn consider(&mut self, side: Side<S>) {
        let left = side.gap * self.share + dot(side.normal, self.wish);
        let better = self.best.as_ref().is_none_or(|best| match (side.gap > S::zero(), best.side.gap > S::zero()) {
            (true, true) => left > best.left,
            (false, false) => side.gap > best.side.gap,
            (beyond, _) => beyond,
        });
        if better {
            self.best = Some(Candidate { side, left });
        }
    }
}
