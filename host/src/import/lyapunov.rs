//! Is there one P for given A_k?
//!
//! The set of P with P > 0 and A_k'P + PA_k < 0 for every k is convex. It is searched by the ellipsoid method (Boyd & Vandenberghe,
//! *Localization and Cutting-Plane Methods*, Stanford EE364b notes): in an ellipsoid that holds every minimiser of
//! g(P) = max_k lambda_max(A_k'P + PA_k)/|A_k|, a half that cannot is cut off, until the minimum is known. Where it is negative,
//! P is the one with the largest margin against rounding; where it is not, there is none.

use nalgebra::{DMatrix, DVector};

/// P with trace D has no eigenvalue below this: with less, f32 has no digits left for the certificate.
const LEAST_EIGENVALUE: f64 = 1e-4;
const ROUNDS: usize = 4000;
const TOLERANCE: f64 = 1e-7;

/// No P was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoneFound {
    /// The least g that is possible, or near it: not negative.
    pub margin: f64,
    /// The component that is not stable by itself, if it is that.
    pub unstable: Option<usize>,
    /// The two or more components that limit g at its least; any one of them.
    pub tight: usize,
}

/// P of trace D with A_k'P + PA_k < 0 for every k, the one that leaves most room for rounding.
pub fn search(a: &[DMatrix<f64>]) -> Result<DMatrix<f64>, NoneFound> {
    let d = a.first().map_or(2, DMatrix::nrows);
    if let Some(k) = a.iter().position(|a| a.complex_eigenvalues().iter().any(|l| l.re >= 0.0)) {
        return Err(NoneFound { margin: f64::INFINITY, unstable: Some(k), tight: k });
    }
    let scaled: Vec<_> = a.iter().map(|a| a / a.norm()).collect();
    let basis = traceless(d);
    let n = basis.len();
    let p_at = |y: &DVector<f64>| {
        basis.iter().zip(y.iter()).fold(DMatrix::identity(d, d), |p: DMatrix<f64>, (e, y)| p + e * *y)
    };
    let mut centre = DVector::zeros(n);
    // All P > 0 of trace D are within sqrt(D^2 - D) of the identity.
    let mut shape = DMatrix::<f64>::identity(n, n) * (d * d) as f64;
    let mut best = (f64::INFINITY, DMatrix::identity(d, d), 0);
    for _ in 0..ROUNDS {
        let p = p_at(&centre);
        // How far the value is above what is wanted, and how it changes.
        let (excess, slope) = match least(&p) {
            (value, u) if value < LEAST_EIGENVALUE => {
                (LEAST_EIGENVALUE - value, DVector::from_fn(n, |i, _| -u.dot(&(&basis[i] * &u))))
            }
            _ => {
                let (value, k, u) = largest(&scaled, &p);
                if value < best.0 {
                    best = (value, p, k);
                }
                let moved = &scaled[k] * &u;
                (value - best.0, DVector::from_fn(n, |i, _| 2.0 * u.dot(&(&basis[i] * &moved))))
            }
        };
        let along = &shape * &slope;
        let reach = slope.dot(&along).max(0.0).sqrt();
        if reach <= TOLERANCE {
            break;
        }
        // A deep cut: what lies above the best value known cannot be the minimiser.
        let depth = excess / reach;
        if depth >= 1.0 {
            break;
        }
        let m = n as f64;
        let step = &along / reach;
        centre -= &step * ((1.0 + m * depth) / (m + 1.0));
        let narrower = 2.0 * (1.0 + m * depth) / ((m + 1.0) * (1.0 + depth));
        shape = (shape - &step * step.transpose() * narrower) * (m * m * (1.0 - depth * depth) / (m * m - 1.0));
        shape = (&shape + shape.transpose()) * 0.5;
    }
    let (margin, p, tight) = best;
    if margin < 0.0 { Ok(p) } else { Err(NoneFound { margin, unstable: None, tight }) }
}

/// How far A_k'P + PA_k is below zero, as a part of |A_k|, for the k where it is least, and that k.
pub fn margin(a: &[DMatrix<f64>], p: &DMatrix<f64>) -> (f64, usize) {
    let scaled: Vec<_> = a.iter().map(|a| a / a.norm()).collect();
    let (value, k, _) = largest(&scaled, p);
    (-value, k)
}

/// An orthonormal basis of symmetric matrices without trace.
fn traceless(d: usize) -> Vec<DMatrix<f64>> {
    let mut basis = Vec::new();
    for r in 0..d {
        for c in r + 1..d {
            let mut e = DMatrix::zeros(d, d);
            (e[(r, c)], e[(c, r)]) = (0.5_f64.sqrt(), 0.5_f64.sqrt());
            basis.push(e);
        }
    }
    for k in 1..d {
        let scale = ((k * (k + 1)) as f64).sqrt();
        basis.push(DMatrix::from_fn(d, d, |r, c| match (r == c, r) {
            (true, r) if r < k => 1.0 / scale,
            (true, r) if r == k => -(k as f64) / scale,
            _ => 0.0,
        }));
    }
    basis
}

fn least(p: &DMatrix<f64>) -> (f64, DVector<f64>) {
    let eigen = p.clone().symmetric_eigen();
    let i = eigen.eigenvalues.imin();
    (eigen.eigenvalues[i], eigen.eigenvectors.column(i).into_owned())
}

/// The largest eigenvalue of all A_k'P + PA_k, its k and its eigenvector.
fn largest(a: &[DMatrix<f64>], p: &DMatrix<f64>) -> (f64, usize, DVector<f64>) {
    let mut most = (f64::NEG_INFINITY, 0, DVector::zeros(p.nrows()));
    for (k, a) in a.iter().enumerate() {
        let eigen = (a.transpose() * p + p * a).symmetric_eigen();
        let i = eigen.eigenvalues.imax();
        if eigen.eigenvalues[i] > most.0 {
            most = (eigen.eigenvalues[i], k, eigen.eigenvectors.column(i).into_owned());
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decreases(a: &DMatrix<f64>, p: &DMatrix<f64>) -> bool {
        (a.transpose() * p + p * a).symmetric_eigenvalues().max() < 0.0
    }

    #[test]
    fn one_stable_matrix_always_has_a_p() {
        // Far from normal: with P = I it does not decrease.
        let a = DMatrix::from_row_slice(3, 3, &[-1.0, 40.0, 0.0, 0.0, -1.0, 5.0, 0.0, 0.0, -0.5]);
        assert!(!decreases(&a, &DMatrix::identity(3, 3)));
        let p = search(std::slice::from_ref(&a)).expect("stable");
        assert!(decreases(&a, &p) && p.symmetric_eigenvalues().min() > 0.0, "{p}");
        assert!((p.trace() - 3.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_unstable_is_named() {
        let good = DMatrix::from_row_slice(2, 2, &[-1.0, 0.0, 0.0, -1.0]);
        let bad = DMatrix::from_row_slice(2, 2, &[-1.0, 3.0, 3.0, -1.0]);
        assert_eq!(search(&[good, bad]).expect_err("none").unstable, Some(1));
        // Each is stable, but switching between them runs away: no P serves both.
        let tall = DMatrix::from_row_slice(2, 2, &[-0.1, 10.0, -0.1, -0.1]);
        let found = search(&[tall.clone(), tall.transpose()]).expect_err("none");
        assert!(found.unstable.is_none() && found.margin > 0.0, "{found:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        /// Whatever was made with a P has one.
        #[test]
        fn finds_one_where_there_is_one(
            d in 2usize..4, k in 1usize..9, seed in proptest::collection::vec(-1.0..1.0f64, 9 * 18), stretch in 1.0..30.0f64,
        ) {
            let block = |i: usize| DMatrix::from_fn(d, d, |r, c| seed[9 * i + 3 * r + c]);
            // P = T'T; B_k = T A_k T^-1 has a negative definite symmetric part, so A_k'P + PA_k < 0.
            let mut t = block(16) * 0.3 + DMatrix::identity(d, d);
            t.row_mut(0).scale_mut(stretch.sqrt());
            let Some(inverse) = t.clone().try_inverse() else { return Ok(()) };
            prop_assume!(t.norm() * inverse.norm() < 100.0);
            let a: Vec<_> = (0..k)
                .map(|i| {
                    let m = block(i);
                    let b = (&m - m.transpose()) * 3.0 - m.transpose() * &m - DMatrix::identity(d, d) * 0.1;
                    &inverse * b * &t
                })
                .collect();
            let p = search(&a);
            let p = p.map_err(|e| TestCaseError::fail(format!("{e:?}")))?;
            for a in &a {
                prop_assert!(decreases(a, &p));
            }
        }
    }
}
