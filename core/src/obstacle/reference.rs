//! Where an obstacle's reference point is.

use super::Obstacle;
use crate::{Scalar, Vector, is_zero, times, transposed_times};

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// The reference point in the world's frame, m: its own, or one that it shares with obstacles it overlaps.
    pub fn reference(&self) -> Vector<S, D> {
        self.spec.center + self.offset
    }

    /// Below 1 where its reference point may be (not a wall's): Gamma, but of a polygon by what is seen from there.
    pub(crate) fn sight(&self, x: &Vector<S, D>) -> S {
        self.body.sight(&self.spec.shape, &self.scaled(x)).0
    }

    /// The direction in which that grows.
    pub(crate) fn sight_slope(&self, x: &Vector<S, D>) -> Vector<S, D> {
        let u = self.scaled(x);
        transposed_times(&self.scaling, &self.body.sight(&self.spec.shape, &u).1)
    }

    /// Takes a reference point (world's frame, m) in common with others, or its own again.
    pub(crate) fn share_reference(&mut self, shared: Option<&Vector<S, D>>) {
        (self.local_reference, self.chosen_at) = match shared {
            Some(x) => (self.local(x), self.hard),
            None => (self.spec.reference, self.unit.map(|unit| S::one() / unit)),
        };
        self.place_reference();
    }

    /// A core that is smaller than it was has its reference point nearer to its centre, for it must not leave it.
    pub(super) fn place_reference(&mut self) {
        if is_zero(&self.local_reference) {
            self.offset = Vector::zeros();
            return;
        }
        let shrunk = self.chosen_at.zip_map(&self.hard, |then, now| if now > then { then / now } else { S::one() });
        self.offset = times(&self.spec.rotation, &self.local_reference.component_mul(&shrunk));
    }
}
