//! A_k from a convex programme.
//!
//! With P and the mixture given, the best A_k under A_k'P + PA_k <= -eps I - 2 sigma P are one convex programme, of a
//! size that does not depend on the number of samples: only the Gram matrix enters.
//!
//! Everything here is in normalised units; P has trace D.

use super::cone::{Affine, AffineMatrix, Programme};
use super::gmm::{Mixture, Samples, whitening};
use nalgebra::{DMatrix, SMatrix};

/// Largest ratio of P's eigenvalues: with more, f32 has no digits left for the certificate.
pub const MAX_CONDITION: f64 = 100.0;
/// Strictness of the inequality, in normalised units: far above what f32 rounds away.
pub const MARGIN: f64 = 1e-3;
/// Slow samples count more, for their direction: by this much over the squared speed, speeds bounded below by `SLOW`.
const SLOW_COUNTS: f64 = 0.1;
const SLOW: f64 = 0.2;

/// Least-squares statistics of the samples under a mixture.
pub struct Gram<const D: usize> {
    components: usize,
    /// Mean of phi phi', phi stacking gamma_k(x) x.
    g: DMatrix<f64>,
    /// Mean of phi v'.
    y: DMatrix<f64>,
    /// Mean of v'v.
    vv: f64,
}

/// Fitted matrices.
#[derive(Debug, Clone)]
pub struct Stable<const D: usize> {
    /// Of V = x'Px.
    pub p: SMatrix<f64, D, D>,
    /// One a component.
    pub a: Vec<SMatrix<f64, D, D>>,
    /// Mean squared velocity error.
    pub error: f64,
}

/// Features of one sample: gamma_k(x) x, stacked.
fn features<const D: usize>(mixture: &Mixture<D>, x: &nalgebra::SVector<f64, D>) -> nalgebra::DVector<f64> {
    let (gamma, _) = mixture.activations(x);
    nalgebra::DVector::from_fn(mixture.len() * D, |i, _| gamma[i / D] * x[i % D])
}

impl<const D: usize> Gram<D> {
    /// Statistics of all samples.
    pub fn new(samples: &Samples<D>, mixture: &Mixture<D>) -> Self {
        let size = mixture.len() * D;
        let (mut g, mut y, mut vv) = (DMatrix::zeros(size, size), DMatrix::zeros(size, D), 0.0);
        let n = 1.0 / samples.x.len().max(1) as f64;
        for (x, v) in samples.x.iter().zip(&samples.v) {
            let share = n * (1.0 + SLOW_COUNTS / (v.norm_squared() + SLOW * SLOW));
            let phi = features(mixture, x);
            g.ger(share, &phi, &phi, 1.0);
            for c in 0..D {
                y.column_mut(c).axpy(share * v[c], &phi, 1.0);
            }
            vv += share * v.norm_squared();
        }
        // A little ridge: a component that few samples reach must not grow without bound.
        let ridge = 1e-5 * g.trace() / size as f64;
        for i in 0..size {
            g[(i, i)] += ridge;
        }
        Self { components: mixture.len(), g, y, vv }
    }

    fn error(&self, a: &[SMatrix<f64, D, D>]) -> f64 {
        let theta = DMatrix::from_fn(self.components * D, D, |i, r| a[i / D][(r, i % D)]);
        (theta.dot(&(&self.g * &theta)) - 2.0 * theta.dot(&self.y) + self.vv).max(0.0)
    }

    /// The best A_k for this P, in the given bases; every LMI holds up to the solver's tolerance.
    fn solve(&self, p: &SMatrix<f64, D, D>, sigma: f64, bases: &[SMatrix<f64, D, D>]) -> Result<Stable<D>, String> {
        let index = |k: usize, r: usize, c: usize| (k * D + r) * D + c;
        let n = self.components * D * D;
        let (mut h, mut q) = (Vec::new(), vec![0.0; n]);
        for r in 0..D {
            for i in 0..self.components * D {
                let a = index(i / D, r, i % D);
                q[a] = -2.0 * self.y[(i, r)];
                for j in i..self.components * D {
                    h.push((a, index(j / D, r, j % D), 2.0 * self.g[(i, j)]));
                }
            }
        }
        let mut programme = Programme::new(n);
        for (k, basis) in bases.iter().enumerate() {
            let m: AffineMatrix<D> = std::array::from_fn(|r| {
                std::array::from_fn(|c| {
                    let mut sum = Affine::constant(-2.0 * sigma * p[(r, c)] - if r == c { MARGIN } else { 0.0 });
                    for s in 0..D {
                        sum.add(&Affine::variable(index(k, s, r)), -p[(s, c)]);
                        sum.add(&Affine::variable(index(k, s, c)), -p[(r, s)]);
                    }
                    sum
                })
            });
            programme.semidefinite(&m, basis);
        }
        let x = programme.solve(&h, &q)?;
        let a: Vec<_> = (0..self.components).map(|k| SMatrix::from_fn(|r, c| x[index(k, r, c)])).collect();
        let error = self.error(&a);
        Ok(Stable { p: *p, a, error })
    }

    /// The best A_k for this P: exact in the plane, by adapted bases in space.
    pub fn solve_for(&self, p: &SMatrix<f64, D, D>, sigma: f64, rounds: usize) -> Result<Stable<D>, String> {
        // With A_k near a multiple of the identity the inequality's matrix is near a multiple of P.
        let mut bases = vec![adapted_basis(p); self.components];
        let mut best = self.solve(p, sigma, &bases)?;
        if D == 2 {
            return Ok(best);
        }
        for _ in 1..rounds {
            for (basis, a) in bases.iter_mut().zip(&best.a) {
                *basis = adapted_basis(&decrease(p, a, sigma));
            }
            let Ok(next) = self.solve(p, sigma, &bases) else { break };
            let gain = best.error - next.error;
            if gain > 0.0 {
                best = next;
            }
            if gain < 1e-4 * best.error {
                break;
            }
        }
        Ok(best)
    }
}

/// -(A'P + PA) - 2 sigma P: positive definite where V decreases at the rate sigma.
fn decrease<const D: usize>(p: &SMatrix<f64, D, D>, a: &SMatrix<f64, D, D>, sigma: f64) -> SMatrix<f64, D, D> {
    -(a.transpose() * p + p * a) - p * (2.0 * sigma)
}

/// T with T'MT near the identity, for M positive semidefinite or nearly so. Directions that M hardly holds keep some room.
pub fn adapted_basis<const D: usize>(m: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    let scale = m.trace().abs().max(1e-9) / D as f64;
    [0.02, 0.2, 2.0]
        .iter()
        .find_map(|room| whitening(&(m + SMatrix::identity() * (room * scale))))
        .map_or_else(SMatrix::identity, |(w, _)| w.transpose())
}

/// Lowers the A_k that miss their inequality, so that it holds with half the margin whatever the solver left open.
pub fn repair<const D: usize>(fit: &mut Stable<D>, sigma: f64) -> Option<()> {
    for a in &mut fit.a {
        // Subtracting c I from A lowers A'P + PA by 2c P, as much in every direction as sigma asks for there: c P^-1 would move it most where P is small.
        let mut step = 0.25 * MARGIN;
        while whitening(&(decrease(&fit.p, a, sigma) - SMatrix::identity() * (0.5 * MARGIN))).is_none() {
            *a -= SMatrix::identity() * step;
            step *= 2.0;
            if !step.is_finite() {
                return None;
            }
        }
    }
    Some(())
}

/// Condition number by power iteration on P and its inverse; D is small, so a few dozen rounds are exact enough.
pub fn condition<const D: usize>(p: &SMatrix<f64, D, D>) -> f64 {
    let Some((w, _)) = whitening(p) else { return f64::INFINITY };
    let largest = |m: &SMatrix<f64, D, D>| {
        let mut power = *m / m.norm();
        for _ in 0..8 {
            power = power * power;
            power /= power.norm();
        }
        (m * power).norm() / power.norm()
    };
    largest(p) * largest(&(w.transpose() * w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    /// However lopsided P is, a rate that is asked for in addition moves an A on the edge by little more than that rate.
    #[test]
    fn a_little_more_room_moves_a_motion_a_little() {
        for turn in 0..20 {
            let angle = f64::from(turn) * 0.3;
            let axes = Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
            let p = axes * Matrix2::from_diagonal(&Vector2::new(1.0, 1.0 / 58.0)) * axes.transpose();
            let w = Matrix2::new(0.3, 1.0, -1.0, 0.3 + 0.1 * f64::from(turn));
            // P A + A'P = -w'w, as near to it as one A comes: P^-1 (-w'w/2).
            let inverse = p.try_inverse().expect("definite");
            let edge = -inverse * (w.transpose() * w) * 0.5;
            let mut fit = Stable { p, a: vec![edge], error: 0.0 };
            repair(&mut fit, 0.0).expect("room");
            let before = fit.a[0];
            repair(&mut fit, decrease_rate(&p, &before) + 0.02).expect("room");
            let moved = (fit.a[0] - before).norm();
            assert!(moved > 0.0 && moved < 0.1, "{turn}: {moved}");
        }
    }

    /// The largest rate that A has, by halving.
    fn decrease_rate(p: &Matrix2<f64>, a: &Matrix2<f64>) -> f64 {
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if whitening(&decrease(p, a, middle)).is_some() {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}
