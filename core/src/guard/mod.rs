//! The last stage: whatever was asked for, the next sample is outside every hard core.
//!
//! For each hard core near enough to be reached, as it will be at the next sample (pose, growth and all), there is a half-space that holds the
//! whole of it on its other side. With n its normal and gap its distance from the robot at x,
//!
//! ```text
//! n.u >= -alpha gap/dt   (gap >= 0),    n.u >= -gap/dt   (gap < 0: it will be here, so out of its way)
//! ```
//!
//! keeps x + u dt out of a convex core exactly, not only in the limit dt -> 0: the half-space is that of the next sample, so no velocity of
//! the obstacle and no second order of its turning enters. Of all u that fulfil every inequality and |u| <= speed the one nearest to what was
//! wanted is driven; where there is none, the one that violates the worst inequality least, and the status says so.
//!
//! What is exact: ellipsoids, boxes, cylinders, capsules, points of a scan, and polygons, whose triangles are convex. A wall's free space is
//! convex but for polygons; a half-space would let a step end outside of its curve, so it is moved inwards by what the curve can bend within
//! one step.

mod program;

pub use program::{HalfSpace, Solution, nearest};

use crate::surroundings::Surroundings;
use crate::table::Table;
use crate::{Scalar, Vector};

/// Most half-spaces of one tick; beyond it those that bind the least are left out.
const CAPACITY: usize = 192;

/// The least skin, m: 2^-16, what fixed point needs within a metre. The same for all numbers, so that in a wedge between two surfaces, where
/// some micrometres of room decide how fast it goes on, they agree.
const SKIN: f64 = 1.0 / 65536.0;

/// The share of the skin that one sample makes up for in its outer half: more than rounding takes, and no more of a push than that.
const HOLD: f64 = 0.06;

/// How the guard lets the robot come near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guard<S> {
    /// alpha, above 0, at most 1: the share of the distance to a core that one sample may use up.
    pub approach: S,
}

impl<S: Scalar> Default for Guard<S> {
    /// 0.02: at 1 kHz a fifth of the distance in 10 ms, so that a robot that follows its command with such a lag does not overshoot.
    fn default() -> Self {
        Self { approach: S::from_f64(0.02) }
    }
}

impl<S: Scalar> Guard<S> {
    /// Surfaces farther away than this do not bind, m.
    pub(crate) fn reach<const D: usize>(&self, x: &Vector<S, D>, speed: S, dt: S) -> S {
        let skin = skin(x);
        speed * dt / self.approach + skin + skin
    }

    /// The velocity nearest to `wanted` that keeps the sample after x out of every core of `table`, which is that of the next sample.
    /// `around` is what was seen from x at this one.
    pub(crate) fn apply<const D: usize, const CAP: usize>(
        &self,
        x: &Vector<S, D>,
        wanted: &Vector<S, D>,
        speed: S,
        dt: S,
        table: &Table<S, D, CAP>,
        around: &Surroundings<S, D, CAP>,
    ) -> Solution<S, D> {
        let step = speed * dt;
        let skin = skin(x);
        let reach = self.reach(x, speed, dt);
        let rate = S::one() / dt;
        let mut all: HalfSpaces<S, D> = heapless::Vec::new();
        let mut keep = |normal: Vector<S, D>, gap: S| {
            let room = gap - skin;
            let share = if room > S::zero() {
                self.approach
            } else if gap + gap >= skin {
                S::from_f64(HOLD)
            } else {
                S::one()
            };
            let offset = -(room * share * rate);
            // What no velocity can violate need not be looked at.
            if offset > -speed {
                add(&mut all, HalfSpace { normal, offset });
            }
        };
        for (index, reach) in &around.near {
            if let Some(obstacle) = table.at(*index) {
                obstacle.keep_out(x, &(wanted * dt), step, *reach, &mut keep);
            }
        }
        table.scan().keep_out(x, reach, &mut keep);
        nearest(wanted, &mut all, speed)
    }
}

type HalfSpaces<S, const D: usize> = heapless::Vec<HalfSpace<S, D>, CAPACITY>;

/// Puts a half-space in; where there is no room, in the place of the loosest.
fn add<S: Scalar, const D: usize>(all: &mut HalfSpaces<S, D>, new: HalfSpace<S, D>) {
    let Err(new) = all.push(new) else { return };
    let loosest = all.iter_mut().fold(None, |loosest: Option<&mut HalfSpace<S, D>>, h| match loosest {
        Some(l) if l.offset <= h.offset => Some(l),
        _ => Some(h),
    });
    if let Some(loosest) = loosest
        && loosest.offset < new.offset
    {
        *loosest = new;
    }
}

/// A surface is kept this far away, m: what rounding may do to a distance between two points of this size, and no less than [`SKIN`].
fn skin<S: Scalar, const D: usize>(x: &Vector<S, D>) -> S {
    let largest = x.iter().fold(S::one(), |m, x| m.max(x.abs()));
    (S::EPSILON * S::from_f64(16.0) * largest).max(S::from_f64(SKIN))
}
