//! Bending the nominal motion round hard cores: the second stage of a tick.
//!
//! Nothing of this module is called from outside. [`Controller::tick`](crate::Controller::tick) drives by it,
//! [`Controller::evaluate`](crate::Controller::evaluate) and [`Controller::modulated`](crate::Controller::modulated)
//! show what it does at a place, [`Stages::modulated`](crate::Stages::modulated) is its result. This page says what
//! that is.
//!
//! Vectors have d = 2 or 3 entries in the world's frame. x is the robot's place (m), f the nominal velocity there
//! (m/s; see [`ds`](crate::ds)). Of obstacle n, Gamma is its dimensionless distance
//! ([`Obstacle::gamma`](crate::Obstacle::gamma): 1 on the surface of the hard core), g = dGamma/dx (1/m;
//! [`Obstacle::gradient`](crate::Obstacle::gradient)), r = x - r0 leads from its reference point to x (m;
//! [`Obstacle::reference`](crate::Obstacle::reference)), and s is how fast its surface moves at x (m/s).
//! (In a tree of overlapping cores r leans towards that of its root: [`Obstacle::hub`](crate::Obstacle::hub).)
//!
//! # One obstacle
//!
//! As seen by whoever stands on the surface, the velocity u = f - s is taken apart along r and along the tangent
//! plane. The part along r becomes shorter, down to nothing at the surface, and the tangential one longer:
//!
//! ```text
//! xdot_n = s + E D E^-1 (f - s)
//! E = [ r/|r|, e_1, .., e_(d-1) ]                 e_i: any basis of the tangent plane, g.e_i = 0
//! D = diag( 1 - 1/G, 1 + 1/G, .., 1 + 1/G )       G = max(Gamma, 1)
//! ```
//!
//! Neither a basis nor an inverse is needed for it. The part of u along r is ((g.u)/(g.r)) r, whatever the basis, so
//!
//! ```text
//! xdot_n = s + (1 + 1/G) u - (2/G) ((g.u)/(g.r)) r
//! g.(xdot_n - s) = (1 - 1/G) g.u                  nothing on the surface: no flow through it
//! ```
//!
//! in which neither g nor r need be of unit length. This closed form is what is evaluated. Far away, G to infinity,
//! xdot_n = f. Inside a core G = 1: the flow has no part along r, and leads out no more than in.
//!
//! The eigenvalues are of Khansari-Zadeh & Billard (2012); that r leads from a reference point, from which a concave
//! body is seen whole, is of Huber, Billard & Slotine (2019); these are eqs. 7-10 of Chen et al. A
//! [`wall`](crate::ObstacleSpec::wall) has 1/gamma in the place of gamma, so that g points into its free space, where
//! the reference point is: g.r is below zero there, and the formula is the same.
//!
//! **No split.** Where g.r (of a wall -g.r) <= 1e-6 |g|_1 |r|_1 (sums of absolute values), the reference point sees
//! the surface edgewise or from behind, or x is the centre. Then xdot_n = s, and the tick says
//! [`Status::REFERENCE`](crate::Status::REFERENCE). An obstacle whose Gamma reaches [`Scalar::FAR`] would not change
//! a digit and is left out.
//!
//! # Obstacles that move
//!
//! ```text
//! s(x) = v + w x (x - c) + b n                    n = g/|g|
//! ```
//!
//! with v and w the linear (m/s) and angular (rad/s) velocity of the obstacle, c its centre, and b (m/s) how fast the
//! surface comes towards free space because the body grows or ages ([`obstacle`](crate::obstacle) has b). The flow is
//! tangential in the frame of the surface: what comes pushes the robot along. Passing what moves in its own frame is
//! known from Khansari-Zadeh & Billard (2012) and Huber et al. (2019); b is ours.
//!
//! # Several obstacles
//!
//! Each bends f as if it were alone. The results are weighed by nearness,
//!
//! ```text
//! w_n = (1/(Gamma_n - 1)) / sum_m (1/(Gamma_m - 1))
//! ```
//!
//! (if any Gamma_n <= 1, those share the weight equally and the others have none), so that on a surface its own
//! obstacle alone counts and nothing flows through it. Speeds and directions are averaged apart, for a mean of
//! velocities could cancel to a standstill:
//!
//! ```text
//! speed    = sum_n w_n |xdot_n|
//! fhat     = f/|f|,   cos_n = xdot_n.fhat/|xdot_n|,   t_n = xdot_n/|xdot_n| - cos_n fhat
//! kappa_n  = atan2(|t_n|, cos_n) t_n/|t_n|        0 where xdot_n or t_n is
//! kappa    = sum_n w_n kappa_n                    rad, in the plane across f
//! xdot     = speed (cos|kappa| fhat + sin|kappa| kappa/|kappa|)
//! ```
//!
//! kappa_n says by which angle, and to which side, obstacle n turns the flow away from f. Weights and both means are
//! of Huber et al. (2019). With no obstacle, xdot = f; with one, xdot = xdot_1.
//!
//! **Continuity among moving obstacles.** A direction opposite to f has its angle on either side, and f = 0 has none.
//! Towards both the mean of angles fades into the plain mean of velocities:
//!
//! ```text
//! z    = max( max_n over cos_n < 0 of 1 - |t_n|/(0.3 |cos_n|),   1 - |f|/(0.05 speed),   0 )
//! xdot = (1 - z) speed (..) + z sum_n w_n xdot_n
//! ```
//!
//! This is ours, as is all that is done where cores overlap (they share a reference point; see
//! [`table`](crate::table)). A [`scan`](crate::scan) counts as one more obstacle.
//!
//! # What does not hold
//!
//! A robot that comes exactly head-on at a rigid obstacle stops at its surface: f and r are parallel there, and the
//! modulation has a saddle point. A soft layer ([`adaptive`](crate::adaptive)) pushes the robot off it. In discrete
//! time a velocity along a curved surface ends outside of the tangent plane, and a moving obstacle may cross: keeping
//! samples out is the [`guard`](crate::guard)'s part.
//!
//! # Example
//!
//! At the surface the velocity is tangential, as seen from there, whatever else is near; away from it the closed form
//! is E D E^-1.
//!
//! ```
//! use pliant_core::nalgebra::{Matrix2, Vector2};
//! use pliant_core::{Controller, Motion, Obstacle, ObstacleSpec, RobotState, Settings};
//!
//! let motion = Motion::linear(Vector2::zeros(), 1.0).unwrap(); // f = -x
//! let mut controller: Controller<f64, 2, 2> = Controller::new(motion, Settings::default());
//! // A ball of 5 cm that drifts, and one at rest.
//! let [center, velocity] = [Vector2::new(0.3, 0.0), Vector2::new(0.0, 0.1)];
//! let ball = Obstacle::new(ObstacleSpec { center, velocity, ..ObstacleSpec::default() }).unwrap();
//! let other = Obstacle::new(ObstacleSpec { center: Vector2::new(0.3, 0.2), ..ObstacleSpec::default() }).unwrap();
//! controller.upsert(1, ball.clone(), 0.0).unwrap();
//! controller.upsert(2, other, 0.0).unwrap();
//!
//! for way in [Vector2::new(1.0, 0.2), Vector2::new(0.5, -1.0), Vector2::new(-1.0, 0.1)] {
//!     let x = ball.surface(&way);
//!     let seen = controller.evaluate(&RobotState::new(x).unwrap()).modulated - ball.surface_velocity(&x);
//!     let normal = ball.gradient(&x).normalize();
//!     assert!(normal.dot(&seen).abs() < 1e-9); // m/s
//! }
//!
//! // With one obstacle, anywhere: E D E^-1 by hand.
//! controller.table_mut().remove(2);
//! let x = Vector2::new(0.4, 0.03);
//! let (gamma, g, r, s) = (ball.gamma(&x), ball.gradient(&x), x - ball.reference(), ball.surface_velocity(&x));
//! let e = Matrix2::from_columns(&[r.normalize(), Vector2::new(-g.y, g.x).normalize()]);
//! let d = Matrix2::new(1.0 - 1.0 / gamma, 0.0, 0.0, 1.0 + 1.0 / gamma);
//! let expected = s + e * d * e.try_inverse().unwrap() * (-x - s);
//! assert!((controller.modulated(&RobotState::new(x).unwrap()) - expected).norm() < 1e-12);
//! ```
//!
//! # Sources
//!
//! S. M. Khansari-Zadeh, A. Billard: *A Dynamical System Approach to Realtime Obstacle Avoidance*, Autonomous Robots
//! 2012. L. Huber, A. Billard, J.-J. Slotine: *Avoidance of Convex and Concave Obstacles With Convergence Ensured
//! Through Contraction*, IEEE RA-L 2019. L. Chen et al.: *Enhanced Robotic Navigation in Deformable Environments
//! using Learning from Demonstration and Dynamic Modulation*.

#![allow(
    clippy::needless_range_loop,
    clippy::modulo_one,
    reason = "loops over lanes index several arrays alike, which makes them vector instructions; there may be one lane"
)]

mod mean;

use core::array::from_fn;

use mean::DirectionalMean;

use crate::obstacle::{Abreast, Sample};
use crate::scalar::lanes::{Each, LANES, Lanes};
use crate::{Scalar, Vector};

/// The velocity past one obstacle:
///
/// ```text
/// xdot = s + M (f - s),   M u = (1 + 1/G) u - (2/G) ((g.u)/(g.r)) r,   G = max(Gamma, 1)
/// ```
///
/// which is E D E^-1 with E = [r/|r|, tangents of g] and D = diag(1 - 1/G, 1 + 1/G, ...): u minus its part along r
/// (split by the tangent plane) is tangential and stretched, the part along r is compressed. Neither g nor r need be
/// of unit length. Where g.r is not positive, or so small that it may be rounding, there is no such split: then the
/// answer is false, and s.
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
    /// The obstacles so far: how much one weighs is known when all are there, and what is done to them would not fit
    /// into registers along with what is done to find them.
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

    /// The velocity past all of them and past one more, if there is one, m/s; and whether one of their reference
    /// points was unusable. `gamma` is the least Gamma of those pushed.
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

/// A weight proportional to 1/(Gamma - 1), scaled so that the nearest obstacle's is one: no overflow, and where the
/// nearest is touched (its Gamma - 1, cut off at zero, is zero) those that are touched alone count.
#[inline(always)]
pub(crate) fn weight<S: Scalar>(distance: S, nearest: S) -> S {
    if distance > nearest { nearest / distance } else { S::one() }
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
#[cfg(test)]
mod weights;
