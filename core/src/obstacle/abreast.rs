//! Several obstacles of the usual kind as they look from one point, in vector lanes.

use core::array::from_fn;

use super::Obstacle;
use crate::scalar::lanes::{LANES, Lanes};
use crate::{Scalar, Vector};

/// What the modulation wants to know of obstacles at rest, side by side; see [`Sample`](super::Sample).
pub(crate) struct Abreast<S: Scalar, const D: usize> {
    pub gamma: S::Lanes,
    pub outward: [S::Lanes; D],
    pub arm: [S::Lanes; D],
}

impl<S: Scalar, const D: usize> Abreast<S, D> {
    /// Is there anything to gain? Not with one lane, nor in fixed point, which has no such registers, nor in space with `f64`, of which
    /// more numbers have to be gathered than registers hold.
    pub const WORTH_IT: bool = S::FLOATS && LANES > 1 && size_of::<[S; D]>() <= 16;

    /// How obstacles of the usual kind look from x, with the bits that [`Obstacle::sample`] gives; `None` if one is
    /// of another, or too far to matter.
    #[inline(always)]
    pub fn new(few: [&Obstacle<S, D>; LANES], x: &Vector<S, D>) -> Option<Self> {
        if !few.iter().all(|o| o.usual) {
            return None;
        }
        let away: [S::Lanes; D] = from_fn(|d| S::Lanes::splat(x[d]) - each(few, |o| o.spec.center[d]));
        let scaling: [[S::Lanes; D]; D] = from_fn(|i| from_fn(|j| each(few, |o| o.scaling[(i, j)])));
        let u: [S::Lanes; D] = from_fn(|i| S::Lanes::dot(&scaling[i], &away));
        let gamma = S::Lanes::dot(&u, &u);
        if S::Lanes::any_but(S::Lanes::mask(true), gamma.below(S::Lanes::splat(S::FAR))) {
            return None;
        }
        let outward = from_fn(|j| S::Lanes::dot(&from_fn(|i| scaling[i][j]), &u));
        let arm = from_fn(|d| away[d] - each(few, |o| o.offset[d]));
        Some(Self { gamma, outward, arm })
    }
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Is it of the usual kind? To be asked again whenever it begins to move, or to lean, or ends.
    pub(super) fn sort(&mut self) {
        self.usual = Abreast::<S, D>::WORTH_IT && self.plain && !self.moves && !self.leans;
    }
}

/// A number of each.
#[inline(always)]
fn each<S: Scalar, const D: usize>(few: [&Obstacle<S, D>; LANES], number: impl Fn(&Obstacle<S, D>) -> S) -> S::Lanes {
    S::Lanes::new(&few.map(number))
}
