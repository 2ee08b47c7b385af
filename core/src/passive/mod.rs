//! Passive interaction: a wrench that drives the robot along the flow and gives way to whoever pushes it.
//!
//! Kronander & Billard, "Passive Interaction Control With Dynamical Systems", IEEE RA-L 1(1), 2016. With u the wanted
//! velocity and xdot the robot's (m/s),
//!
//! ```text
//! F = beta D(u) u - D(u) xdot                                     (N)
//! D(u) = lambda_2 I + (lambda_1 - lambda_2) u u' / (|u|^2 + eps^2)   (N s/m)
//! ```
//!
//! D is symmetric positive definite. u is its first eigenvector, with the value lambda_2 + (lambda_1 - lambda_2) phi,
//! phi = |u|^2/(|u|^2 + eps^2), so lambda_1 for any speed well above eps; lambda_2 is the value of every direction
//! across. No basis is drawn, so nothing is arbitrary in three dimensions, and where u vanishes D is lambda_2 I without
//! a jump: |D(u) - D(w)| <= 0.71 |lambda_1 - lambda_2| |u - w| / eps (Frobenius).
//!
//! With beta = 1 this is F = -D (xdot - u). The damping D xdot only takes energy; the drive D u may give some. What it
//! gives is paid from an energy [`Tank`], which is filled by what the damping takes; beta in [0, 1] is what the tank
//! can pay for.
//!
//! # Why it is passive, in discrete time
//! In each step of dt seconds, with the dissipated power P_d = xdot' D xdot >= 0 and the injected power P_i = xdot' D
//! u,
//!
//! ```text
//! s' = s + share P_d dt - beta P_i dt - rejected - rounding,   0 <= s' <= capacity
//! F.xdot dt = beta P_i dt - P_d dt
//! ```
//!
//! so F.xdot dt = s - s' - (1 - share) P_d dt - rejected - rounding <= s - s', and the sum over any sequence of steps,
//! whatever pushes the robot, is at most s(0) - s(T): through its port the controller never gives more than the tank
//! held. Both sides of the account use the same sampled numbers, so this needs no small dt. The paper's alpha(s) and
//! beta(z, s) are smooth switches that make ds/dt vanish at the ends of the tank; sampled, they overshoot the ends by
//! what flows in a step, and a clamp there creates or loses energy. Here a step is settled as a whole instead: what a
//! full tank cannot take is rejected (it is heat) and reported, and where want = P_i dt > s + share P_d dt, beta is the
//! quotient of the two, and the tank ends at exactly zero. beta is continuous in s, u and xdot where want > 0. An empty
//! tank still steers: its drive does no more work than the damping takes, so the robot follows the flow's direction
//! without gaining energy; at rest it has no drive at all. Where P_i < 0 the drive brakes, beta = 1, and what it takes
//! refills the tank as well.
//!
//! Two more differences from the paper. It splits the flow into a conservative part, which has a potential, and a rest,
//! and only the rest is paid from the tank; no potential is known of a flow bent round obstacles, so all of the drive
//! is. And its alpha < 1: here a share of 1 is allowed, for which following the flow at its own speed costs nothing.
//!
//! `rounding` is a bound on this step's rounding errors, always on the safe side (in f32 and at 1 kHz 2e-6 of the power
//! and 4e-6 W), so that the inequality holds for the very numbers returned, however many steps. What it cannot cover is
//! the hold: a robot of mass m that holds F for the step gains |F|^2 dt^2/(2 m) more than F.xdot dt (6e-6 J for 5 N, 2
//! kg, 1 ms), and lambda dt/m < 1 must hold for the damping to be damping, as for any sampled damper.
//!
//! Not here: height and orientation are held by Cartesian impedance, and the torque is J'F + nullspace; both are the
//! robot's side.

mod tank;
#[cfg(test)]
mod tests;

pub use tank::Tank;

use crate::{Matrix, RANGE, Scalar, Vector, in_range};

/// Damping and share, as set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveSpec<S> {
    /// lambda_1, damping along the wanted velocity, N s/m, from 0.01 to 1000: how hard the robot is driven along the
    /// flow.
    pub lambda_along: S,
    /// lambda_2, damping across it, N s/m, from 0.01 to 1000: how stiffly it keeps to the flow's direction.
    pub lambda_across: S,
    /// eps, m/s, from 0.001 to 10: the speed below which the wanted velocity has no direction to speak of. At ten times
    /// this speed the damping along is within 1 % of the way to lambda_1.
    pub blend: S,
    /// Share of what the damping takes that fills the tank, from 0 to 1.
    pub share: S,
}

impl<S: Scalar> Default for PassiveSpec<S> {
    /// 20 N s/m along, 60 N s/m across, 0.01 m/s, all of it.
    fn default() -> Self {
        Self {
            lambda_along: S::from_f64(20.0),
            lambda_across: S::from_f64(60.0),
            blend: S::from_f64(0.01),
            share: S::one(),
        }
    }
}

/// What is wrong with a setting, a tank or a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassiveError {
    /// `lambda_along` is not from 0.01 to 1000 N s/m.
    LambdaAlong,
    /// `lambda_across` is not from 0.01 to 1000 N s/m.
    LambdaAcross,
    /// `blend` is not from 0.001 to 10 m/s.
    Blend,
    /// `share` is not from 0 to 1.
    Share,
    /// The tank's energy is not from 0 to its capacity.
    Energy,
    /// The tank's capacity is not above 0 and at most 1000 J.
    Capacity,
    /// The robot's velocity is not finite, or so large that its force leaves the range of numbers.
    RobotVelocity,
    /// The wanted velocity is not finite, or so large that its force leaves the range of numbers.
    Wanted,
    /// The time step is not above 0 and at most 0.1 s.
    TimeStep,
    /// The work of the step is more than 1 kJ, or leaves the range of numbers.
    Work,
}

impl core::fmt::Display for PassiveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::LambdaAlong => "lambda_along is not from 0.01 to 1000 N s/m",
            Self::LambdaAcross => "lambda_across is not from 0.01 to 1000 N s/m",
            Self::Blend => "blend is not from 0.001 to 10 m/s",
            Self::Share => "share is not from 0 to 1",
            Self::Energy => "the tank's energy is not from 0 J to its capacity",
            Self::Capacity => "the tank's capacity is not above 0 and at most 1000 J",
            Self::RobotVelocity => "robot_velocity is not finite, or its force leaves the range of numbers",
            Self::Wanted => "wanted is not finite, or its force leaves the range of numbers",
            Self::TimeStep => "dt is not above 0 and at most 0.1 s",
            Self::Work => "the work of the step is more than 1000 J, or leaves the range of numbers",
        })
    }
}

impl core::error::Error for PassiveError {}

/// What one step asks of the robot, and what it did to the tank: s' = s + filled - drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction<S: Scalar, const D: usize> {
    /// F, N.
    pub wrench: Vector<S, D>,
    /// beta, from 0 to 1: the part of the drive the tank could pay for.
    pub drive_scale: S,
    /// What the tank took in, J.
    pub filled: S,
    /// What left the tank, J: the drive's work and the allowance for rounding.
    pub drawn: S,
    /// What was offered and did not fit, J: it is heat now.
    pub rejected: S,
}

/// Damping that knows where the flow goes. See the [module](self) for its equations.
///
/// ```
/// use pliant_core::nalgebra::Vector2;
/// use pliant_core::passive::{Passive, PassiveSpec, Tank};
/// let passive = Passive::new(PassiveSpec::default()).unwrap();
/// let mut tank = Tank::new(1.0_f32, 2.0).unwrap(); // J
/// let (mut x, mut v) = (Vector2::new(0.3_f32, 0.0), Vector2::zeros());
/// let dt = 0.001;
/// for _ in 0..5000 {
///     let wanted = -x; // 1/s
///     let step = passive.step(&mut tank, &v, &wanted, dt).unwrap();
///     v += step.wrench * (dt / 2.0); // a mass of 2 kg
///     x += v * dt;
/// }
/// assert!(x.norm() < 0.01 && tank.energy() > 0.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passive<S> {
    spec: PassiveSpec<S>,
}

impl<S: Scalar> Passive<S> {
    /// Checks the settings.
    ///
    /// # Errors
    /// The first setting at fault.
    ///
    /// ```
    /// use pliant_core::passive::{Passive, PassiveError, PassiveSpec};
    /// let spec = PassiveSpec { lambda_across: 0.0_f32, ..PassiveSpec::default() };
    /// assert_eq!(Passive::new(spec).unwrap_err(), PassiveError::LambdaAcross);
    /// ```
    pub fn new(spec: PassiveSpec<S>) -> Result<Self, PassiveError> {
        let within = |x: S, low: f64, high: f64| x >= S::from_f64(low) && x <= S::from_f64(high);
        if !within(spec.lambda_along, 0.01, 1000.0) {
            return Err(PassiveError::LambdaAlong);
        }
        if !within(spec.lambda_across, 0.01, 1000.0) {
            return Err(PassiveError::LambdaAcross);
        }
        if !within(spec.blend, 0.001, 10.0) {
            return Err(PassiveError::Blend);
        }
        if !within(spec.share, 0.0, 1.0) {
            return Err(PassiveError::Share);
        }
        Ok(Self { spec })
    }

    /// The settings.
    pub fn spec(&self) -> &PassiveSpec<S> {
        &self.spec
    }

    /// D(u), N s/m, for a finite wanted velocity u, m/s.
    ///
    /// ```
    /// use pliant_core::nalgebra::Vector3;
    /// use pliant_core::passive::{Passive, PassiveSpec};
    /// let passive = Passive::new(PassiveSpec::default()).unwrap();
    /// let d = passive.damping(&Vector3::new(0.0, 0.5_f64, 0.0));
    /// assert!((d[(1, 1)] - 20.0).abs() < 0.1 && d[(0, 0)] == 60.0 && d[(2, 2)] == 60.0);
    /// ```
    pub fn damping<const D: usize>(&self, wanted: &Vector<S, D>) -> Matrix<S, D> {
        let (direction, extra) = self.along(wanted);
        Matrix::identity() * self.spec.lambda_across + direction * direction.transpose() * extra
    }

    /// F = -D(u) (xdot - u), N, without a tank: not passive for a flow that is not conservative.
    ///
    /// # Errors
    /// Which of the two velocities (m/s) is not finite or too large.
    pub fn wrench<const D: usize>(
        &self,
        robot_velocity: &Vector<S, D>,
        wanted: &Vector<S, D>,
    ) -> Result<Vector<S, D>, PassiveError> {
        let [taking, driving] = self.forces(robot_velocity, wanted)?;
        Ok(driving - taking)
    }

    /// The wrench for the next `dt` seconds, at most as much drive as the tank can pay, and the tank after it.
    ///
    /// # Errors
    /// Which input (m/s, m/s, s) is at fault. The tank is then as it was; no wrench at all is the passive answer.
    pub fn step<const D: usize>(
        &self,
        tank: &mut Tank<S>,
        robot_velocity: &Vector<S, D>,
        wanted: &Vector<S, D>,
        dt: S,
    ) -> Result<Interaction<S, D>, PassiveError> {
        if !(dt > S::zero() && dt <= S::from_f64(0.1)) {
            return Err(PassiveError::TimeStep);
        }
        let [taking, driving] = self.forces(robot_velocity, wanted)?;
        let dissipated = robot_velocity.dot(&taking).max(S::zero());
        let injected = robot_velocity.dot(&driving);

        // Every term of both powers, none cancelled: a scale for their rounding errors, and where fixed point
        // saturates, so does this.
        let speed = robot_velocity.map(|x| x.abs());
        let effort = speed.dot(&taking.map(|x| x.abs())) + speed.dot(&driving.map(|x| x.abs()));
        let grains = dt * S::from_f64(tank::GRAINS);
        if !(effort <= half_of_range() && effort * grains <= tank::largest_step()) {
            return Err(PassiveError::Work);
        }
        // Relative errors of floats, absolute ones of fixed point; a robot at rest does no work, exactly.
        let sum = speed.iter().fold(S::zero(), |s, x| s + *x);
        let rounding = if sum > S::zero() {
            ((effort + sum + S::one()) * grains + S::one()) * (S::EPSILON * S::from_f64(16.0))
        } else {
            S::zero()
        };
        let gain = (self.spec.share * dissipated - injected.min(S::zero())) * grains;
        let paid = tank.settle(gain, injected.max(S::zero()) * grains, rounding);
        Ok(Interaction {
            wrench: driving * paid.scale - taking,
            drive_scale: paid.scale,
            filled: paid.filled,
            drawn: paid.drawn,
            rejected: paid.rejected,
        })
    }

    /// w and c with D = lambda_2 I + c w w': u and eps in units of the largest of them, which cancels, so that neither
    /// square underflows and no root is taken.
    fn along<const D: usize>(&self, wanted: &Vector<S, D>) -> (Vector<S, D>, S) {
        let largest = wanted.iter().fold(self.spec.blend, |m, x| m.max(x.abs()));
        let inverse = S::one() / largest;
        let (direction, blend) = (wanted * inverse, self.spec.blend * inverse);
        let extra = (self.spec.lambda_along - self.spec.lambda_across) / (direction.dot(&direction) + blend * blend);
        (direction, extra)
    }

    /// D xdot and D u, N.
    fn forces<const D: usize>(
        &self,
        robot_velocity: &Vector<S, D>,
        wanted: &Vector<S, D>,
    ) -> Result<[Vector<S, D>; 2], PassiveError> {
        // No term of D v is larger than this product.
        let largest = self.spec.lambda_along.max(self.spec.lambda_across);
        let usable =
            |v: &Vector<S, D>| in_range(v) && largest * v.iter().fold(S::zero(), |s, x| s + x.abs()) <= half_of_range();
        if !usable(robot_velocity) {
            return Err(PassiveError::RobotVelocity);
        }
        if !usable(wanted) {
            return Err(PassiveError::Wanted);
        }
        let (direction, extra) = self.along(wanted);
        Ok([robot_velocity, wanted].map(|v| v * self.spec.lambda_across + direction * (extra * direction.dot(v))))
    }
}

/// Two terms up to this large can be added.
fn half_of_range<S: Scalar>() -> S {
    S::MAX * S::from_f64(0.5)
}

/// Is x above zero and at most [`RANGE`]? False for not-a-number.
fn positive<S: Scalar>(x: S) -> bool {
    x > S::zero() && x <= S::from_f64(RANGE)
}
