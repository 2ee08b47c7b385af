//! Modulation by one obstacle, section 3, as an explicit E D E^-1.

use nalgebra::{DMatrix, DVector};

use super::geometry::{length, tangents, unit};
use super::obstacle::Body;
use super::scan::CloudView;

/// An obstacle whose reference point is seen from further off than this is unusable: the product of gradient and radius
/// over that of their sums of absolute values.
const USABLE: f64 = 1e-6;
/// An obstacle this far away does not change a digit.
pub(super) const FAR: f64 = 1e15;

/// What one obstacle makes of the flow.
pub(super) struct Modulated {
    pub(super) velocity: DVector<f64>,
    /// How well the reference point is seen, compared with [`USABLE`]; 0 at the centre.
    pub(super) sight: f64,
    pub(super) usable: bool,
}

impl Modulated {
    /// Distance of the sight from the threshold of use.
    pub(super) fn to_threshold(&self) -> f64 {
        (self.sight - USABLE).abs()
    }
}

/// xdot_n = s + M (f - s).
pub(super) fn modulate(body: &Body, x: &DVector<f64>, f: &DVector<f64>) -> Modulated {
    let surface = body.surface_velocity(x);
    // The reference point of a wall is on the free side of it: r goes against n. Which way round r is taken makes no
    // difference to the flow, only to whether the point counts as seen.
    let radius = if body.wall { -body.radius(x) } else { body.radius(x) };
    along(&body.normal(x), &radius, body.gamma(x), &surface, f)
}

/// The same for a scan, which is at rest and seen along its normal.
pub(super) fn modulate_cloud(cloud: &CloudView, f: &DVector<f64>) -> Modulated {
    along(&cloud.normal, &cloud.normal, cloud.gamma, &DVector::zeros(f.len()), f)
}

fn along(
    normal: &DVector<f64>,
    radius: &DVector<f64>,
    gamma: f64,
    surface: &DVector<f64>,
    f: &DVector<f64>,
) -> Modulated {
    let unusable = |sight| Modulated { velocity: surface.clone(), sight, usable: false };
    let (Some(normal), Some(radial)) = (unit(normal), unit(radius)) else {
        return unusable(0.0);
    };
    let sum = |v: &DVector<f64>| v.iter().map(|c| c.abs()).sum::<f64>();
    let sight = normal.dot(&radial) / (sum(&normal) * sum(&radial));
    if sight <= USABLE {
        return unusable(sight);
    }
    match modulation_matrix(&radial, &normal, gamma) {
        Some(m) => Modulated { velocity: surface + m * (f - surface), sight, usable: true },
        None => unusable(sight),
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
            margin: vec![1.0, 1.2, 1.1],
            reference: vec![0.1, -0.1, 0.05],
            ..OracleObstacle::still(&[0.2, -0.1, 0.4], &[0.6, 0.4, 0.5]).curved(2)
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
            let x = body.world(&(&q * body.reach(&q, 1.0, false)));
            assert!((body.gamma(&x) - 1.0).abs() < 1e-13);
            let relative = modulate(&body, &x, &v(&[1.0, 2.0, -1.5])).velocity - body.surface_velocity(&x);
            assert!(body.normal(&x).dot(&relative).abs() < 1e-12);
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
        assert!(!between.usable && between.sight < 0.0);
        assert!(modulate(&body(&obstacle), &v(&[0.7, 0.0]), &v(&[1.0, 0.0])).usable);
    }

    #[test]
    fn nothing_flows_through_a_wall() {
        let mut wall = tilted().inside_out();
        wall.growth = 0.07;
        let body = body(&wall);
        for direction in [[1.0, 0.3, -0.2], [-0.4, 1.0, 0.9], [0.1, -0.2, 1.0]] {
            let q = unit(&v(&direction)).unwrap();
            let x = body.world(&(&q * body.reach(&q, 1.0, false)));
            let seen = modulate(&body, &x, &v(&[1.0, 2.0, -1.5]));
            assert!(seen.usable);
            assert!(body.normal(&x).dot(&(seen.velocity - body.surface_velocity(&x))).abs() < 1e-12);
            assert!(body.normal(&x).dot(&(&body.center - &x)) > 0.0);
        }
    }

    #[test]
    fn a_scan_is_seen_along_its_normal() {
        // Gamma = 4: 3/4 of the flow along n = (0.6, 0.8), 5/4 across.
        let cloud = CloudView { least: 3.0, gamma: 4.0, normal: v(&[0.6, 0.8]), to_surface: 2.0 };
        assert!((modulate_cloud(&cloud, &v(&[-0.6, -0.8])).velocity - v(&[-0.45, -0.6])).amax() < 1e-15);
        assert!((modulate_cloud(&cloud, &v(&[-0.8, 0.6])).velocity - v(&[-1.0, 0.75])).amax() < 1e-15);
    }

    #[test]
    fn the_threshold_is_on_sums_of_absolute_values() {
        // n = (0, 1), r = (1, 3e-6) keeps 3e-6 of both, r = (1, 1, 0.9e-6) does not.
        let flat = |r: &[f64], n: &[f64]| along(&v(n), &v(r), 2.0, &v(&vec![0.0; r.len()]), &v(&vec![1.0; r.len()]));
        assert!(flat(&[1.0, 1.1e-6], &[0.0, 1.0]).usable);
        assert!(!flat(&[1.0, 0.9e-6], &[0.0, 1.0]).usable);
        assert!(flat(&[1.0, 1.0, 2.1e-6], &[0.0, 0.0, 1.0]).usable);
        assert!(!flat(&[1.0, 1.0, 1.9e-6], &[0.0, 0.0, 1.0]).usable);
    }
}
