//! One obstacle: a hard core, perhaps in a soft layer, that moves.
//!
//! ```text
//! Gamma(x)   = sum_i |q_i / (eta_i a_i)|^2p     <= 1: hard
//! Gamma_k(x) = sum_i |q_i / (rho_i a_i)|^2p     <= 1: soft, where not hard        q = Q' (x - c)
//! ```
//!
//! Gamma after Khansari-Zadeh & Billard (2012) with the safety factors eta inside, so that the inflated surface is the one that
//! cannot be penetrated; Gamma_k is eq. 13 of Chen et al., with ln k + 1 = rho.

use crate::{Matrix, RANGE, Scalar, Vector, in_range, is_zero, norm, rotation};

/// Largest curvature exponent p.
pub const MAX_CURVATURE: u8 = 8;
/// Smallest hard semi-axis, m.
pub const MIN_AXIS: f64 = 1e-4;
/// An obstacle with a larger Gamma is too far to change a digit of the velocity.
pub const FAR: f64 = 1e15;
/// Largest linear (m/s) and angular (rad/s) speed of an obstacle.
pub const MAX_SPEED: f64 = 100.0;

/// What an obstacle is made from; [`Obstacle::new`] checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSpec<S: Scalar, const D: usize> {
    /// c, m.
    pub center: Vector<S, D>,
    /// Q, from the obstacle's frame to the world's.
    pub rotation: Matrix<S, D>,
    /// a, the hard semi-axes, m.
    pub axes: Vector<S, D>,
    /// rho = b/a >= 1, soft over hard semi-axis; 1 is rigid. For one stiffness k: ln k + 1.
    pub soft_ratio: Vector<S, D>,
    /// eta >= 1, the safety factor on each hard semi-axis.
    pub margin: Vector<S, D>,
    /// p, 1 (ellipsoid) to [`MAX_CURVATURE`] (nearly a box).
    pub curvature: u8,
    /// The reference point in the obstacle's frame, m; inside the hard core.
    pub reference: Vector<S, D>,
    /// Of the centre, m/s.
    pub velocity: Vector<S, D>,
    /// Angular velocity as a skew matrix, rad/s; see [`rotation::planar_spin`] and [`rotation::spatial_spin`].
    pub spin: Matrix<S, D>,
}

impl<S: Scalar, const D: usize> Default for ObstacleSpec<S, D> {
    /// A rigid ball of 5 cm radius at the origin, at rest.
    fn default() -> Self {
        let ones = Vector::<S, D>::from_element(S::one());
        Self {
            center: Vector::zeros(),
            rotation: Matrix::identity(),
            axes: ones * S::from_f64(0.05),
            soft_ratio: ones,
            margin: ones,
            curvature: 1,
            reference: Vector::zeros(),
            velocity: Vector::zeros(),
            spin: Matrix::zeros(),
        }
    }
}

/// The field for which a specification is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObstacleError {
    /// Not finite, or beyond +-1000 m.
    Center,
    /// Not a rotation (orthonormal to 1e-3, right-handed).
    Rotation,
    /// Not between [`MIN_AXIS`] and 1000 m.
    Axes,
    /// Not between 1 and 100.
    SoftRatio,
    /// Not between 1 and 100.
    Margin,
    /// Not between 1 and [`MAX_CURVATURE`].
    Curvature,
    /// Not inside the hard core.
    Reference,
    /// Not finite, or beyond [`MAX_SPEED`].
    Velocity,
    /// Not skew, not finite, or beyond [`MAX_SPEED`].
    Spin,
}

/// A checked obstacle, at its present pose.
///
/// ```
/// use pliant_core::{Obstacle, ObstacleError, ObstacleSpec, Vector};
/// let ball = Obstacle::new(ObstacleSpec::<f64, 2>::default()).unwrap();
/// assert!((ball.gamma(&Vector::<f64, 2>::new(0.1, 0.0)) - 4.0).abs() < 1e-12);
/// let flat = ObstacleSpec { axes: Vector::<f64, 2>::new(0.1, 0.0), ..ObstacleSpec::default() };
/// assert_eq!(Obstacle::new(flat).unwrap_err(), ObstacleError::Axes);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle<S: Scalar, const D: usize> {
    spec: ObstacleSpec<S, D>,
    /// How much ageing has added to each hard semi-axis, m.
    growth: S,
    /// How fast it is adding to them now, m/s.
    growing: S,
    /// 1/(eta a + growth)
    hard: Vector<S, D>,
    /// 1/(rho a)
    soft: Vector<S, D>,
}

impl<S: Scalar, const D: usize> Obstacle<S, D> {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is out of its range, as [`ObstacleError`] states it.
    pub fn new(spec: ObstacleSpec<S, D>) -> Result<Self, ObstacleError> {
        let within =
            |v: &Vector<S, D>, low: f64, high: f64| v.iter().all(|x| *x >= S::from_f64(low) && *x <= S::from_f64(high));
        let check = |ok: bool, error: ObstacleError| if ok { Ok(()) } else { Err(error) };
        let max_speed = S::from_f64(MAX_SPEED);
        check(in_range(&spec.center), ObstacleError::Center)?;
        check(rotation::is_rotation(&spec.rotation), ObstacleError::Rotation)?;
        check(within(&spec.axes, MIN_AXIS, RANGE), ObstacleError::Axes)?;
        check(within(&spec.soft_ratio, 1.0, 100.0), ObstacleError::SoftRatio)?;
        check(within(&spec.margin, 1.0, 100.0), ObstacleError::Margin)?;
        check((1..=MAX_CURVATURE).contains(&spec.curvature), ObstacleError::Curvature)?;
        check(spec.velocity.iter().all(|v| v.abs() <= max_speed), ObstacleError::Velocity)?;
        check(rotation::is_spin(&spec.spin, max_speed), ObstacleError::Spin)?;
        let core = spec.axes.map(|a| S::one() / a);
        check(level(&spec.reference, &core, spec.curvature) < S::one(), ObstacleError::Reference)?;
        let soft = spec.axes.component_mul(&spec.soft_ratio).map(|b| S::one() / b);
        let mut obstacle = Self { spec, growth: S::zero(), growing: S::zero(), hard: core, soft };
        obstacle.grow(S::zero(), S::zero());
        Ok(obstacle)
    }

    /// Where and how it is now: the specification, with the pose carried on to the present.
    pub fn spec(&self) -> &ObstacleSpec<S, D> {
        &self.spec
    }

    /// Gamma(x), dimensionless, with safety factors and ageing.
    pub fn gamma(&self, x: &Vector<S, D>) -> S {
        level(&self.local(x), &self.hard, self.spec.curvature)
    }

    /// Gamma_k(x), dimensionless.
    pub fn gamma_soft(&self, x: &Vector<S, D>) -> S {
        level(&self.local(x), &self.soft, self.spec.curvature)
    }

    /// dGamma/dx, 1/m.
    pub fn gradient(&self, x: &Vector<S, D>) -> Vector<S, D> {
        let two_p = S::from_f64(2.0 * f64::from(self.spec.curvature));
        let local = self.local(x).zip_map(&self.hard, |q, inverse| {
            let u = q * inverse;
            two_p * (u * u).powi(self.spec.curvature.saturating_sub(1)) * u * inverse
        });
        self.spec.rotation * local
    }

    /// The velocity of the obstacle's matter at x, m/s: v + w x (x - c).
    pub fn surface_velocity(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.spec.velocity + self.spec.spin * (x - self.spec.center)
    }

    /// The reference point in the world's frame, m.
    pub fn reference(&self) -> Vector<S, D> {
        self.spec.center + self.spec.rotation * self.spec.reference
    }

    /// Everything the modulation wants to know at x, or `None` where the obstacle is too [`FAR`] to matter.
    pub(crate) fn sample(&self, x: &Vector<S, D>) -> (S, Option<Sample<S, D>>) {
        let q = self.local(x);
        let gamma = level(&q, &self.hard, self.spec.curvature);
        if !(gamma < S::from_f64(FAR)) {
            return (S::MAX, None);
        }
        let gradient = self.outward(&q);
        let length = norm(&gradient);
        let normal = if length > S::zero() { gradient / length } else { Vector::zeros() };
        let sample = Sample {
            gamma,
            gamma_soft: level(&q, &self.soft, self.spec.curvature),
            normal,
            arm: x - self.reference(),
            // A growing surface also comes towards x, at most at the rate of its axes.
            surface_velocity: self.surface_velocity(x) + normal * self.growing,
            first_axis: self.spec.rotation.column(0).into_owned(),
        };
        (gamma, Some(sample))
    }

    /// Carries the pose on by `dt` seconds.
    pub(crate) fn advance(&mut self, dt: S) {
        self.spec.center += self.spec.velocity * dt;
        if !is_zero(&self.spec.spin) {
            self.spec.rotation = rotation::turned(&self.spec.rotation, &self.spec.spin, dt);
        }
    }

    /// Carries the pose on by a time that may be long: in steps that turn it little, at most 100.
    pub(crate) fn carry(&mut self, time: S) {
        let fastest = self.spec.spin.iter().fold(S::zero(), |m, x| m.max(x.abs()));
        let wanted = fastest * time * S::from_f64(20.0);
        let mut steps = S::one();
        while steps < wanted && steps < S::from_f64(100.0) {
            steps += S::one();
        }
        let mut left = steps;
        while left > S::zero() {
            self.advance(time / steps);
            left -= S::one();
        }
    }

    /// Makes every hard semi-axis longer for `dt` seconds at `rate` m/s. The soft layer stays where it is: margin wins over softness.
    pub(crate) fn grow(&mut self, rate: S, dt: S) {
        self.growing = rate;
        self.growth += rate * dt;
        let (axes, margin) = (&self.spec.axes, &self.spec.margin);
        self.hard = axes.zip_map(margin, |a, eta| S::one() / (eta * a + self.growth));
    }

    /// Stops all motion: nobody knows any more.
    pub(crate) fn hold(&mut self) {
        self.growing = S::zero();
        self.spec.velocity = Vector::zeros();
        self.spec.spin = Matrix::zeros();
    }

    /// q = Q' (x - c)
    fn local(&self, x: &Vector<S, D>) -> Vector<S, D> {
        self.spec.rotation.tr_mul(&(x - self.spec.center))
    }

    /// The direction of dGamma/dx, of a length that neither overflows nor underflows, wherever x and whatever p.
    fn outward(&self, q: &Vector<S, D>) -> Vector<S, D> {
        let p = self.spec.curvature;
        let u = q.component_mul(&self.hard);
        let largest = u.iter().fold(S::zero(), |m, u| m.max(u.abs()));
        let scale = if p > 1 && largest > S::from_f64(1e-30) { S::one() / largest } else { S::one() };
        let local = u.zip_map(&self.hard, |u, inverse| {
            let t = u * scale;
            (t * t).powi(p.saturating_sub(1)) * t * inverse
        });
        self.spec.rotation * local
    }
}

/// sum_i |q_i inverse_i|^2p
fn level<S: Scalar, const D: usize>(q: &Vector<S, D>, inverse: &Vector<S, D>, p: u8) -> S {
    q.iter().zip(inverse.iter()).fold(S::zero(), |sum, (q, inverse)| {
        let u = *q * *inverse;
        sum + (u * u).powi(p)
    })
}

/// An obstacle as it looks from one point.
#[derive(Clone, Debug)]
pub(crate) struct Sample<S: Scalar, const D: usize> {
    pub gamma: S,
    pub gamma_soft: S,
    /// n, the direction of dGamma/dx; zero at the centre.
    pub normal: Vector<S, D>,
    /// r, from the reference point to x, m.
    pub arm: Vector<S, D>,
    /// m/s
    pub surface_velocity: Vector<S, D>,
    /// The obstacle's first axis in the world's frame.
    pub first_axis: Vector<S, D>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spec() -> ObstacleSpec<f64, 2> {
        ObstacleSpec {
            center: Vector::<f64, 2>::new(0.3, -0.2),
            rotation: rotation::planar(0.4),
            axes: Vector::<f64, 2>::new(0.08, 0.04),
            soft_ratio: Vector::<f64, 2>::new(1.5, 1.5),
            margin: Vector::<f64, 2>::new(1.1, 1.3),
            curvature: 2,
            ..ObstacleSpec::default()
        }
    }

    #[test]
    fn each_bad_field_is_named() {
        let cases: [(ObstacleSpec<f64, 2>, ObstacleError); 12] = [
            (ObstacleSpec { center: Vector::<f64, 2>::new(f64::NAN, 0.0), ..spec() }, ObstacleError::Center),
            (ObstacleSpec { center: Vector::<f64, 2>::new(1001.0, 0.0), ..spec() }, ObstacleError::Center),
            (ObstacleSpec { rotation: Matrix::zeros(), ..spec() }, ObstacleError::Rotation),
            (ObstacleSpec { rotation: Matrix::<f64, 2>::new(1.0, 0.0, 0.0, -1.0), ..spec() }, ObstacleError::Rotation),
            (ObstacleSpec { axes: Vector::<f64, 2>::new(0.1, 0.0), ..spec() }, ObstacleError::Axes),
            (ObstacleSpec { axes: Vector::<f64, 2>::new(-0.1, 0.1), ..spec() }, ObstacleError::Axes),
            (ObstacleSpec { soft_ratio: Vector::<f64, 2>::new(1.0, 0.9), ..spec() }, ObstacleError::SoftRatio),
            (ObstacleSpec { margin: Vector::<f64, 2>::new(0.9, 1.0), ..spec() }, ObstacleError::Margin),
            (ObstacleSpec { curvature: 0, ..spec() }, ObstacleError::Curvature),
            (ObstacleSpec { reference: Vector::<f64, 2>::new(0.0, 0.05), ..spec() }, ObstacleError::Reference),
            (ObstacleSpec { velocity: Vector::<f64, 2>::new(f64::INFINITY, 0.0), ..spec() }, ObstacleError::Velocity),
            (ObstacleSpec { spin: Matrix::identity(), ..spec() }, ObstacleError::Spin),
        ];
        for (bad, error) in cases {
            assert_eq!(Obstacle::new(bad), Err(error));
        }
    }

    proptest! {
        #[test]
        fn gradient_is_the_slope_of_gamma(x in -0.3..0.9f64, y in -0.7..0.4f64, p in 1..4u8) {
            let o = Obstacle::new(ObstacleSpec { curvature: p, ..spec() }).unwrap();
            let at = Vector::<f64, 2>::new(x, y);
            let gradient = o.gradient(&at);
            for i in 0..2 {
                let mut step = Vector::<f64, 2>::zeros();
                step[i] = 1e-7;
                let slope = (o.gamma(&(at + step)) - o.gamma(&(at - step))) / 2e-7;
                prop_assert!((slope - gradient[i]).abs() <= 1e-5 * (1.0 + gradient.norm()));
            }
        }

        #[test]
        fn the_inflated_surface_has_gamma_one(angle in 0.0..6.3f64) {
            let o = Obstacle::new(ObstacleSpec { curvature: 1, ..spec() }).unwrap();
            let q = Vector::<f64, 2>::new(0.08 * 1.1 * angle.cos(), 0.04 * 1.3 * angle.sin());
            prop_assert!((o.gamma(&(o.spec().center + o.spec().rotation * q)) - 1.0).abs() < 1e-12);
        }
    }
}
