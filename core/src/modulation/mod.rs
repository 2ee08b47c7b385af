//! Bending the nominal motion round hard cores.
//!
//! One obstacle: Khansari-Zadeh & Billard (2012), eqs. 7-10 of Chen et al., in closed form. Several: Huber, Billard & Slotine (2019).

#![allow(
    clippy::needless_range_loop,
    clippy::modulo_one,
    reason = "loops over lanes index several arrays alike, which makes them vector instructions; there may be one lane"
)]

use core::array::from_fn;

use crate::obstacle::{Abreast, Sample};
use crate::scalar::lanes::{Each, LANES, Lanes};
use crate::{Scalar, Vector, norm, unit};

/// The velocity past one obstacle:
///
/// ```text
/// xdot = s + M (f - s),   M u = (1 + 1/G) u - (2/G) ((g.u)/(g.r)) r,   G = max(Gamma, 1)
/// ```
///
/// which is E D E^-1 with E = [r/|r|, tangents of g] and D = diag(1 - 1/G, 1 + 1/G, ...): u minus its part along r (split by the tangent
/// plane) is tangential and stretched, the part along r is compressed. Neither g nor r need be of unit length. Where g.r is not positive,
/// or so small that it may be rounding, there is no such split: then the answer is false, and s.
#[inline(always)]
fn past<S: Scalar, L: Lanes<S, N>, const N: usize, const D: usize>(
    f: &[S; D],
    gamma: L,
    outward: &[L; D],
    arm: &[L; D],
    surface_velocity: &[L; D],
) -> (L::Mask, [L; D]) {
    let one = L::splat(S::one());
    let along = L::dot(outward, arm);
    let usable = (L::splat(S::from_f64(1e-6)) * size(outward) * size(arm)).below(along);
    let u: [L; D] = from_fn(|d| L::splat(f[d]) - surface_velocity[d]);
    let inverse = one / gamma.max(one);
    let radial = (inverse + inverse) * (L::dot(outward, &u) / along);
    let stretch = one + inverse;
    let past = from_fn(|d| {
        let past = surface_velocity[d] + u[d] * stretch - arm[d] * radial;
        L::select(usable, past, surface_velocity[d])
    });
    (usable, past)
}

/// Obstacles side by side; see [`Sample`]. A lane without one has the largest Gamma there is.
#[derive(Clone, Copy, Debug)]
struct Group<S, const D: usize> {
    gamma: [S; LANES],
    outward: [[S; LANES]; D],
    arm: [[S; LANES]; D],
    surface_velocity: [[S; LANES]; D],
}

impl<S: Scalar, const D: usize> Group<S, D> {
    /// One obstacle, in the first lane.
    #[inline(always)]
    fn new(sample: &Sample<S, D>) -> Self {
        let first = |x: S, none: S| from_fn(|lane| if lane == 0 { x } else { none });
        let each = |v: &Vector<S, D>| from_fn(|d| first(v[d], S::zero()));
        Self {
            gamma: first(sample.gamma, S::MAX),
            outward: each(&sample.outward),
            arm: each(&sample.arm),
            surface_velocity: each(&sample.surface_velocity),
        }
    }

    /// The velocities past them, and where their reference points are usable.
    #[inline(always)]
    fn past(&self, f: &[S; D]) -> (Mask<S>, [S::Lanes; D]) {
        let lanes = |v: &[[S; LANES]; D]| from_fn(|d| S::Lanes::new(&v[d]));
        past(f, S::Lanes::new(&self.gamma), &lanes(&self.outward), &lanes(&self.arm), &lanes(&self.surface_velocity))
    }

    /// The same of the first.
    #[inline(always)]
    fn past_first(&self, f: &[S; D]) -> (bool, [S; D]) {
        let first = |v: &[[S; LANES]; D]| from_fn(|d| Each([v[d][0]]));
        let (outward, arm, surface_velocity) = (first(&self.outward), first(&self.arm), first(&self.surface_velocity));
        let ([usable], velocity) = past(f, Each([self.gamma[0]]), &outward, &arm, &surface_velocity);
        (usable, velocity.map(|Each([v])| v))
    }
}

/// An answer for each lane.
type Mask<S> = <<S as Scalar>::Lanes as Lanes<S, LANES>>::Mask;

/// A velocity bent round obstacles that come one after the other.
#[derive(Debug)]
pub(crate) struct Modulation<S: Scalar, const D: usize, const CAP: usize> {
    f: [S; D],
    /// The lane for the next obstacle.
    lane: usize,
    /// The obstacles so far: how much one weighs is known when all are there, and what is done to them would not fit into registers along with
    /// what is done to find them.
    groups: heapless::Vec<Group<S, D>, CAP>,
}

impl<S: Scalar, const D: usize, const CAP: usize> Modulation<S, D, CAP> {
    /// Nothing but the nominal velocity f, m/s.
    #[inline(always)]
    pub fn new(f: &Vector<S, D>) -> Self {
        Self { f: from_fn(|d| f[d]), lane: 0, groups: heapless::Vec::new() }
    }

    /// One more obstacle, of at most `CAP`.
    #[inline(always)]
    pub fn push(&mut self, sample: &Sample<S, D>) {
        // Where there is one lane, this is zero.
        let lane = self.lane % LANES;
        if lane == 0 {
            let _ = self.groups.push(Group::new(sample));
        } else if let Some(group) = self.groups.last_mut() {
            group.gamma[lane] = sample.gamma;
            for d in 0..D {
                group.outward[d][lane] = sample.outward[d];
                group.arm[d][lane] = sample.arm[d];
                group.surface_velocity[d][lane] = sample.surface_velocity[d];
            }
        }
        if LANES > 1 {
            self.lane = lane + 1;
        }
    }

    /// As many more as there are lanes.
    #[inline(always)]
    pub fn push_abreast(&mut self, few: &Abreast<S, D>) {
        let each = |v: &[S::Lanes; D]| v.map(Lanes::numbers);
        let (outward, arm) = (each(&few.outward), each(&few.arm));
        let surface_velocity = [[S::zero(); LANES]; D];
        let _ = self.groups.push(Group { gamma: few.gamma.numbers(), outward, arm, surface_velocity });
        self.lane = LANES;
    }

    /// The velocity past all of them and past one more, if there is one, m/s; and whether one of their reference points was unusable. `gamma` is
    /// the least Gamma of those pushed.
    #[inline]
    pub fn finish(&self, gamma: S, last: Option<&Sample<S, D>>) -> (Vector<S, D>, bool) {
        let last = last.map(Group::new);
        let one = match (self.groups.as_slice(), &last) {
            ([], None) => return (self.f.into(), false),
            ([], Some(one)) => one,
            ([one], None) if self.lane <= 1 => one,
            (groups, last) => {
                let gamma = last.as_ref().map_or(gamma, |last| gamma.min(last.gamma[0]));
                let mut mean = DirectionalMean::new(&self.f, (gamma - S::one()).max(S::zero()));
                mean.take(groups);
                if let Some(last) = last {
                    mean.take(core::slice::from_ref(last));
                }
                return (mean.velocity(), mean.unusable);
            }
        };
        let (usable, velocity) = one.past_first(&self.f);
        (velocity.into(), !usable)
    }
}

/// A weight proportional to 1/(Gamma - 1), scaled so that the nearest obstacle's is one: no overflow, and where the nearest is touched (its Gamma - 1,
/// cut off at zero, is zero) those that are touched alone count.
#[inline(always)]
pub(crate) fn weight<S: Scalar>(distance: S, nearest: S) -> S {
    if distance > nearest { nearest / distance } else { S::one() }
}

/// Sine of the angle to "exactly opposite to f" from which the mean of angles gives way to the plain mean.
const OPPOSITE: f64 = 0.3;
/// |f| over the mean speed below which it does.
const SLOW: f64 = 0.05;

/// How much of the plain mean a velocity against f asks for. Rare, and so no part of the loop over obstacles.
#[cold]
#[inline(never)]
fn opposite<S: Scalar>(ahead: S, aside: S) -> S {
    S::one() + aside.abs() / (ahead * S::from_f64(OPPOSITE))
}

/// Mean speed, and mean direction as a mean of angles to f: averaging velocities themselves could cancel to a standstill.
///
/// A direction opposite to f has its angle on either side, and where f vanishes there is nothing to measure from. Both happen only among
/// moving obstacles; towards them the mean of angles fades into the plain mean of velocities, so that the velocity is continuous.
#[derive(Clone, Copy, Debug)]
struct DirectionalMean<S: Scalar, const D: usize> {
    f: [S; D],
    /// |f|, m/s.
    nominal: S,
    /// f/|f|; zero where f is.
    forward: Vector<S, D>,
    /// The least Gamma - 1, or zero if that is below.
    nearest: S,
    sum: S,
    speed: S,
    /// sum of w_n angle_n (unit vector across f towards xdot_n); in the plane the first is all there is, counter-clockwise.
    kappa: Vector<S, D>,
    /// sum of w_n xdot_n
    plain: Vector<S, D>,
    /// How much of the plain mean to take.
    fading: S,
    /// Was a reference point unusable?
    unusable: bool,
}

impl<S: Scalar, const D: usize> DirectionalMean<S, D> {
    fn new(f: &[S; D], nearest: S) -> Self {
        let (zero, none) = (Vector::zeros(), S::zero());
        let (nominal, forward) = unit(&(*f).into());
        Self {
            f: *f,
            nominal,
            forward,
            nearest,
            sum: none,
            speed: none,
            kappa: zero,
            plain: zero,
            fading: none,
            unusable: false,
        }
    }

    /// Takes in the velocities past these obstacles.
    #[inline(always)]
    fn take(&mut self, groups: &[Group<S, D>]) {
        for group in groups {
            let (usable, velocity) = group.past(&self.f);
            self.add(group, usable, &velocity);
        }
    }

    /// Adds velocities past some obstacles.
    #[inline(always)]
    fn add(&mut self, group: &Group<S, D>, usable: Mask<S>, velocity: &[S::Lanes; D]) {
        let of = <S::Lanes as Lanes<S, LANES>>::splat;
        let (zero, one) = (of(S::zero()), of(S::one()));
        let gamma = S::Lanes::new(&group.gamma);
        // Is there an obstacle?
        let has = if LANES == 1 { S::Lanes::mask(true) } else { gamma.below(of(S::FAR)) };
        let distance = gamma - one;
        let weight = of(self.nearest).over_where(of(self.nearest).below(distance), distance, one);
        let weight = S::Lanes::select(has, weight, zero);
        self.unusable |= S::Lanes::any_but(has, usable);
        // As seen along f: ahead, and across it; how much that is, in the plane with a sign, counter-clockwise.
        let forward: [S::Lanes; D] = from_fn(|d| of(self.forward[d]));
        let ahead = S::Lanes::dot(velocity, &forward);
        let across: [S::Lanes; D] = from_fn(|d| if D == 2 { zero } else { velocity[d] - forward[d] * ahead });
        let aside = if D == 2 { forward[0] * velocity[1] - forward[1] * velocity[0] } else { S::Lanes::norm(&across) };
        let (speed, angle) = S::Lanes::polar(ahead, aside);
        let against = ahead.below(zero);
        if S::Lanes::any_but(against, S::Lanes::mask(false)) {
            for (ahead, aside) in ahead.numbers().into_iter().zip(aside.numbers()) {
                if ahead < S::zero() {
                    self.fading = self.fading.max(opposite(ahead, aside));
                }
            }
        }
        add(&mut self.sum, weight);
        add(&mut self.speed, weight * speed);
        for d in 0..D {
            add(&mut self.plain[d], velocity[d] * weight);
        }
        if D == 2 {
            add(&mut self.kappa[0], weight * angle);
        } else {
            let share = weight * angle.over_where(zero.below(aside), aside, zero);
            for d in 0..D {
                add(&mut self.kappa[d], across[d] * share);
            }
        }
    }

    fn velocity(&self) -> Vector<S, D> {
        let (zero, one) = (S::zero(), S::one());
        let inverse = one / self.sum;
        let (plain, speed, kappa) = (self.plain * inverse, self.speed * inverse, self.kappa * inverse);
        let slow = S::from_f64(SLOW) * speed;
        let slowness = if self.nominal < slow { one - self.nominal / slow } else { zero };
        let fading = self.fading.max(slowness);
        if !(fading < one && self.nominal > zero) {
            return plain;
        }
        let direction = self.turned(&kappa) * speed;
        if fading > zero { direction * (one - fading) + plain * fading } else { direction }
    }

    /// f/|f| turned by the angle vector.
    fn turned(&self, kappa: &Vector<S, D>) -> Vector<S, D> {
        let mut side = *kappa;
        let angle = if D == 2 {
            (side[0], side[1]) = (-self.forward[1], self.forward[0]);
            kappa[0]
        } else {
            let angle = norm(kappa);
            if angle > S::zero() {
                side /= angle;
            }
            angle
        };
        let (sin, cos) = angle.sin_cos();
        self.forward * cos + side * sin
    }
}

/// One by one, in their order.
#[inline(always)]
fn add<S: Scalar, L: Lanes<S, N>, const N: usize>(sum: &mut S, terms: L) {
    for term in terms.numbers() {
        *sum += term;
    }
}

/// |v_1| + |v_2| + ...: between one and sqrt(d) times the length, without a square root.
#[inline(always)]
fn size<S: Scalar, L: Lanes<S, N>, const N: usize, const D: usize>(v: &[L; D]) -> L {
    v.iter().fold(L::splat(S::zero()), |sum, x| sum + x.abs())
}

#[cfg(test)]
mod closed_form;
#[cfg(test)]
mod tests;
