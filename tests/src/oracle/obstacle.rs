//! One obstacle: its gammas, its normal and the velocity of its surface, section 2.

use nalgebra::{DMatrix, DVector};

use super::error::OracleError;
use super::geometry::{cross, rotation_matrix, turned_left, vector};
use super::scene::{OracleMethod, OracleObstacle, OracleSpin};

/// An obstacle, checked and brought into matrices.
pub(super) struct Body {
    pub(super) center: DVector<f64>,
    pub(super) rotation: DMatrix<f64>,
    /// Semi-axes of the surface that is impenetrable: the core times its margin.
    pub(super) hard: DVector<f64>,
    /// Semi-axes of the soft shell.
    pub(super) soft: DVector<f64>,
    /// 2p
    pub(super) exponent: f64,
    reference: DVector<f64>,
    velocity: DVector<f64>,
    spin: OracleSpin,
}

impl Body {
    pub(super) fn new(obstacle: &OracleObstacle, dimension: usize, method: OracleMethod) -> Result<Self, OracleError> {
        let axes = vector(&obstacle.axes, dimension, "axes")?;
        let margin = vector(&obstacle.margin, dimension, "margin")?;
        let soft_ratio = vector(&obstacle.soft_ratio, dimension, "soft ratio")?;
        if axes.iter().any(|a| *a <= 0.0) {
            return Err(OracleError::Value("axes"));
        }
        if margin.iter().any(|eta| *eta < 1.0) {
            return Err(OracleError::Value("margin"));
        }
        if soft_ratio.iter().any(|rho| *rho < 1.0) {
            return Err(OracleError::Value("soft ratio"));
        }
        if !(1..=8).contains(&obstacle.curvature) {
            return Err(OracleError::Value("curvature"));
        }
        match obstacle.spin {
            OracleSpin::Planar(w) if w.is_finite() => {}
            OracleSpin::Spatial(w) if dimension == 3 && w.iter().all(|c| c.is_finite()) => {}
            _ => return Err(OracleError::Value("spin")),
        }
        let soft = match method {
            OracleMethod::Original => axes.clone(),
            OracleMethod::Deformable => axes.component_mul(&soft_ratio),
        };
        Ok(Self {
            center: vector(&obstacle.center, dimension, "center")?,
            rotation: rotation_matrix(obstacle.rotation, dimension)?,
            hard: axes.component_mul(&margin),
            soft,
            exponent: 2.0 * f64::from(obstacle.curvature),
            reference: vector(&obstacle.reference, dimension, "reference")?,
            velocity: vector(&obstacle.velocity, dimension, "velocity")?,
            spin: obstacle.spin,
        })
    }

    /// The point in the obstacle's frame.
    pub(super) fn local(&self, x: &DVector<f64>) -> DVector<f64> {
        self.rotation.tr_mul(&(x - &self.center))
    }

    /// The point of the world from its place in the obstacle's frame.
    pub(super) fn world(&self, q: &DVector<f64>) -> DVector<f64> {
        &self.center + &self.rotation * q
    }

    /// Gamma.
    pub(super) fn gamma(&self, x: &DVector<f64>) -> f64 {
        self.power_sum(x, &self.hard)
    }

    /// Gamma_k.
    pub(super) fn gamma_soft(&self, x: &DVector<f64>) -> f64 {
        self.power_sum(x, &self.soft)
    }

    fn power_sum(&self, x: &DVector<f64>, axes: &DVector<f64>) -> f64 {
        self.local(x).iter().zip(axes).map(|(q, a)| (q / a).abs().powf(self.exponent)).sum()
    }

    /// dGamma/dx: each axis i of the frame is a direction e_i of the world along which
    /// |q_i / a|^2p changes by 2p sgn(q_i) |q_i / a|^(2p - 1) / a.
    pub(super) fn gradient(&self, x: &DVector<f64>) -> DVector<f64> {
        let offset = x - &self.center;
        let mut gradient = DVector::zeros(x.len());
        for (axis, a) in self.rotation.column_iter().zip(&self.hard) {
            let ratio = axis.dot(&offset) / a;
            let slope = self.exponent / a * ratio.abs().powf(self.exponent - 1.0);
            gradient += axis * slope.copysign(ratio);
        }
        gradient
    }

    /// From the reference point to x.
    pub(super) fn radius(&self, x: &DVector<f64>) -> DVector<f64> {
        x - self.world(&self.reference)
    }

    /// Direction of the first axis in the x-y plane, rad.
    pub(super) fn heading(&self) -> f64 {
        self.rotation[(1, 0)].atan2(self.rotation[(0, 0)])
    }

    /// v + w x (x - c).
    pub(super) fn surface_velocity(&self, x: &DVector<f64>) -> DVector<f64> {
        let arm = x - &self.center;
        let turning = match self.spin {
            OracleSpin::Planar(w) if arm.len() == 2 => turned_left(&arm) * w,
            OracleSpin::Planar(w) => cross(&DVector::from_column_slice(&[0.0, 0.0, w]), &arm),
            OracleSpin::Spatial(w) => cross(&DVector::from_column_slice(&w), &arm),
        };
        &self.velocity + turning
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene::OracleRotation;
    use super::*;

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    fn body(obstacle: &OracleObstacle) -> Body {
        Body::new(obstacle, obstacle.center.len(), OracleMethod::Deformable).unwrap()
    }

    #[test]
    fn gammas_by_hand() {
        let mut obstacle = OracleObstacle::still(&[1.0, 0.0], &[2.0, 1.0]).soft(1.5);
        obstacle.margin = vec![1.0, 1.2];
        let ellipse = body(&obstacle);
        assert!((ellipse.gamma(&v(&[5.0, 0.0])) - 4.0).abs() < 1e-15);
        assert!((ellipse.gamma(&v(&[1.0, 2.4])) - 4.0).abs() < 1e-14);
        // The soft shell ignores the margin.
        assert!((ellipse.gamma_soft(&v(&[1.0, 1.5])) - 1.0).abs() < 1e-15);
        assert!((ellipse.gamma_soft(&v(&[4.0, 0.0])) - 1.0).abs() < 1e-15);
        obstacle.curvature = 3;
        assert!((body(&obstacle).gamma(&v(&[5.0, 0.0])) - 64.0).abs() < 1e-12);
        // A quarter turn swaps the axes.
        obstacle.curvature = 1;
        obstacle.rotation = OracleRotation::Angle(std::f64::consts::FRAC_PI_2);
        assert!((body(&obstacle).gamma(&v(&[1.0, 4.0])) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn the_heading_is_that_of_the_first_axis() {
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[2.0, 1.0]);
        obstacle.rotation = OracleRotation::Angle(0.6);
        assert!((body(&obstacle).heading() - 0.6).abs() < 1e-15);
        // 120 degrees about (1, 1, 1) takes x to y.
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0, 0.0], &[2.0, 1.0, 1.0]);
        obstacle.rotation = OracleRotation::Quaternion([0.5, 0.5, 0.5, 0.5]);
        assert!((body(&obstacle).heading() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn the_original_method_has_no_soft_layer() {
        let obstacle = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]).soft(2.0);
        let rigid = Body::new(&obstacle, 2, OracleMethod::Original).unwrap();
        assert_eq!(rigid.gamma_soft(&v(&[1.5, 0.0])), 2.25);
        assert_eq!(body(&obstacle).gamma_soft(&v(&[1.5, 0.0])), 0.5625);
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let mut obstacle = OracleObstacle::still(&[0.3, -0.2, 0.1], &[0.5, 0.3, 0.4]);
        obstacle.margin = vec![1.1, 1.3, 1.0];
        obstacle.rotation = OracleRotation::Quaternion([0.8, -0.3, 0.5, 0.2]);
        for curvature in 1..=4 {
            obstacle.curvature = curvature;
            let body = body(&obstacle);
            for x in [v(&[0.9, 0.2, -0.3]), v(&[0.3, -0.7, 0.5]), v(&[0.1, -0.25, 0.15])] {
                let gradient = body.gradient(&x);
                for i in 0..3 {
                    let mut step = v(&[0.0, 0.0, 0.0]);
                    step[i] = 1e-5;
                    let slope = (body.gamma(&(&x + &step)) - body.gamma(&(&x - &step))) / 2e-5;
                    assert!((slope - gradient[i]).abs() < 1e-6 * gradient.amax().max(1e-3), "{slope} {gradient}");
                }
            }
        }
    }

    #[test]
    fn gamma_is_homogeneous() {
        // Euler: (x - c).g = 2p Gamma.
        let mut obstacle = OracleObstacle::still(&[0.1, 0.2], &[0.5, 0.3]);
        obstacle.rotation = OracleRotation::Angle(0.6);
        obstacle.curvature = 2;
        let body = body(&obstacle);
        let x = v(&[0.8, 0.7]);
        let euler = (&x - &body.center).dot(&body.gradient(&x)) / body.gamma(&x);
        assert!((euler - 4.0).abs() < 1e-13);
    }

    #[test]
    fn the_surface_turns_counter_clockwise() {
        let mut obstacle = OracleObstacle::still(&[1.0, 1.0], &[0.5, 0.5]);
        obstacle.velocity = vec![0.1, 0.0];
        obstacle.spin = OracleSpin::Planar(2.0);
        assert_eq!(body(&obstacle).surface_velocity(&v(&[2.0, 1.0])).as_slice(), &[0.1, 2.0]);
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0, 0.0], &[0.5, 0.5, 0.5]);
        obstacle.spin = OracleSpin::Spatial([0.0, 3.0, 0.0]);
        assert_eq!(body(&obstacle).surface_velocity(&v(&[1.0, 0.0, 2.0])).as_slice(), &[6.0, 0.0, -3.0]);
    }

    #[test]
    fn what_the_method_does_not_allow_is_refused() {
        let good = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]);
        let refused = |obstacle: OracleObstacle| Body::new(&obstacle, 2, OracleMethod::Deformable).err();
        assert_eq!(refused(good.clone()), None);
        assert_eq!(refused(good.clone().soft(0.9)), Some(OracleError::Value("soft ratio")));
        assert_eq!(refused(OracleObstacle { axes: vec![1.0], ..good.clone() }), Some(OracleError::Shape("axes")));
        assert_eq!(refused(OracleObstacle { curvature: 9, ..good.clone() }), Some(OracleError::Value("curvature")));
        let spatial = OracleObstacle { spin: OracleSpin::Spatial([0.0; 3]), ..good };
        assert_eq!(refused(spatial), Some(OracleError::Value("spin")));
    }
}
