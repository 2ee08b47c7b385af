//! The convex pieces of a polygon, which follow from its shape alone: they are found once, when an obstacle is made.
//!
//! A polygon is cut at its notches into convex pieces about the origin, and where one would go half round; what is
//! outside of it, into sectors beyond the edges.

use super::{Edge, MAX_VERTICES, cross, dot, size};
use crate::Scalar;

/// Edges that follow each other, round and round: from the `first`, so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub first: u8,
    pub count: u8,
}

/// A convex piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// Its edges.
    pub edges: Run,
    /// These and, where it was cut off at a corner that sticks out, the edges there that have all of it behind them.
    pub outline: Run,
}

/// All pieces of a polygon, or as a wall of what is outside of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pieces {
    all: heapless::Vec<Piece, MAX_VERTICES>,
}

impl Pieces {
    pub(super) fn new<S: Scalar>(edges: impl Iterator<Item = Edge<S>>, wall: bool) -> Self {
        let mut cut = Cut { edges: heapless::Vec::new(), wall };
        for edge in edges {
            // Cannot be full, and `collect` would panic if it were.
            let _ = cut.edges.push(edge);
        }
        let mut all = heapless::Vec::new();
        cut.pieces(|edges| {
            // Nor can this: each has an edge of its own.
            let _ = all.push(Piece { edges, outline: cut.outline(&edges) });
        });
        Self { all }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// The edges of the i-th, as the first and how many; each ends at the polygon's corner of its own number, and they are counted on round it.
    pub fn edges(&self, i: usize) -> Option<(usize, usize)> {
        self.all.get(i).map(|piece| (usize::from(piece.edges.first), usize::from(piece.edges.count)))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Piece> {
        self.all.iter()
    }
}

/// What is cut: a polygon, or as a wall all that is outside of it.
struct Cut<S> {
    edges: heapless::Vec<Edge<S>, MAX_VERTICES>,
    wall: bool,
}

impl<S: Scalar> Cut<S> {
    fn count(&self) -> u8 {
        self.edges.len() as u8
    }

    /// The i-th edge, for i up to twice round and more.
    fn edge(&self, i: u8) -> Option<&Edge<S>> {
        let mut i = usize::from(i);
        while i >= self.edges.len() && !self.edges.is_empty() {
            i -= self.edges.len();
        }
        self.edges.get(i)
    }

    /// Does the body stick out between the i-th edge and the next, so that the line of each has the other behind it?
    fn sticks_out(&self, i: u8) -> bool {
        let (Some(a), Some(b)) = (self.edge(i), self.edge(i + 1)) else { return false };
        let turn = cross(a.along, b.along);
        if self.wall { turn <= S::zero() } else { turn >= S::zero() }
    }

    /// Calls `each` with every convex piece: of a wall what is beyond one edge, within its sector; of a body from its
    /// first notch on once round, up to the next notch or to where it would go half round the origin.
    fn pieces(&self, mut each: impl FnMut(Run)) {
        let all = self.count();
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
                piece = Run { first: if i < all { i } else { i - all }, count: 0 };
            }
            piece.count += 1;
        }
        each(piece);
    }

    /// Has the i-th edge's line all of a piece behind it?
    fn holds(&self, i: u8, piece: &Run) -> bool {
        let Some(edge) = self.edge(i) else { return false };
        // What rounding lets stick out the line is moved for, when it is kept behind.
        let rounding = S::rounding(size(edge.normal)) * S::from_f64(4.0);
        let behind = |v| {
            let over = dot(edge.normal, v) - S::one();
            if self.wall { over >= -rounding } else { over <= rounding }
        };
        (piece.first..piece.first + piece.count).filter_map(|i| self.edge(i)).all(|e| behind(e.from) && behind(e.to))
    }

    fn outline(&self, piece: &Run) -> Run {
        let all = self.count();
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
            let before = outline.first + all - 1;
            outline = Run { first: if before < all { before } else { before - all }, count: outline.count + 1 };
        }
        outline
    }
}
