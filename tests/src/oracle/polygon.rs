//! Star-shaped polygons, by the coordinates that a point has along the two corners of its sector.

use std::f64::consts::TAU;

use nalgebra::DVector;

use super::error::OracleError;
use super::geometry::{angle_between, length, plane_cross, vector};
use super::shape::turned_right;

/// Share of an edge over which its slope passes into that of the neighbour.
const BLEND: f64 = 0.2;

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
        let before = 0.5 * (1.0 - t / BLEND).max(0.0);
        let after = 0.5 * (1.0 - (1.0 - t) / BLEND).max(0.0);
        let blended = &self.slopes[i] * (1.0 - before - after)
            + &self.slopes[(i + n - 1) % n] * before
            + &self.slopes[(i + 1) % n] * after;
        StarPoint { gauge, blended }
    }
}
