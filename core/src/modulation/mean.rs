//! The mean of the velocities past several obstacles.

use core::array::from_fn;

use super::{Group, Mask};
use crate::scalar::lanes::{LANES, Lanes};
use crate::{Scalar, Vector, norm, unit};

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

/// True, from a function of its own so that the compiler makes a branch to it, which is not taken and costs less than a flag kept in every round.
#[cold]
#[inline(never)]
fn unusable() -> bool {
    true
}

/// Mean speed, and mean direction as a mean of angles to f: averaging velocities themselves could cancel to a
/// standstill.
///
/// A direction opposite to f has its angle on either side, and where f vanishes there is nothing to measure from.
/// Both happen only among moving obstacles; towards them the mean of angles fades into the plain mean of velocities,
/// so that the velocity is continuous.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionalMean<S: Scalar, const D: usize> {
    f: [S; D],
    /// |f|, m/s.
    nominal: S,
    /// f/|f|; zero where f is.
    forward: Vector<S, D>,
    /// The least Gamma - 1, or zero if that is below.
    nearest: S,
    sum: S,
    speed: S,
    /// sum of w_n angle_n (unit vector across f towards xdot_n); in the plane the first is all there is,
    /// counter-clockwise.
    kappa: Vector<S, D>,
    /// sum of w_n xdot_n
    plain: Vector<S, D>,
    /// How much of the plain mean to take.
    fading: S,
    /// Was a reference point unusable?
    pub(super) unusable: bool,
}

impl<S: Scalar, const D: usize> DirectionalMean<S, D> {
    pub(super) fn new(f: &[S; D], nearest: S) -> Self {
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
    pub(super) fn take(&mut self, groups: &[Group<S, D>]) {
        for group in groups {
            let (usable, velocity) = group.past(&self.f);
            self.add(group, usable, &velocity);
        }
    }

    /// Adds velocities past some obstacles.
    #[inline(always)]
    pub(super) fn add(&mut self, group: &Group<S, D>, usable: Mask<S>, velocity: &[S::Lanes; D]) {
        let of = <S::Lanes as Lanes<S, LANES>>::splat;
        let (zero, one) = (of(S::zero()), of(S::one()));
        let gamma = S::Lanes::new(&group.gamma);
        // Is there an obstacle?
        let has = if LANES == 1 { S::Lanes::mask(true) } else { gamma.below(of(S::FAR)) };
        let distance = gamma - one;
        let weight = of(self.nearest).over_where(of(self.nearest).below(distance), distance, one);
        let weight = S::Lanes::select(has, weight, zero);
        if S::Lanes::any_but(has, usable) {
            self.unusable = unusable();
        }
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

    pub(super) fn velocity(&self) -> Vector<S, D> {
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
