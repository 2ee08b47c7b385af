//! The last stage: whatever was asked for, the next sample is outside every hard core.
//!
//! For each hard core near enough to be reached, as it will be at the next sample (pose, growth and all), there is a
//! half-space that holds the whole of it on its other side. With n its normal, gap its distance from the robot at x
//! (of a large body less what rounding does to that), and room what is left beyond a skin,
//!
//! ```text
//! n.u >= -alpha room/dt   (room > 0)
//! n.u >= -0.06 room/dt    (room <= 0, in the outer half of the skin)
//! n.u >= -room/dt         (nearer, or behind: it will be here, so out of its way)
//! ```
//!
//! keeps x + u dt out of a convex core exactly, not only in the limit dt -> 0: the half-space is that of the next
//! sample, so no velocity of the obstacle and no second order of its turning enters. Of all u that fulfil every
//! inequality and |u| <= speed the one nearest to what was wanted is driven. One half-space a core is enough to be
//! outside and more than is needed: where none fulfils them all, those that hold the cores as seen from where the
//! least violation leads are tried, without alpha and, but for rounding, without the skin; then a few other places
//! of the next sample, walls by their tangents. Where that fails too, or where it is known that the cores hold every
//! place within a step, the velocity that violates the worst inequality least is driven, and the status says so.
//!
//! What is exact: superellipsoids, boxes, cylinders, capsules, points of a scan, and polygons, by their convex
//! pieces. A wall's free space is convex but for polygons; a half-space would let a step end outside of its curve, so
//! it is moved inwards by what the curve can bend within one step.
//!
//! n is a unit vector in the world's frame that points to where the robot may be; gap, room and skin are in m, u and
//! speed in m/s, dt in s; alpha is [`Guard::approach`]. By shape, with Gamma, lambda and p from
//! [`obstacle`](crate::obstacle) and [`shape`](crate::shape),
//!
//! ```text
//! superellipsoid           n = g/|g|                    gap = n.(x - y),  y = c + (x - c) Gamma^(-1/2p)
//! box, cylinder, capsule   n along grad lambda          gap = (lambda - 1)/|grad lambda|
//! point of a scan          n = (x - p_i)/|x - p_i|      gap = |x - p_i| - R
//! polygon                  one for each convex piece: off its nearest edge, or its nearest corner
//! wall                     n inwards                    gap = the tangent's, less what the curve bends within speed dt
//!
//! room = gap - skin,   skin = max(2^-16 m, 16 eps max(1 m, |x_i|, 8 speed dt)),   eps: Scalar::EPSILON (in fixed point 8 dt m/s for |x_i|)
//! ```
//!
//! [`Status::GUARDED`](crate::Status::GUARDED) says that the command is another than was wanted,
//! [`Status::INFEASIBLE`](crate::Status::INFEASIBLE) that none was found that keeps the next sample out, and standing still
//! does not either. The guard may change the
//! velocity by more than the acceleration limit, never beyond the speed. The papers have no such stage: it is ours, but
//! for the way in which the nearest velocity is found ([`nearest`], known from ORCA, van den Berg et al. 2011). Polygons
//! and walls in full are in section 7 of `docs/method.md`.

mod program;
mod search;

use core::cmp::Ordering;

pub use program::{HalfSpace, Solution, nearest};
use program::{allowed, least, nearest_of_least};

use crate::obstacle::{Engulfed, Outlook};
use crate::surroundings::Surroundings;
use crate::table::Table;
use crate::{Obstacle, Scalar, Vector};

/// Most half-spaces of one tick; those that bind the least and find no room are kept by going more slowly.
const CAPACITY: usize = 192;

/// The least skin, m: 2^-16, what fixed point needs within a metre. The same for all numbers, so that in a wedge
/// between two surfaces, where some micrometres of room decide how fast it goes on, they agree.
const SKIN: f64 = 1.0 / 65536.0;

/// The share of the skin that one sample makes up for in its outer half: more than rounding takes, and no more of a push than that.
const HOLD: f64 = 0.06;

/// Where the skin cannot be kept, a core itself is kept off by so many units of rounding.
const BARE: f64 = 4.0;

/// How the guard lets the robot come near: n.u >= -alpha room/dt. The [module](self) has the rest.
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
    /// What a step of `dt` (s) from x may lead to, no faster than `speed` (m/s).
    pub(crate) fn stride<const D: usize>(&self, x: &Vector<S, D>, speed: S, dt: S) -> Stride<S> {
        let length = speed * dt;
        // In fixed point slow velocities are as coarse as those of 1 m/s.
        let unit = rounding(x, if S::FLOATS { length } else { length.max(dt) });
        let skin = (unit * S::from_f64(16.0)).max(S::from_f64(SKIN));
        Stride { speed, dt, length, unit, skin, reach: length / self.approach + skin + skin }
    }

    /// The velocity nearest to `wanted` that keeps the sample after x out of every core of `table`, which is that of the next sample.
    /// `around` is what was seen from x at this one.
    pub(crate) fn apply<const D: usize, const CAP: usize>(
        &self,
        x: &Vector<S, D>,
        wanted: &Vector<S, D>,
        stride: &Stride<S>,
        table: &Table<S, D, CAP>,
        around: &Surroundings<S, D, CAP>,
    ) -> Solution<S, D> {
        let next = Next { x, wanted, stride, table, near: &around.near };
        let mut seen = HalfSpaces::new(stride.speed);
        let here = View { at: x, step: stride.length, approach: self.approach, skin: stride.skin, near: next.near };
        self.look(&next, &here, &mut seen);
        let best = seen.least(wanted);
        if best.feasible { best } else { self.otherwise(&next, &mut seen, best) }
    }

    /// What is left where not every half-space of those `seen` can be fulfilled, and `best` violates them least.
    #[cold]
    #[inline(never)]
    fn otherwise<const D: usize, const CAP: usize>(
        &self,
        next: &Next<'_, S, D, CAP>,
        seen: &mut HalfSpaces<S, D>,
        best: Solution<S, D>,
    ) -> Solution<S, D> {
        let mut near = heapless::Vec::new();
        if next.may_lead_out(&best.velocity, &mut near)
            && let Some(velocity) = self.another(&Next { near: &near, ..*next }, &best.velocity)
        {
            return Solution::found(velocity, next.wanted);
        }
        seen.nearest_of_least(next.wanted, best)
    }

    /// A velocity whose next sample is outside of every core, though half-spaces from x leave none; `best` violates them least.
    fn another<const D: usize, const CAP: usize>(
        &self,
        next: &Next<'_, S, D, CAP>,
        best: &Vector<S, D>,
    ) -> Option<Vector<S, D>> {
        let Next { x, wanted, stride, .. } = *next;
        let Stride { speed, dt, length: step, .. } = *stride;
        // The skin is no core: outside of that, by what rounding may do and as much again, is all that has to be.
        let bare = stride.unit * S::from_f64(BARE);
        // One half-space a core is enough to be outside, but another may do as well: those seen from where the best velocity leads.
        let landing = x + best * dt;
        let there = View { at: &landing, step: step + step, approach: S::one(), skin: bare + bare, near: next.near };
        let mut seen = HalfSpaces::new(speed);
        self.look(next, &there, &mut seen);
        // In fixed point what half-spaces of thin walls say may be off by more than the skin.
        let outside = |u: &Vector<S, D>| next.is_clear(&(x + u * dt), stride.unit);
        let allowed = seen.allowed(wanted).filter(outside);
        allowed
            .or_else(|| next.is_clear(&landing, bare).then_some(*best))
            .or_else(|| next.is_clear(x, S::zero()).then(Vector::zeros))
            .or_else(|| self.search(next))
    }

    /// The half-spaces that are seen from one place, into `all`.
    #[inline(never)]
    fn look<const D: usize, const CAP: usize>(
        &self,
        next: &Next<'_, S, D, CAP>,
        view: &View<'_, S, D>,
        all: &mut HalfSpaces<S, D>,
    ) {
        let skin = view.skin;
        let gone = view.at - next.x;
        let mut keep = |normal: Vector<S, D>, gap: S| {
            let room = gap - skin;
            let share = if room > S::zero() {
                view.approach
            } else if gap + gap >= skin {
                S::from_f64(HOLD)
            } else {
                S::one()
            };
            // Divided, for in fixed point the reciprocal of a short step is out of range.
            all.add(HalfSpace { normal, offset: (normal.dot(&gone) - room * share) / next.stride.dt });
        };
        let wish = next.wanted * next.stride.dt - gone;
        for (index, reach) in view.near {
            if let Some(obstacle) = next.table.at(*index) {
                let reach = *reach + view.step;
                let from = Outlook { at: view.at, wish: &wish, step: view.step, reach, share: view.approach };
                obstacle.keep_out(&from, &mut keep);
            }
        }
        let scan = next.table.scan();
        if !scan.points().is_empty() {
            let blur = blur(scan.radius());
            let reach = next.stride.reach + view.step + blur;
            scan.keep_out(view.at, reach, |normal, gap| keep(normal, gap - blur));
        }
    }
}

/// How long a step is, and what that comes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stride<S> {
    /// The limit, m/s.
    speed: S,
    /// The step's time, s.
    pub dt: S,
    /// No sample is farther away, m.
    pub length: S,
    /// One unit of rounding of where it may lead, m.
    unit: S,
    /// What surfaces are kept away, m.
    skin: S,
    /// Surfaces farther away than this do not bind, m.
    pub reach: S,
}

/// The step to the next sample.
struct Next<'a, S: Scalar, const D: usize, const CAP: usize> {
    /// The robot, m.
    x: &'a Vector<S, D>,
    /// What is wanted, m/s.
    wanted: &'a Vector<S, D>,
    stride: &'a Stride<S>,
    /// What is there at the next sample.
    table: &'a Table<S, D, CAP>,
    /// What of it may be reached: places in the table, each with how far to look for its surface, m.
    near: &'a [(usize, S)],
}

impl<S: Scalar, const D: usize, const CAP: usize> Next<'_, S, D, CAP> {
    /// The obstacles that may be reached.
    fn near(&self) -> impl Iterator<Item = &Obstacle<S, D>> {
        self.near.iter().filter_map(|(index, _)| self.table.at(*index))
    }

    /// May a step lead out of every core? Not if it is known that they hold every place there is within it. `reached` gets those of
    /// [`near`](Next::near) that it may reach; `likely` is the velocity that may best lead out, m/s.
    fn may_lead_out(&self, likely: &Vector<S, D>, reached: &mut heapless::Vec<(usize, S), CAP>) -> bool {
        let Next { x, table, stride: &Stride { speed, dt, length: step, skin, .. }, .. } = *self;
        let mut out = HalfSpaces::new(speed);
        let mut leads = true;
        for (index, reach) in self.near {
            let Some(engulfed) = table.at(*index).and_then(|o| o.engulfs(x, step, skin)) else { continue };
            match engulfed {
                Engulfed::Everything => return false,
                Engulfed::HalfSpace { depth, .. } if depth > step => return false,
                Engulfed::HalfSpace { normal, depth } => {
                    let offset = depth / dt;
                    leads &= normal.dot(likely) > offset;
                    out.add(HalfSpace { normal, offset });
                }
                Engulfed::Nothing => {}
            }
            // Cannot be full: it has the table's own capacity.
            let _ = reached.push((*index, *reach));
        }
        leads || out.allowed(likely).is_some()
    }

    /// Is a place outside of every core, farther than `rounding`, m?
    fn is_clear(&self, place: &Vector<S, D>, rounding: S) -> bool {
        let scan = self.table.scan();
        let share = rounding / scan.radius();
        let outside = |o: &Obstacle<S, D>| {
            let gamma = o.gamma(place);
            gamma >= S::one() && (rounding == S::zero() || !o.is_near(gamma, rounding) || o.is_farther(place, rounding))
        };
        self.near().all(outside) && !(scan.gamma(place) < (S::one() + share) * (S::one() + share))
    }
}

/// From where surfaces are looked at.
struct View<'a, S: Scalar, const D: usize> {
    /// The place, m.
    at: &'a Vector<S, D>,
    /// No sample is farther from there, m.
    step: S,
    /// The share of the distance that may be used up.
    approach: S,
    /// What surfaces are kept away, m.
    skin: S,
    /// What counts: places in the table, each with how far to look for its surface, m.
    near: &'a [(usize, S)],
}

/// The half-spaces of one tick that any velocity could violate, and the speed up to which those that found no room cannot be.
struct HalfSpaces<S: Scalar, const D: usize> {
    all: heapless::Vec<HalfSpace<S, D>, CAPACITY>,
    speed: S,
}

impl<S: Scalar, const D: usize> HalfSpaces<S, D> {
    fn new(speed: S) -> Self {
        Self { all: heapless::Vec::new(), speed }
    }

    /// Puts one in; where there is no room, in the place of the loosest, which no velocity slower than its offset violates.
    fn add(&mut self, new: HalfSpace<S, D>) {
        if !(new.offset > -self.speed) {
            return;
        }
        let Err(mut new) = self.all.push(new) else { return };
        if let Some(loosest) =
            self.all.iter_mut().min_by(|a, b| a.offset.partial_cmp(&b.offset).unwrap_or(Ordering::Equal))
            && loosest.offset < new.offset
        {
            core::mem::swap(loosest, &mut new);
        }
        self.speed = -new.offset;
    }

    fn least(&mut self, wanted: &Vector<S, D>) -> Solution<S, D> {
        let solution = least(wanted, &mut self.all, self.speed);
        Solution { feasible: solution.feasible && self.speed >= S::zero(), ..solution }
    }

    fn nearest_of_least(&mut self, wanted: &Vector<S, D>, best: Solution<S, D>) -> Solution<S, D> {
        nearest_of_least(wanted, &mut self.all, self.speed, best)
    }

    fn allowed(&mut self, wanted: &Vector<S, D>) -> Option<Vector<S, D>> {
        if self.speed < S::zero() { None } else { allowed(wanted, &mut self.all, self.speed) }
    }
}

/// One unit of rounding of a position like this one, m; in fixed point all are equally coarse. Half-spaces hold to within 64 epsilon of the speed
/// ([`nearest`]): the 16 units of the skin are to be more than that is in a long step.
fn rounding<S: Scalar, const D: usize>(x: &Vector<S, D>, step: S) -> S {
    let least = S::one().max(step * S::from_f64(8.0));
    S::EPSILON * if S::FLOATS { x.iter().fold(least, |m, x| m.max(x.abs())) } else { least }
}

/// By how much the surface of a body of this size, m, counts as nearer, m: what rounding may do to the distance from
/// it, as far as that is beyond [`SKIN`]. Scaled coordinates are in units of that size; in fixed point the unit's
/// reciprocal is as coarse as all other numbers, and what it is wrong by is so many times a metre squared.
pub(crate) fn blur<S: Scalar>(size: S) -> S {
    let eight = S::EPSILON * S::from_f64(8.0) * size;
    let two = S::one() + S::one();
    let all = if S::FLOATS { eight * two } else { eight * size.max(two) };
    (all - S::from_f64(SKIN)).max(S::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More half-spaces than there is room for, in any order: what was found violates none of them, also not those that were left out.
    #[test]
    fn half_spaces_beyond_the_capacity_are_kept_by_speed() {
        const COUNT: usize = CAPACITY + 40;
        for turn in 0..50 {
            // Those in the way of +x are tighter than those in the way of -x, for which there is no room.
            let all: [_; COUNT] = core::array::from_fn(|i| {
                let i = (i * 89 + turn * 7) % COUNT;
                let (way, offset) = if i < CAPACITY { (-1.0, -0.5) } else { (1.0, -1.2) };
                let angle = (i % 40) as f64 / 40.0 - 0.5;
                HalfSpace {
                    normal: Vector::<f64, 2>::new(way * libm::cos(angle), libm::sin(angle)),
                    offset: offset - i as f64 * 1e-3,
                }
            });
            let mut seen = HalfSpaces::new(2.0);
            all.iter().for_each(|h| seen.add(*h));
            let found = seen.least(&Vector::<f64, 2>::new(-2.0, 0.0));
            assert!(found.feasible);
            assert!(found.velocity.x < -1.2, "more is kept than need be: {found:?}");
            for h in &all {
                assert!(h.normal.dot(&found.velocity) >= h.offset - 1e-12, "{h:?} {found:?}");
            }
        }
    }
}
