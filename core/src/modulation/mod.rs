//! Bending the nominal motion round hard cores.
//!
//! One obstacle: Khansari-Zadeh & Billard (2012), eqs. 7-10 of Chen et al., in closed form. Several: Huber, Billard & Slotine (2019).

#![allow(
    clippy::needless_range_loop,
    clippy::modulo_one,
    reason = "loops over lanes index several arrays alike, which makes them vector instructions; there may be one lane"
)]

use core::array::from_fn;

use crate::obstacle::Sample;
use crate::{Scalar, Vector, norm, unit};

/// The velocity past one obstacle:
///
/// ```text
/// xdot = s + M (f - s),   M u = (1 + 1/G) u - (2/G) ((g.u)/(g.r)) r,   G = max(Gamma, 1)
/// ```
///
/// which is E D E^-1 with E = [r/|r|, tangents of g] and D = diag(1 - 1/G, 1 + 1/G, ...): u minus its part along r (split by the tangent
/// plane) is tangential and stretched, the part along r is compressed. Neither g nor r need be of unit length. `None` where g.r is not
/// positive.
#[inline(always)]
fn past_one<S: Scalar, const D: usize>(
    f: &[S; D],
    gamma: S,
    outward: &[S; D],
    arm: &[S; D],
    surface_velocity: &[S; D],
) -> (bool, [S; D]) {
    let along = dot(outward, arm);
    let usable = along > S::from_f64(1e-6) * size(outward) * size(arm);
    let u: [S; D] = from_fn(|d| f[d] - surface_velocity[d]);
    let inverse = S::one() / gamma.max(S::one());
    let radial = (inverse + inverse) * (dot(outward, &u) / along);
    let stretch = S::one() + inverse;
    let past = from_fn(|d| {
        let past = surface_velocity[d] + u[d] * stretch - arm[d] * radial;
        if usable { past } else { surface_velocity[d] }
    });
    (usable, past)
}

/// Obstacles that are computed side by side, each quantity in an array of its own, so that compilers make vector instructions of them where
/// there are any. No bit depends on it: what is summed up is summed up one by one.
const LANES: usize = if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) { 4 } else { 1 };
/// Groups of them that wait to be taken in together: what is done to them would not fit into registers along with what is done to find them.
const GROUPS: usize = if LANES == 1 { 8 } else { 1 };

/// Obstacles side by side; see [`Sample`].
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
        let first = |x: S| from_fn(|lane| if lane == 0 { x } else { S::zero() });
        let each = |v: &Vector<S, D>| from_fn(|d| first(v[d]));
        Self {
            gamma: first(sample.gamma),
            outward: each(&sample.outward),
            arm: each(&sample.arm),
            surface_velocity: each(&sample.surface_velocity),
        }
    }

    /// The velocities past them, and whether their reference points are usable.
    #[inline(always)]
    fn past(&self, f: &[S; D]) -> ([bool; LANES], [[S; LANES]; D]) {
        let mut usable = [true; LANES];
        let mut velocity = [[S::zero(); LANES]; D];
        for i in 0..LANES {
            let lane = |a: &[[S; LANES]; D]| -> [S; D] { from_fn(|d| a[d][i]) };
            let (outward, arm, surface) = (lane(&self.outward), lane(&self.arm), lane(&self.surface_velocity));
            let past;
            (usable[i], past) = past_one(f, self.gamma[i], &outward, &arm, &surface);
            for d in 0..D {
                velocity[d][i] = past[d];
            }
        }
        (usable, velocity)
    }
}

/// A velocity bent round obstacles that come one after the other.
#[derive(Debug)]
pub(crate) struct Modulation<S: Scalar, const D: usize> {
    /// The lane for the next obstacle, and those that wait.
    lane: usize,
    groups: heapless::Vec<Group<S, D>, GROUPS>,
    /// Behind them, for compilers clear what lies between two numbers that are zero at one go, room for what waits and all.
    f: [S; D],
    /// Were there any before those that wait?
    others: bool,
    mean: DirectionalMean<S, D>,
    /// Was a reference point unusable?
    unusable: bool,
}

impl<S: Scalar, const D: usize> Modulation<S, D> {
    /// Nothing but the nominal velocity f, m/s.
    #[inline(always)]
    pub fn new(f: &Vector<S, D>) -> Self {
        let (groups, mean) = (heapless::Vec::new(), DirectionalMean::new(f));
        Self { lane: 0, groups, f: from_fn(|d| f[d]), others: false, mean, unusable: false }
    }

    /// One more obstacle.
    #[inline(always)]
    pub fn push(&mut self, sample: &Sample<S, D>) {
        // Where there is one lane, this is a constant.
        let lane = self.lane % LANES;
        if lane == 0 {
            // There is room, for it is emptied when it is full.
            let _ = self.groups.push(Group::new(sample));
        } else if let Some(group) = self.groups.last_mut() {
            group.gamma[lane] = sample.gamma;
            for d in 0..D {
                group.outward[d][lane] = sample.outward[d];
                group.arm[d][lane] = sample.arm[d];
                group.surface_velocity[d][lane] = sample.surface_velocity[d];
            }
        }
        self.lane = (lane + 1) % LANES;
        if self.lane == 0 && self.groups.is_full() {
            self.flush();
        }
    }

    /// The velocity past all of them, m/s, and whether one of their reference points was unusable.
    #[inline]
    pub fn finish(&mut self) -> (Vector<S, D>, bool) {
        match self.groups.as_slice() {
            [] if !self.others => (Vector::from_fn(|d, _| self.f[d]), false),
            [one] if !self.others && self.in_last() == 1 => {
                let (usable, velocity) = one.past(&self.f);
                (Vector::from_fn(|d, _| velocity[d][0]), !usable[0])
            }
            _ => {
                self.flush();
                (self.mean.velocity(), self.unusable)
            }
        }
    }

    /// How many obstacles the last group has.
    fn in_last(&self) -> usize {
        if self.lane.is_multiple_of(LANES) { LANES } else { self.lane }
    }

    /// Takes those that wait into the mean.
    #[inline(never)]
    fn flush(&mut self) {
        // Copies stay in registers.
        let (f, mut mean, mut unusable) = (self.f, self.mean, self.unusable);
        // Counted, for where there is room for one a compiler then writes no loop.
        for g in 0..GROUPS {
            let Some(group) = self.groups.get(g) else { break };
            let here = if g + 1 < self.groups.len() { LANES } else { self.in_last() };
            let (usable, velocity) = group.past(&f);
            let seen = mean.seen(&velocity);
            for i in 0..here {
                unusable |= !usable[i];
                mean.add(group.gamma[i] - S::one(), &seen, i);
            }
        }
        self.groups.clear();
        self.lane = 0;
        (self.mean, self.unusable, self.others) = (mean, unusable, true);
    }
}

/// A weight proportional to 1/(Gamma - 1), scaled so that the nearest obstacle's is one: no overflow, and on a surface that
/// obstacle alone counts.
pub(crate) fn weight<S: Scalar>(distance: S, nearest: S) -> S {
    if nearest > S::zero() {
        nearest / distance
    } else if distance <= S::zero() {
        S::one()
    } else {
        S::zero()
    }
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
    /// |f|, m/s.
    nominal: S,
    /// f/|f|; zero where f is.
    forward: Vector<S, D>,
    /// The least Gamma - 1 so far.
    nearest: S,
    sum: S,
    speed: S,
    /// sum of w_n angle_n (unit vector across f towards xdot_n); in the plane the first is all there is, counter-clockwise.
    kappa: Vector<S, D>,
    /// sum of w_n xdot_n
    plain: Vector<S, D>,
    /// How much of the plain mean to take.
    fading: S,
}

/// Some velocities as they look along f.
struct Seen<S, const D: usize> {
    velocity: [[S; LANES]; D],
    /// Along f, m/s.
    ahead: [S; LANES],
    /// What is across f; and how much that is, in the plane with a sign, counter-clockwise.
    across: [[S; LANES]; D],
    aside: [S; LANES],
    speed: [S; LANES],
    /// From f, rad.
    angle: [S; LANES],
}

impl<S: Scalar, const D: usize> DirectionalMean<S, D> {
    fn new(f: &Vector<S, D>) -> Self {
        let (zero, none) = (Vector::zeros(), S::zero());
        let (nominal, forward) = unit(f);
        Self { nominal, forward, nearest: S::MAX, sum: none, speed: none, kappa: zero, plain: zero, fading: none }
    }

    /// Velocities as seen along f.
    #[inline(always)]
    fn seen(&self, velocity: &[[S; LANES]; D]) -> Seen<S, D> {
        let none = [S::zero(); LANES];
        let mut seen =
            Seen { velocity: *velocity, ahead: none, across: [none; D], aside: none, speed: none, angle: none };
        for i in 0..LANES {
            let mut ahead = velocity[0][i] * self.forward[0];
            for d in 1..D {
                ahead += velocity[d][i] * self.forward[d];
            }
            seen.ahead[i] = ahead;
            if D == 2 {
                seen.aside[i] = self.forward[0] * velocity[1][i] - self.forward[1] * velocity[0][i];
            } else {
                for d in 0..D {
                    seen.across[d][i] = velocity[d][i] - self.forward[d] * ahead;
                }
                let across: [S; D] = from_fn(|d| seen.across[d][i]);
                seen.aside[i] = S::norm(&across);
            }
        }
        // One by itself may not need it.
        if LANES > 1 {
            for i in 0..LANES {
                (seen.speed[i], seen.angle[i]) = S::polar(seen.ahead[i], seen.aside[i]);
            }
        }
        seen
    }

    /// Adds the i-th of some velocities, past an obstacle at this Gamma - 1. Weights are relative to the nearest obstacle's so far.
    #[inline(always)]
    fn add(&mut self, distance: S, seen: &Seen<S, D>, i: usize) {
        if distance < self.nearest {
            // The first has nothing to scale.
            let factor = weight(self.nearest, distance);
            self.nearest = distance;
            self.sum *= factor;
            self.speed *= factor;
            self.kappa *= factor;
            self.plain *= factor;
        }
        let (ahead, aside) = (seen.ahead[i], seen.aside[i]);
        if ahead < S::zero() {
            self.fading = self.fading.max(opposite(ahead, aside));
        }
        // On a surface it alone counts.
        if !(self.nearest > S::zero()) && distance > S::zero() {
            return;
        }
        let weight = weight(distance, self.nearest);
        let (speed, angle) = if LANES == 1 { S::polar(ahead, aside) } else { (seen.speed[i], seen.angle[i]) };
        self.sum += weight;
        self.speed += weight * speed;
        for d in 0..D {
            self.plain[d] += seen.velocity[d][i] * weight;
        }
        if D == 2 {
            self.kappa[0] += weight * angle;
        } else if aside > S::zero() {
            let share = weight * (angle / aside);
            for d in 0..D {
                self.kappa[d] += seen.across[d][i] * share;
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

#[inline(always)]
fn dot<S: Scalar, const D: usize>(a: &[S; D], b: &[S; D]) -> S {
    S::dot(a, b)
}

/// |v_1| + |v_2| + ...: between one and sqrt(d) times the length, without a square root.
#[inline(always)]
fn size<S: Scalar, const D: usize>(v: &[S; D]) -> S {
    v.iter().fold(S::zero(), |sum, x| sum + x.abs())
}

#[cfg(test)]
mod closed_form;
#[cfg(test)]
mod tests;
