//! Motion in soft layers: faster through one, slower where two overlap (eqs. 15 and 27 of Chen et al.).

use crate::obstacle::SoftLayer;
use crate::{Scalar, Vector, norm};

/// Which way the push in a soft layer points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SteeringPolicy<S> {
    /// The paper to the letter: the reference direction turned by theta_2 (about z in 3-D), with the paper's sign.
    /// Whether it speeds the robot up or stops it dead depends on the side it passes on.
    Fixed {
        /// cos theta_2
        cos: S,
        /// sin theta_2
        sin: S,
    },
    /// Along the tangent plane in the direction of the flow, at most `beta` times the nominal speed, fading in at the shell.
    /// Keeps the attractor an equilibrium and the velocity continuous.
    WithFlow {
        /// Largest push over |f(x)|.
        beta: S,
    },
}

impl<S: Scalar> SteeringPolicy<S> {
    /// The paper's policy for theta_2 in rad.
    pub fn fixed(angle: S) -> Self {
        Self::Fixed { cos: angle.cos(), sin: angle.sin() }
    }
}

/// What the fixed side adds to the tangential flow, over |f|: enough to leave a saddle point.
const SIDE: f64 = 0.01;
/// Tangential flow, over |f|, from which the push has its full length.
const FULL: f64 = 0.02;
/// Largest slow-down over the speed: an intersection slows the robot and never turns it round.
const SLOWEST: f64 = 0.8;

/// The modulated velocity u, adapted to the soft layers x is in; `gain` is the paper's c, `nominal` |f(x)|, both in m/s.
pub(crate) fn adapt<S: Scalar, const D: usize>(
    policy: &SteeringPolicy<S>,
    gain: S,
    nominal: S,
    u: Vector<S, D>,
    soft: &[SoftLayer<S, D>],
) -> Vector<S, D> {
    if soft.is_empty() {
        return u;
    }
    match policy {
        SteeringPolicy::Fixed { cos, sin } => fixed(*cos, *sin, gain, u, soft),
        SteeringPolicy::WithFlow { beta } => with_flow(gain, *beta * nominal, nominal, u, soft),
    }
}

/// Every layer but `n`.
fn others<'a, S: Scalar, const D: usize>(
    soft: &'a [SoftLayer<S, D>],
    n: &'a SoftLayer<S, D>,
) -> impl Iterator<Item = &'a SoftLayer<S, D>> {
    soft.iter().filter(move |m| !core::ptr::eq(*m, n))
}

/// c / Gamma_k^2, m/s, at most `most`.
fn speed_up<S: Scalar, const D: usize>(gain: S, n: &SoftLayer<S, D>, most: S) -> S {
    (gain / (n.gamma_soft * n.gamma_soft)).min(most)
}

/// c (2 / (Gamma_k,n + Gamma_k,m))^2, m/s, at most `most`.
fn slow_down<S: Scalar, const D: usize>(gain: S, n: &SoftLayer<S, D>, m: &SoftLayer<S, D>, most: S) -> S {
    let mean = (n.gamma_soft + m.gamma_soft) * S::from_f64(0.5);
    (gain / (mean * mean)).min(most)
}

/// No push is longer, m/s: no limit lets through what is cut here.
const MOST: f64 = 1e6;

fn fixed<S: Scalar, const D: usize>(
    cos: S,
    sin: S,
    gain: S,
    mut u: Vector<S, D>,
    soft: &[SoftLayer<S, D>],
) -> Vector<S, D> {
    let (alone, most) = (soft.len() == 1, S::from_f64(MOST));
    for n in soft {
        let length = norm(&n.arm);
        if !(length > S::zero()) {
            // At the reference point of a wall there is no reference direction.
            continue;
        }
        let r = n.arm / length;
        let mut push = r;
        (push[0], push[1]) = (cos * r[0] - sin * r[1], sin * r[0] + cos * r[1]);
        // sgn(cos(theta_2 - theta_1)), without the angles; rounding must not decide at a right angle
        if cos * n.first_axis[0] + sin * n.first_axis[1] < S::from_f64(-1e-6) {
            push = -push;
        }
        if alone {
            u += push * speed_up(gain, n, most);
        } else {
            let tangential = push - n.normal * push.dot(&n.normal);
            let sum = others(soft, n).fold(S::zero(), |sum, m| sum + slow_down(gain, n, m, most));
            u -= tangential * sum;
        }
    }
    u
}

fn with_flow<S: Scalar, const D: usize>(
    gain: S,
    largest: S,
    nominal: S,
    u: Vector<S, D>,
    soft: &[SoftLayer<S, D>],
) -> Vector<S, D> {
    if !(nominal > S::zero()) {
        return u;
    }
    let mut faster = Vector::<S, D>::zeros();
    let mut slower = Vector::<S, D>::zeros();
    let largest = largest.min(S::from_f64(MOST));
    for n in soft {
        let mut alone = n.fade;
        let mut pairs = S::zero();
        for m in others(soft, n) {
            alone *= S::one() - m.fade;
            pairs += slow_down(gain, n, m, largest) * m.fade;
        }
        let along = along_flow(&u, nominal, n);
        faster += along * (alone * speed_up(gain, n, largest));
        slower += along * (n.fade * pairs);
    }
    // The whole flow is slowed, not its tangents: subtracting one obstacle's tangent could point into another's core.
    let (slowing, speed) = (norm(&slower), norm(&u));
    let share = if slowing > S::zero() { (slowing / speed).min(S::from_f64(SLOWEST)) } else { S::zero() };
    u * (S::one() - share) + faster
}

/// The direction of the flow in the tangent plane, shorter than one where there is hardly any.
fn along_flow<S: Scalar, const D: usize>(u: &Vector<S, D>, nominal: S, o: &SoftLayer<S, D>) -> Vector<S, D> {
    let t = u - o.normal * u.dot(&o.normal) + side(o) * (S::from_f64(SIDE) * nominal);
    t / norm(&t).max(S::from_f64(FULL) * nominal)
}

/// A fixed tangent: the normal turned by +90 degrees in 2-D; in 3-D a x n for an axis a that turns with the obstacle.
fn side<S: Scalar, const D: usize>(o: &SoftLayer<S, D>) -> Vector<S, D> {
    let (a, n) = (&o.leaning, &o.normal);
    let mut t = Vector::<S, D>::zeros();
    if D == 2 {
        (t[0], t[1]) = (-n[1], n[0]);
    } else {
        (t[0], t[1], t[2]) = (a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2], a[0] * n[1] - a[1] * n[0]);
    }
    t
}
