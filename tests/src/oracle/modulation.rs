//! Modulation by one obstacle, section 3, as an explicit E D E^-1.

use nalgebra::{DMatrix, DVector};

use super::geometry::{length, tangents, unit};
use super::obstacle::Body;

/// An obstacle whose reference point is seen from further off than this (cosine to the gradient) is unusable.
const USABLE_COSINE: f64 = 1e-6;
/// An obstacle this far away does not change a digit.
pub(super) const FAR: f64 = 1e15;

/// What one obstacle makes of the flow.
pub(super) struct Modulated {
    pub(super) velocity: DVector<f64>,
    /// Cosine between the gradient and the direction from the reference point; 0 at the centre.
    pub(super) cosine: f64,
    pub(super) usable: bool,
}

impl Modulated {
    /// Distance of the cosine from the threshold of use.
    pub(super) fn to_threshold(&self) -> f64 {
        (self.cosine - USABLE_COSINE).abs()
    }
}

/// xdot_n = s + M (f - s).
pub(super) fn modulate(body: &Body, x: &DVector<f64>, f: &DVector<f64>) -> Modulated {
    let surface = body.surface_velocity(x);
    let normal = unit(&body.gradient(x));
    let radial = unit(&body.radius(x));
    let (Some(normal), Some(radial)) = (normal, radial) else {
        return Modulated { velocity: surface, cosine: 0.0, usable: false };
    };
    let cosine = normal.dot(&radial);
    if cosine <= USABLE_COSINE {
        return Modulated { velocity: surface, cosine, usable: false };
    }
    match modulation_matrix(&radial, &normal, body.gamma(x)) {
        Some(m) => Modulated { velocity: &surface + m * (f - &surface), cosine, usable: true },
        None => Modulated { velocity: surface, cosine, usable: false },
    }
}

/// M = E D E^-1, with the first column of E from the reference point to x and the others tangent to Gamma.
fn modulation_matrix(radial: &DVector<f64>, normal: &DVector<f64>, gamma: f64) -> Option<DMatrix<f64>> {
    let closeness = 1.0 / gamma.max(1.0);
    let mut columns = vec![radial.clone()];
    columns.extend(tangents(normal));
    let mut eigenvalues = DVector::from_element(radial.len(), 1.0 + closeness);
    eigenvalues[0] = 1.0 - closeness;
    let e = DMatrix::from_columns(&columns);
    let inverse = e.clone().try_inverse()?;
    Some(e * DMatrix::from_diagonal(&eigenvalues) * inverse)
}

/// The outward unit normal; zero at the centre, where there is none.
pub(super) fn outward_normal(body: &Body, x: &DVector<f64>) -> DVector<f64> {
    unit(&body.gradient(x)).unwrap_or_else(|| DVector::zeros(x.len()))
}

/// The unit vector from the reference point; zero at that point.
pub(super) fn outward_radius(body: &Body, x: &DVector<f64>) -> DVector<f64> {
    let r = body.radius(x);
    let norm = length(&r);
    if norm == 0.0 { r } else { r / norm }
}

#[cfg(test)]
mod tests {
    use super::super::scene::{OracleMethod, OracleObstacle, OracleRotation, OracleSpin};
    use super::*;

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    fn body(obstacle: &OracleObstacle) -> Body {
        Body::new(obstacle, obstacle.center.len(), OracleMethod::Original).unwrap()
    }

    fn tilted() -> OracleObstacle {
        OracleObstacle {
            rotation: OracleRotation::Quaternion([0.7, 0.1, -0.4, 0.5]),
            curvature: 2,
            margin: vec![1.0, 1.2, 1.1],
            reference: vec![0.1, -0.1, 0.05],
            ..OracleObstacle::still(&[0.2, -0.1, 0.4], &[0.6, 0.4, 0.5])
        }
    }

    #[test]
    fn eigenvalues_on_the_axis_of_a_circle() {
        // At twice the radius Gamma = 4: 3/4 of the flow towards the centre, 5/4 of the flow across.
        let circle = body(&OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]));
        let towards = modulate(&circle, &v(&[2.0, 0.0]), &v(&[-1.0, 0.0])).velocity;
        assert!((towards - v(&[-0.75, 0.0])).amax() < 1e-15);
        let across = modulate(&circle, &v(&[2.0, 0.0]), &v(&[0.0, 1.0])).velocity;
        assert!((across - v(&[0.0, 1.25])).amax() < 1e-15);
    }

    #[test]
    fn the_reference_point_sets_the_direction_that_is_damped() {
        // Gamma = 4 at (2, 0); from the reference (0, 0.5), r = (2, -0.5). The flow along r keeps 3/4.
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]);
        obstacle.reference = vec![0.0, 0.5];
        let along = modulate(&body(&obstacle), &v(&[2.0, 0.0]), &v(&[2.0, -0.5])).velocity;
        assert!((along - v(&[1.5, -0.375])).amax() < 1e-15);
        // (1, 0) = r/2 + (0, 0.25): 3/8 (2, -0.5) + 5/4 (0, 0.25) = (0.75, 0.125).
        let mixed = modulate(&body(&obstacle), &v(&[2.0, 0.0]), &v(&[1.0, 0.0])).velocity;
        assert!((mixed - v(&[0.75, 0.125])).amax() < 1e-15);
    }

    #[test]
    fn no_normal_flow_on_the_surface() {
        let mut obstacle = tilted();
        obstacle.velocity = vec![0.3, -0.2, 0.1];
        obstacle.spin = OracleSpin::Spatial([0.5, 1.0, -0.7]);
        let body = body(&obstacle);
        for direction in [[1.0, 0.3, -0.2], [-0.4, 1.0, 0.9], [0.1, -0.2, 1.0], [-1.0, -1.0, -1.0]] {
            let q = v(&direction);
            let onto = body.gamma(&body.world(&q)).powf(-1.0 / body.exponent);
            let x = body.world(&(q * onto));
            assert!((body.gamma(&x) - 1.0).abs() < 1e-13);
            let relative = modulate(&body, &x, &v(&[1.0, 2.0, -1.5])).velocity - body.surface_velocity(&x);
            assert!(outward_normal(&body, &x).dot(&relative).abs() < 1e-12);
            assert!(length(&relative) > 0.1);
        }
    }

    #[test]
    fn far_away_nothing_changes() {
        let mut obstacle = tilted();
        obstacle.velocity = vec![0.3, -0.2, 0.1];
        let f = v(&[1.0, 2.0, -1.5]);
        let far = modulate(&body(&obstacle), &v(&[300.0, 400.0, -200.0]), &f).velocity;
        assert!((far - f).amax() < 1e-9);
    }

    #[test]
    fn the_page_has_the_same_matrix_in_closed_form() {
        let body = body(&tilted());
        let f = v(&[0.4, -0.9, 0.7]);
        for x in [v(&[1.0, 0.5, 0.2]), v(&[-0.6, 0.4, 1.2]), v(&[0.2, -1.1, 0.5]), v(&[0.45, 0.0, 0.5])] {
            let (g, r) = (body.gradient(&x), body.radius(&x));
            let inverse_gamma = 1.0 / body.gamma(&x).max(1.0);
            let closed = &f * (1.0 + inverse_gamma) - &r * (2.0 * inverse_gamma * g.dot(&f) / g.dot(&r));
            assert!((modulate(&body, &x, &f).velocity - closed).amax() < 1e-13);
        }
    }

    #[test]
    fn inside_the_core_nothing_is_left_along_the_radius() {
        let circle = body(&OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]));
        let inside = modulate(&circle, &v(&[0.5, 0.0]), &v(&[-1.0, 0.5])).velocity;
        assert!((inside - v(&[0.0, 1.0])).amax() < 1e-15);
    }

    #[test]
    fn an_unusable_reference_point_leaves_the_surface_velocity() {
        let mut obstacle = OracleObstacle::still(&[0.0, 0.0], &[1.0, 1.0]);
        obstacle.velocity = vec![0.3, 0.4];
        let at_center = modulate(&body(&obstacle), &v(&[0.0, 0.0]), &v(&[1.0, 0.0]));
        assert!(!at_center.usable);
        assert_eq!(at_center.velocity.as_slice(), &[0.3, 0.4]);
        // Between the centre and the reference point the gradient looks towards that point.
        obstacle.reference = vec![0.5, 0.0];
        let between = modulate(&body(&obstacle), &v(&[0.2, 0.0]), &v(&[1.0, 0.0]));
        assert!(!between.usable && between.cosine < 0.0);
        assert!(modulate(&body(&obstacle), &v(&[0.7, 0.0]), &v(&[1.0, 0.0])).usable);
    }
}
