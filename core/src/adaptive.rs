//! Motion in soft layers, the third stage of a tick: faster through one, slower where two overlap (eqs. 15 and 27 of
//! Chen et al.).
//!
//! [`Stages::adapted`](crate::Stages::adapted) is its result, [`Settings::gain`](crate::Settings::gain) and
//! [`Settings::steering`](crate::Settings::steering) what it is set by. Obstacle n is *soft here* where x is in its
//! soft layer and in no part of its hard core: Gamma_n > 1 and Gamma_k,n <= 1
//! ([`Obstacle::gamma`](crate::Obstacle::gamma) and [`Obstacle::gamma_soft`](crate::Obstacle::gamma_soft)). Where
//! none is, nothing changes.
//!
//! In the formulas u (m/s) is the modulated velocity ([`modulation`](crate::modulation)), f (m/s) the nominal one
//! (relative to the attractor, where that moves), c (m/s) the gain, n_n the unit normal, and r_n leads from the
//! obstacle's reference point to x. All is in the world's frame. The further in, the smaller Gamma_k and the stronger
//! the push: c at the shell, c/Gamma_k^2 inside of it.
//!
//! # `Fixed`: the paper to the letter
//!
//! ```text
//! S_n = sgn(cos(theta_2 - theta_1n))               theta_1n: direction of the obstacle's first axis in the x-y plane
//! p_n = S_n R(theta_2) r_n/|r_n|                   R: by theta_2 about z; S_n = +1 down to a cosine of -1e-6
//!
//! one soft here:    u' = u + p_n c/Gamma_k,n^2                                                        (eq. 15)
//! several:          u' = u - sum over ordered pairs n != m of
//!                            (p_n - (p_n.n_n) n_n) c (2/(Gamma_k,n + Gamma_k,m))^2                    (eq. 27)
//! ```
//!
//! In eq. 27 the push's component along the tangent plane is subtracted, in that plane. The push jumps by c at a
//! shell, stays where f = 0, and its direction knows nothing of the flow: with one theta_2 the robot is faster past
//! an obstacle on one side, slower or at a stop on the other.
//!
//! # `WithFlow`: what changes
//!
//! The default keeps both sums. It chooses the direction of the push by the flow, bounds its length by beta |f|, and
//! lets it fade in:
//!
//! ```text
//! phi_n  = clamp((1 - Gamma_k,n)/0.1, 0, 1)        fade: 0 at the shell, 1 from a thin band on inwards
//! t_n    = u - (u.n_n) n_n + 0.01 |f| e_n          the flow in the tangent plane, and a little to a fixed side
//! that_n = t_n / max(|t_n|, 0.02 |f|)              its direction; shorter where there is hardly any flow
//!
//! faster = sum_n that_n phi_n prod_(m != n) (1 - phi_m)  min(c/Gamma_k,n^2, beta |f|)
//! z      = sum over ordered pairs n != m of
//!              that_n phi_n phi_m                        min(c (2/(Gamma_k,n + Gamma_k,m))^2, beta |f|)
//! u'     = (1 - min(|z|/|u|, 0.8)) u + faster
//! ```
//!
//! with e_n a fixed side: in 2-D n_n turned by +90 degrees, in 3-D a x n_n with a = Q_n (1, 2, 2)/3, an axis that
//! turns with the obstacle.
//!
//! | | `Fixed` | `WithFlow` |
//! |---|---|---|
//! | one layer | pushes along R(theta_2) r, into the core or off it | speeds the flow up along the surface |
//! | several | subtracts a tangent of each | shortens u, at most to a fifth; its direction stays |
//! | at a shell | jumps by c | continuous (phi) |
//! | where f = 0 | pushes on | no push: the attractor stays an equilibrium |
//! | at a saddle point, u = 0 | pushes along R(theta_2) r | leaves to the fixed side |
//!
//! A shortened flow crosses no surface that it did not cross; a tangent of one obstacle may point into its neighbour.
//!
//! # Constants
//!
//! | | value | what for |
//! |---|---|---|
//! | `FADING` | 10 = 1/0.1 | how fast phi grows over Gamma_k |
//! | `SIDE` | 0.01 | the fixed side's share of \|f\|: enough to leave a saddle point |
//! | `FULL` | 0.02 | tangential flow over \|f\| from which the push has its full length |
//! | `SLOWEST` | 0.8 | the largest slow-down over the speed |
//! | `MOST` | 1e6 m/s | no push is longer: no speed limit lets through what is cut |
//! | | 1e-9 | the least Gamma_k counts as this, so that f32 holds its square |
//!
//! ```
//! use pliant_core::nalgebra::Vector2;
//! use pliant_core::{Controller, Motion, Obstacle, ObstacleSpec, Region, RobotState, Settings};
//! let mut controller: Controller<f64, 2, 2> = Controller::new(Motion::linear(Vector2::zeros(), 1.0).unwrap(), Settings::default());
//! // A ball of 5 cm in a soft layer of 10 cm, which the robot passes on its way to the origin.
//! let (center, soft_ratio) = (Vector2::new(0.3, 0.0), Vector2::new(2.0, 2.0));
//! controller.upsert(1, Obstacle::new(ObstacleSpec { center, soft_ratio, ..ObstacleSpec::default() }).unwrap(), 0.0).unwrap();
//! let at = |x| controller.evaluate(&RobotState::new(x).unwrap());
//! let soft = at(Vector2::new(0.3, 0.06));
//! assert_eq!(soft.region, Region::Soft);
//! // c/Gamma_k^2 with Gamma_k = (0.06/0.1)^2, along the surface, where the flow goes.
//! let faster = soft.adapted - soft.modulated;
//! assert!((faster.norm() - 0.03 / 0.6_f64.powi(4)).abs() < 1e-9 && faster.dot(&soft.modulated) > 0.0);
//! // At the shell it has faded to nothing.
//! let shell = at(Vector2::new(0.3, 0.1 - 1e-9));
//! assert!((shell.adapted - shell.modulated).norm() < 1e-6);
//! ```

use crate::obstacle::SoftLayer;
use crate::{Scalar, Vector, norm};

/// Which way the push in a soft layer points, and what bounds it. The [module](self) has the equations of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SteeringPolicy<S> {
    /// The paper to the letter (eqs. 15 and 27 of Chen et al.): the reference direction turned by theta_2 (about z in
    /// 3-D), with the paper's sign.
    ///
    /// ```text
    /// u + S_n R(theta_2) rhat_n c/Gamma_k,n^2
    /// ```
    ///
    /// Whether it speeds the robot up or stops it dead depends on the side it passes on. It jumps at the shell and
    /// does not vanish where f does.
    Fixed {
        /// cos theta_2; cos^2 + sin^2 is 1 to within 1e-3.
        cos: S,
        /// sin theta_2
        sin: S,
    },
    /// Along the tangent plane in the direction of the flow, at most `beta` times the nominal speed, fading in at the
    /// shell.
    ///
    /// ```text
    /// u + that_n phi_n min(c/Gamma_k,n^2, beta |f|)
    /// ```
    ///
    /// Keeps the attractor an equilibrium and the velocity continuous. Where layers overlap u is shortened, by at
    /// most four fifths.
    WithFlow {
        /// Largest push over |f(x)|, dimensionless, 0 to 10; 1 by default, 0 pushes nowhere.
        beta: S,
    },
}

impl<S: Scalar> SteeringPolicy<S> {
    /// The paper's policy for theta_2 in rad, a finite number.
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

/// The modulated velocity u, adapted to the soft layers x is in; `gain` is the paper's c, `nominal` |f(x)|, both in
/// m/s.
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
