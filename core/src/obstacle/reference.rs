//! Where an obstacle's reference point is.

use super::Obstacle;
use crate::shape::root;
use crate::{Scalar, Vector, is_zero, times, transposed_times};

/// The share of n.r that is left where r leads from nearer to the root of a tree.
const KEPT: f64 = 0.1;

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// The reference point in the world's frame as it is now, m, from which r of the modulation leads: its own, or
    /// one that it shares with obstacles it overlaps (see [`table`](crate::table)).
    pub fn reference(&self) -> Vector<S, D> {
        self.spec.center + self.offset
    }

    /// The gauge |q|/R(q) of the shape, of a wall's too, at any distance, and its normal there, of any length; both zero at the centre.
    pub(crate) fn gauge(&self, x: &Vector<S, D>) -> (S, Vector<S, D>) {
        let u = self.scaled(x);
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        if !(largest > S::zero()) {
            return (S::zero(), Vector::zeros());
        }
        let (gamma, direction) = self.body.level(&self.spec.shape, &(u / largest));
        (largest * root(gamma, self.body.power()), self.outward(&direction))
    }

    /// A direction of scaled coordinates, as a normal in the world's frame, of any length.
    fn outward(&self, direction: &Vector<S, D>) -> Vector<S, D> {
        // Scaled by one over the shortest axis a normal could leave the range.
        let most = self.steepest();
        times(&self.spec.rotation, &direction.zip_map(&self.hard, |d, hard| d * (hard / most)))
    }

    /// The reference point of the root of the tree of overlapping cores it belongs to (world's frame, m); `None`
    /// without one. r leads from there as far as it can:
    ///
    /// ```text
    /// r - s h,   s = min(1, 0.9 (g.r)/(g.h))      1 where g.h <= 0, 0 where g.r <= 0
    /// ```
    ///
    /// with r from its own reference point and h from there to the hub, so that g.r keeps at least a tenth of what it
    /// was.
    pub fn hub(&self) -> Option<Vector<S, D>> {
        self.leans.then(|| self.reference() + self.lean)
    }

    /// How far r leans, in a tree, from the own reference point (0) to the root's (1): as far as leaves n.r the share
    /// [`KEPT`] of what it is from its own. Where the tree is seen from its root all members have r in common, and no
    /// notch is a pocket. `outward` is n, of any length, `own` r from its own.
    #[inline(always)]
    pub(super) fn leaning(&self, outward: &Vector<S, D>, own: &Vector<S, D>) -> S {
        let along = |v: &Vector<S, D>| S::dot(outward.as_slice(), v.as_slice());
        let (left, falls) = (along(own) * S::from_f64(1.0 - KEPT), along(&self.lean));
        if !(left > S::zero()) {
            S::zero()
        } else if falls > left {
            left / falls
        } else {
            S::one()
        }
    }

    /// Leans towards the reference point of a tree's root (world's frame, m), or no longer towards any.
    pub(crate) fn lean_towards(&mut self, root: Option<&Vector<S, D>>) {
        let lean = root.map_or_else(Vector::zeros, |root| root - self.reference());
        self.leans = !is_zero(&lean);
        self.sort();
        (self.lean, self.local_lean) = (lean, transposed_times(&self.spec.rotation, &lean));
        self.place_reference();
    }

    /// Takes a reference point (world's frame, m) in common with others, or its own again.
    pub(crate) fn share_reference(&mut self, shared: Option<&Vector<S, D>>) {
        (self.local_reference, self.chosen_at) = match shared {
            Some(x) => (self.local(x), self.hard),
            None => (self.spec.reference, self.unit.map(|unit| S::one() / unit)),
        };
        (self.leans, self.lean, self.local_lean) = (false, Vector::zeros(), Vector::zeros());
        self.offset = Vector::zeros();
        self.sort();
        self.place_reference();
    }

    /// A core that is smaller than it was has its reference point nearer to its centre, for it must not leave it.
    pub(super) fn place_reference(&mut self) {
        if self.leans {
            self.lean = times(&self.spec.rotation, &self.local_lean);
        }
        if !is_zero(&self.local_reference) {
            let shrunk = self.chosen_at.zip_map(&self.hard, |then, now| if now > then { then / now } else { S::one() });
            self.offset = times(&self.spec.rotation, &self.local_reference.component_mul(&shrunk));
        }
    }
}
