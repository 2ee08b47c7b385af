//! Nominal motions: linear, and LPV systems that are stable by construction.

use nalgebra::DMatrix;
use rand::Rng;

use super::super::scene::{OracleComponent, OracleMotion};
use super::Recipe;
use super::random::{chance, positive_definite, rounded, rounded_rows, uniform, uniform_vector};

pub(super) fn motion(rng: &mut impl Rng, recipe: &Recipe) -> OracleMotion {
    let d = recipe.dimension;
    let attractor = uniform_vector(rng, d, 1.0);
    if !chance(rng, recipe.lpv) {
        return OracleMotion::Linear { attractor, gain: uniform(rng, 0.2, 2.0) };
    }
    let p = positive_definite(rng, d, 0.4, 0.8);
    let inverse = p.clone().try_inverse().unwrap_or_else(|| DMatrix::identity(d, d));
    let count = rng.random_range(1..=6);
    let components = (0..count)
        .map(|_| {
            // A = P^-1 (S - R) with S skew: A'P + PA = -2R, which is negative definite.
            let half = DMatrix::from_fn(d, d, |_, _| rng.random_range(-1.0..1.0));
            let skew = &half - half.transpose();
            let a = &inverse * (skew - positive_definite(rng, d, 0.3, 0.5));
            OracleComponent {
                prior: rounded(1.0 / f64::from(count)) * uniform(rng, 0.5, 1.5),
                mean: uniform_vector(rng, d, 1.5),
                covariance: rounded_rows(&positive_definite(rng, d, 0.02, 0.4)),
                a: rounded_rows(&a),
            }
        })
        .map(|component| OracleComponent { prior: rounded(component.prior), ..component })
        .collect();
    OracleMotion::Lpv { attractor, lyapunov: rounded_rows(&p), components }
}
