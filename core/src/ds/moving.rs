//! A motion whose attractor moves.

use super::Motion;
use crate::{Scalar, Vector, in_range};

/// A motion carried along with its attractor:
///
/// ```text
/// f(x, t) = f0(x - d(t)) + v,   d(t) = d(0) + v t
/// ```
///
/// where d (m) is how far the attractor is from where the motion was learnt. With the attractor's own velocity fed
/// forward, what is relative to it converges as proven: the certificate holds in the moving frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving<S: Scalar, const D: usize> {
    motion: Motion<S, D>,
    shift: Vector<S, D>,
    velocity: Vector<S, D>,
}

impl<S: Scalar, const D: usize> Moving<S, D> {
    /// At rest, where the motion was learnt.
    pub fn new(motion: Motion<S, D>) -> Self {
        Self { motion, shift: Vector::zeros(), velocity: Vector::zeros() }
    }

    /// The motion as it was learnt.
    pub fn motion(&self) -> &Motion<S, D> {
        &self.motion
    }

    /// v, the attractor's velocity, m/s.
    pub fn drift(&self) -> &Vector<S, D> {
        &self.velocity
    }

    /// Where the attractor is now, x* + d(t), m.
    pub fn attractor(&self) -> Vector<S, D> {
        self.motion.attractor() + self.shift
    }

    /// The velocity relative to the attractor's at x (m), f0(x - d(t)), m/s: zero at the attractor.
    pub fn relative(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.motion.velocity(&(x - self.shift))
    }

    /// Puts the attractor at `position` (m), moving at `velocity` (m/s); false, and nothing changed, if one is out of
    /// range.
    pub(crate) fn aim(&mut self, position: &Vector<S, D>, velocity: &Vector<S, D>) -> bool {
        let max_speed = S::from_f64(crate::obstacle::MAX_SPEED);
        if !in_range(position) || !velocity.iter().all(|v| v.abs() <= max_speed) {
            return false;
        }
        (self.shift, self.velocity) = (position - self.motion.attractor(), *velocity);
        true
    }

    /// Carries the attractor on by `dt` seconds, up to the end of the range.
    pub(crate) fn advance(&mut self, dt: S) {
        if crate::is_zero(&self.velocity) {
            return;
        }
        let shift = self.shift + self.velocity * dt;
        if in_range(&(self.motion.attractor() + shift)) {
            self.shift = shift;
        } else {
            self.velocity = Vector::zeros();
        }
    }
}
