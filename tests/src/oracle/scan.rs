//! Raw points as one obstacle, section 2.

use nalgebra::DVector;

use super::combination::weights;
use super::error::OracleError;
use super::geometry::{length, unit, vector};
use super::scene::OracleScan;

/// A scan, checked.
pub(super) struct Cloud {
    pub(super) points: Vec<DVector<f64>>,
    pub(super) radius: f64,
}

/// A scan as seen from a position.
pub(super) struct CloudView {
    /// The least Gamma of a point.
    pub(super) least: f64,
    /// Gamma of the whole.
    pub(super) gamma: f64,
    /// n = r; zero where the points cancel.
    pub(super) normal: DVector<f64>,
    /// Least |Gamma_i - 1|.
    pub(super) to_surface: f64,
}

impl Cloud {
    /// The scan; none where it has no point.
    pub(super) fn new(scan: &OracleScan, dimension: usize) -> Result<Option<Self>, OracleError> {
        if !(scan.radius.is_finite() && scan.radius > 0.0) {
            return Err(OracleError::Value("radius of the scan"));
        }
        let points =
            scan.points.iter().map(|p| vector(p, dimension, "point of the scan")).collect::<Result<Vec<_>, _>>()?;
        Ok((!points.is_empty()).then_some(Self { points, radius: scan.radius }))
    }

    /// Gamma_i, in the order of the points.
    pub(super) fn gammas(&self, x: &DVector<f64>) -> Vec<f64> {
        self.points.iter().map(|p| (length(&(x - p)) / self.radius).powi(2)).collect()
    }

    pub(super) fn least(&self, x: &DVector<f64>) -> f64 {
        self.gammas(x).into_iter().fold(f64::INFINITY, f64::min)
    }

    pub(super) fn at(&self, x: &DVector<f64>) -> CloudView {
        let gammas = self.gammas(x);
        let mean = self.points.iter().zip(weights(&gammas)).fold(DVector::zeros(x.len()), |sum, (p, w)| {
            let out = unit(&(x - p)).unwrap_or_else(|| DVector::zeros(x.len()));
            sum + out * w
        });
        let least = gammas.iter().copied().fold(f64::INFINITY, f64::min);
        CloudView {
            least,
            gamma: if least <= 1.0 { least } else { least / length(&mean) },
            normal: unit(&mean).unwrap_or(mean),
            to_surface: gammas.iter().map(|gamma| (gamma - 1.0).abs()).fold(f64::INFINITY, f64::min),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(points: &[[f64; 2]], radius: f64) -> Cloud {
        let points = points.iter().map(|p| p.to_vec()).collect();
        Cloud::new(&OracleScan { points, radius }, 2).unwrap().unwrap()
    }

    fn v(values: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(values)
    }

    #[test]
    fn one_point_is_a_circle() {
        let seen = cloud(&[[1.0, 0.0]], 0.5).at(&v(&[1.0, 2.0]));
        assert_eq!((seen.gamma, seen.least, seen.to_surface), (16.0, 16.0, 15.0));
        assert_eq!(seen.normal.as_slice(), &[0.0, 1.0]);
    }

    #[test]
    fn two_points_at_a_right_angle() {
        // Gamma 4 and 16: weights 15/18 and 3/18 along (0, 1) and (1, 0).
        let seen = cloud(&[[0.0, -1.0], [-2.0, 0.0]], 0.5).at(&v(&[0.0, 0.0]));
        let (up, right) = (15.0 / 18.0, 3.0 / 18.0);
        let size = f64::hypot(up, right);
        assert!((&seen.normal - v(&[right, up]) / size).amax() < 1e-15);
        assert!((seen.gamma - 4.0 / size).abs() < 1e-14 && seen.least == 4.0);
    }

    #[test]
    fn between_two_points_nothing_is_in_the_way_across() {
        let seen = cloud(&[[0.0, -1.0], [0.0, 1.0]], 0.5).at(&v(&[0.0, 0.0]));
        assert!(seen.gamma.is_infinite() && seen.least == 4.0 && seen.normal.amax() == 0.0);
    }

    #[test]
    fn inside_a_point_only_those_inside_count() {
        let seen = cloud(&[[0.0, -0.4], [2.0, 0.0]], 0.5).at(&v(&[0.0, 0.0]));
        assert!((seen.gamma - 0.64).abs() < 1e-15 && seen.gamma == seen.least);
        assert_eq!(seen.normal.as_slice(), &[0.0, 1.0]);
    }

    #[test]
    fn no_points_are_no_obstacle() {
        let none = OracleScan { points: vec![], radius: 0.1 };
        assert!(Cloud::new(&none, 2).unwrap().is_none());
        assert!(Cloud::new(&OracleScan { radius: 0.0, ..none }, 2).is_err());
    }
}
