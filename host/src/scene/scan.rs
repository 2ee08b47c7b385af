//! Range points that are in the way as they are.

use nalgebra::Vector3;
use pliant_core::{Scalar, Scan, ScanError};

use super::convert::vector;

/// Range points, all seen at once, that do not move.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneScan {
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) radius: f64,
}

impl SceneScan {
    /// What a run calls it where it names the nearest obstacle.
    pub const NAME: &'static str = "scan";

    /// The points, m.
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }
    /// What each point is kept away from by, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The least Gamma of all points at `x`: at most 1 within the radius of one.
    pub fn gamma(&self, x: &Vector3<f64>) -> f64 {
        let nearest = self.points.iter().map(|p| (x - p).norm_squared()).fold(f64::INFINITY, f64::min);
        nearest / (self.radius * self.radius)
    }

    pub(super) fn to_core<S: Scalar, const D: usize>(&self) -> Result<Scan<S, D>, ScanError> {
        let points: Vec<_> = self.points.iter().map(vector).collect();
        Scan::new(&points, S::from_f64(self.radius))
    }
}
