//! Star-shaped polygons, by the coordinates that a point has along the two corners of its sector.

use std::f64::consts::TAU;

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{angle_between, length, plane_cross, vector};
use super::shape::turned_right;

/// Share of an edge over which its normal passes into that of the neighbour.
const BLEND: f64 = 0.2;
/// By how much of the nearer line's distance from the origin the neighbour's line may come nearer along that share.
const FALL: f64 = 0.8;
/// The gauge of every edge up to which the whole is in sight.
pub(super) const SIGHT: f64 = 0.8;

/// A polygon, checked.
pub(super) struct Star {
    corners: Vec<DVector<f64>>,
    /// Slope of the gauge on every edge.
    slopes: Vec<DVector<f64>>,
}

/// What a polygon is at a point.
pub(super) struct StarPoint {
    /// lambda
    pub(super) gauge: f64,
    /// m
    pub(super) blended: DVector<f64>,
}

impl Star {
    pub(super) fn new(vertices: &[[f64; 2]]) -> Result<Self, OracleError> {
        if !(3..=12).contains(&vertices.len()) {
            return Err(OracleError::Value("number of corners"));
        }
        let corners = vertices.iter().map(|v| vector(v, 2, "corners")).collect::<Result<Vec<_>, _>>()?;
        let next = |i: usize| &corners[(i + 1) % corners.len()];
        if (0..corners.len()).any(|i| !(plane_cross(&corners[i], next(i)) > 0.0)) {
            return Err(OracleError::Value("corners"));
        }
        let around: f64 = (0..corners.len()).map(|i| angle_between(&corners[i], next(i))).sum();
        if (around - TAU).abs() > 1e-6 {
            return Err(OracleError::Value("corners"));
        }
        // The slope of an edge is across it, one over its distance from the origin long.
        let slopes = (0..corners.len())
            .map(|i| {
                let out = turned_right(&(next(i) - &corners[i]));
                let size = length(&out);
                let out = out / size;
                let off = out.dot(&(&corners[i] + next(i))) / 2.0;
                out / off
            })
            .collect();
        Ok(Self { corners, slopes })
    }

    pub(super) fn corners(&self) -> &[DVector<f64>] {
        &self.corners
    }

    pub(super) fn slopes(&self) -> &[DVector<f64>] {
        &self.slopes
    }

    /// The largest of what the lines of the edges make of a point; up to 0.8 all is in sight from there.
    pub(super) fn beyond(&self, y: &DVector<f64>) -> f64 {
        self.slopes.iter().map(|slope| slope.dot(y)).fold(0.0, f64::max)
    }

    /// Over which share of the i-th edge the normal of the j-th passes into its own.
    fn band(&self, i: usize, j: usize) -> f64 {
        let n = self.corners.len();
        let [own, other] = [i, j].map(|edge| 1.0 / length(&self.slopes[edge]));
        // Of both ends one is the corner between them, where the other line is; from the second it is this far behind.
        let second = if (j + 1) % n == i { &self.corners[(i + 1) % n] } else { &self.corners[i] };
        let behind = other * (1.0 - self.slopes[j].dot(second));
        if behind > 0.0 { BLEND.min(FALL * own.min(other) / behind) } else { BLEND }
    }

    pub(super) fn at(&self, y: &DVector<f64>) -> StarPoint {
        let n = self.corners.len();
        let mut best = (f64::NEG_INFINITY, 0, 0.0, 0.0);
        for i in 0..n {
            // y = first v_i + second v_(i+1); both are positive in one sector only.
            let (v, w) = (&self.corners[i], &self.corners[(i + 1) % n]);
            let area = plane_cross(v, w);
            let (first, second) = (plane_cross(y, w) / area, plane_cross(v, y) / area);
            if first.min(second) > best.0 {
                best = (first.min(second), i, first, second);
            }
        }
        let (_, i, first, second) = best;
        let gauge = first + second;
        if gauge <= 0.0 {
            return StarPoint { gauge: 0.0, blended: DVector::zeros(2) };
        }
        let t = second / gauge;
        let (last, next) = ((i + n - 1) % n, (i + 1) % n);
        let before = 0.5 * (1.0 - t / self.band(i, last)).max(0.0);
        let after = 0.5 * (1.0 - (1.0 - t) / self.band(i, next)).max(0.0);
        let normal = |edge: usize| &self.slopes[edge] / length(&self.slopes[edge]);
        let blended = normal(i) * (1.0 - before - after) + normal(last) * before + normal(next) * after;
        // As steep as a gauge is, whose slope along its ray is the gauge itself.
        let blended = &blended * (gauge / blended.dot(y));
        StarPoint { gauge, blended }
    }
}
