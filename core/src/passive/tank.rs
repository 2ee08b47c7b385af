//! The energy a drive may spend.

use super::{PassiveError, half_of_range, positive};
use crate::Scalar;

/// Steps are counted in grains of 2^-10 J: what flows in a millisecond is some grains, so that fixed point resolves it,
/// and every scaling by a power of two is exact.
pub(super) const GRAINS: f64 = 1024.0;

/// The most that may flow in one step, in grains: the largest tank, or half of the range of a number type that has
/// less.
pub(super) fn largest_step<S: Scalar>() -> S {
    half_of_range::<S>().min(S::from_f64(GRAINS * 1024.0))
}

/// An energy tank without leak: it holds from 0 J to its capacity, and only [`Passive::step`](super::Passive::step)
/// changes it.
///
/// ```
/// use pliant_core::passive::{PassiveError, Tank};
/// let tank = Tank::new(1.0_f32, 2.0).unwrap();
/// assert_eq!((tank.energy(), tank.capacity()), (1.0, 2.0));
/// assert_eq!(Tank::new(3.0_f32, 2.0), Err(PassiveError::Energy));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tank<S> {
    /// J
    energy: S,
    /// What is stored beside `energy`, in grains, and too little to change it: a slow robot's step is less than the
    /// spacing of numbers at a full tank, and would be lost, or given for nothing.
    carry: S,
    /// J
    capacity: S,
}

/// How a step was settled: the part of the drive that was paid, and J.
pub(super) struct Settled<S> {
    pub scale: S,
    pub filled: S,
    pub drawn: S,
    pub rejected: S,
}

impl<S: Scalar> Tank<S> {
    /// A tank that holds `energy` of at most `capacity`, both in J.
    ///
    /// # Errors
    /// A capacity that is not above 0 and at most 1000 J, or an energy that is not from 0 to the capacity.
    pub fn new(energy: S, capacity: S) -> Result<Self, PassiveError> {
        if !positive(capacity) {
            return Err(PassiveError::Capacity);
        }
        if !(energy >= S::zero() && energy <= capacity) {
            return Err(PassiveError::Energy);
        }
        Ok(Self { energy, carry: S::zero(), capacity })
    }

    /// The energy stored, J, to the nearest number of its type.
    pub fn energy(&self) -> S {
        self.energy
    }

    /// The most it can store, J.
    pub fn capacity(&self) -> S {
        self.capacity
    }

    /// Takes `gain` in, pays `want`, both at least zero, and then `rounding`, all in grains.
    pub(super) fn settle(&mut self, gain: S, want: S, rounding: S) -> Settled<S> {
        let (grains, joules) = (S::from_f64(GRAINS), S::from_f64(1.0 / GRAINS));
        // More than any step can want counts as that much: a tank's energy in grains would leave the range of fixed
        // point.
        let enough = largest_step::<S>() * S::from_f64(1.5) * joules;
        let available = self.energy.min(enough) * grains + self.carry + gain - rounding;
        let available = available - available.abs() * (S::EPSILON * S::from_f64(4.0));
        if !(want <= available && available > S::zero()) {
            return self.spend_all(gain, want, available);
        }

        let change = self.carry + (gain - want - rounding);
        let excess = change - (self.capacity - self.energy) * grains;
        let rejected = excess.max(S::zero());
        if excess >= S::zero() {
            (self.energy, self.carry) = (self.capacity, S::zero());
        } else {
            // What the sum's rounding leaves out is carried.
            let sum = (self.energy + change * joules).max(S::zero()).min(self.capacity);
            self.carry = change - (sum - self.energy) * grains;
            self.energy = sum;
        }
        Settled {
            scale: S::one(),
            filled: (gain - rejected) * joules,
            drawn: (want + rounding) * joules,
            rejected: rejected * joules,
        }
    }

    /// The drive wants more than there is: it gets what there is, rounded down. Nothing wanted and nothing there is a
    /// robot at rest with an empty tank, which has no drive.
    fn spend_all(&mut self, gain: S, want: S, available: S) -> Settled<S> {
        let joules = S::from_f64(1.0 / GRAINS);
        let paid = if want > S::zero() { available / want - (S::EPSILON + S::EPSILON) } else { S::zero() };
        let drawn = self.energy + (self.carry + gain) * joules;
        (self.energy, self.carry) = (S::zero(), S::zero());
        Settled { scale: paid.max(S::zero()).min(S::one()), filled: gain * joules, drawn, rejected: S::zero() }
    }
}
