//! How fast obstacles move and turn, at most: what their velocity at one place does not say of where they will be.

use crate::guard::Stride;
use crate::{Obstacle, RANGE, Scalar};

/// A step that is longer than this may pass several ages at once, s; in a shorter one an obstacle does all of it what it did at its beginning,
/// which is what the guard saw coming.
pub(super) const LONG: f64 = 0.1;

/// A turn by more than this in one step, rad, may bring a surface from anywhere.
const WIDE: f64 = 0.25;

/// Of all obstacles in a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace<S> {
    /// |v|, m/s.
    speed: S,
    /// |w|, rad/s.
    spin: S,
}

impl<S: Scalar> Default for Pace<S> {
    fn default() -> Self {
        Self { speed: S::zero(), spin: S::zero() }
    }
}

impl<S: Scalar> Pace<S> {
    pub fn of<'a, const D: usize>(obstacles: impl Iterator<Item = &'a Obstacle<S, D>>) -> Self {
        let sum = |numbers: &[S]| numbers.iter().fold(S::zero(), |sum, x| sum + x.abs());
        obstacles.map(Obstacle::spec).fold(Self::default(), |most, spec| Self {
            speed: most.speed.max(sum(spec.velocity.as_slice())),
            // Each of its entries is there twice.
            spin: most.spin.max(sum(spec.spin.as_slice()) * S::from_f64(0.5)),
        })
    }

    /// How much farther a surface may come within one step than twice what its velocity at x, s, says, m. With theta = |w| dt, what was d away comes by
    ///
    /// ```text
    /// (|s| dt + theta d)(1 + theta/2) + theta |v| dt/2
    /// ```
    ///
    /// at most; so what a step and the skin can meet is not farther away than their sum, 2 |s| dt and this, as long as theta is not above a quarter.
    /// Where it is, or where the step is long, all there is may be met.
    pub fn turning(&self, stride: &Stride<S>) -> S {
        let turn = self.spin * stride.dt;
        if turn > S::from_f64(WIDE) || stride.dt > S::from_f64(LONG) {
            return S::from_f64(4.0 * RANGE);
        }
        turn * (stride.length + stride.length + self.speed * stride.dt)
    }
}
