//! Numbers and vectors.

use nalgebra::{DMatrix, DVector};
use rand::Rng;

use super::super::geometry::unit;

/// The nearest number that `f32` holds.
pub(super) fn rounded(value: f64) -> f64 {
    f64::from(value as f32)
}

pub(super) fn uniform(rng: &mut impl Rng, from: f64, to: f64) -> f64 {
    rounded(rng.random_range(from..to))
}

pub(super) fn power_of_ten(rng: &mut impl Rng, from: f64, to: f64) -> f64 {
    10.0_f64.powf(rng.random_range(from..to))
}

pub(super) fn chance(rng: &mut impl Rng, probability: f64) -> bool {
    rng.random_range(0.0..1.0) < probability
}

pub(super) fn uniform_vector(rng: &mut impl Rng, dimension: usize, reach: f64) -> Vec<f64> {
    (0..dimension).map(|_| uniform(rng, -reach, reach)).collect()
}

pub(super) fn rounded_vector(v: &DVector<f64>) -> Vec<f64> {
    v.iter().map(|c| rounded(*c)).collect()
}

/// A direction, every one as likely.
pub(super) fn direction(rng: &mut impl Rng, dimension: usize) -> DVector<f64> {
    loop {
        let inside = DVector::from_fn(dimension, |_, _| rng.random_range(-1.0..1.0));
        let size = inside.norm();
        if (0.1..1.0).contains(&size)
            && let Some(direction) = unit(&inside)
        {
            return direction;
        }
    }
}

/// A symmetric matrix with eigenvalues of at least `least`.
pub(super) fn positive_definite(rng: &mut impl Rng, dimension: usize, least: f64, spread: f64) -> DMatrix<f64> {
    let half = DMatrix::from_fn(dimension, dimension, |_, _| rng.random_range(-spread..spread));
    &half * half.transpose() + DMatrix::identity(dimension, dimension) * least
}

/// Rows of numbers that `f32` holds.
pub(super) fn rounded_rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    m.row_iter().map(|row| row.iter().map(|c| rounded(*c)).collect()).collect()
}
