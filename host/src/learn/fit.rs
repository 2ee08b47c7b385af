//! P and A_k from convex programmes.
//!
//! With P and the mixture given, the best A_k under A_k'P + PA_k <= -eps I - 2 sigma P are one convex programme, of a
//! size that does not depend on the number of samples: only the Gram matrix enters. P has two shape parameters in the
//! plane (searched over directly) and five in space (started from a convex relaxation, then searched).
//!
//! Everything here is in normalised units; P has trace D.

use super::cone::{Affine, AffineMatrix, Programme};
use super::gmm::{Mixture, Samples, whitening};
use nalgebra::{DMatrix, SMatrix};

/// Largest ratio of P's eigenvalues: with more, f32 has no digits left for the certificate.
pub const MAX_CONDITION: f64 = 100.0;
/// Strictness of the inequality, in normalised units: far above what f32 rounds away.
pub const MARGIN: f64 = 4e-3;
/// Rounds of adapting the basis of the 3x3 inequalities.
const BASIS_ROUNDS: usize = 4;

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
    pub fn new(samples: &Samples<D>, mixture: &Mixture<D>, weight: impl Fn(&nalgebra::SVector<f64, D>) -> f64) -> Self {
        let size = mixture.len() * D;
        let (mut g, mut y, mut vv) = (DMatrix::zeros(size, size), DMatrix::zeros(size, D), 0.0);
        let n = 1.0 / samples.x.len().max(1) as f64;
        for (x, v) in samples.x.iter().zip(&samples.v) {
            let share = n * weight(v);
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
    let (w, _) = whitening(&fit.p)?;
    let inverse = w.transpose() * w;
    for a in &mut fit.a {
        // Subtracting c P^-1 from A lowers A'P + PA by 2c I.
        let mut step = 0.25 * MARGIN;
        while whitening(&(decrease(&fit.p, a, sigma) - SMatrix::identity() * (0.5 * MARGIN))).is_none() {
            *a -= inverse * step;
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

/// Fits P and all A_k.
pub fn fit<const D: usize>(samples: &Samples<D>, mixture: &Mixture<D>, sigma: f64) -> Result<Stable<D>, String> {
    let gram = Gram::new(samples, mixture, |_| 1.0);
    let mut best = if D == 2 { plane(&gram, sigma)? } else { space(&gram, samples, mixture, sigma)? };
    repair(&mut best, sigma).ok_or("the inequality cannot be met")?;
    best.error = gram.error(&best.a);
    Ok(best)
}

/// Grid and pattern search over angle and eigenvalue ratio of P.
fn plane<const D: usize>(gram: &Gram<D>, sigma: f64) -> Result<Stable<D>, String> {
    use std::f64::consts::PI;
    let shape = |angle: f64, log_ratio: f64| {
        let ratio = log_ratio.exp();
        let (s, c) = angle.sin_cos();
        let (a, b) = (2.0 * ratio / (1.0 + ratio), 2.0 / (1.0 + ratio));
        let entries = [[a * c * c + b * s * s, (a - b) * s * c], [(a - b) * s * c, a * s * s + b * c * c]];
        SMatrix::<f64, D, D>::from_fn(|r, c| entries[r][c])
    };
    let limit = MAX_CONDITION.ln();
    let mut best = (gram.solve_for(&shape(0.0, 0.0), sigma, 1)?, 0.0, 0.0);
    let try_at = |best: &mut (Stable<D>, f64, f64), angle: f64, log_ratio: f64| {
        let log_ratio = log_ratio.clamp(0.0, limit);
        match gram.solve_for(&shape(angle, log_ratio), sigma, 1) {
            Ok(fit) if fit.error < best.0.error => {
                *best = (fit, angle, log_ratio);
                true
            }
            _ => false,
        }
    };
    for i in 0..12 {
        for j in 1..=5 {
            try_at(&mut best, f64::from(i) * PI / 12.0, f64::from(j) * limit / 6.0);
        }
    }
    let (mut turn, mut stretch) = (PI / 24.0, limit / 12.0);
    while turn > 2e-3 {
        let (_, angle, ratio) = best;
        let better = [(turn, 0.0), (-turn, 0.0), (0.0, stretch), (0.0, -stretch)]
            .iter()
            .any(|(da, dr)| try_at(&mut best, angle + da, ratio + dr));
        if !better {
            turn *= 0.5;
            stretch *= 0.5;
        }
    }
    Ok(best.0)
}

/// Relaxation, then a pattern search over the shape of P.
fn space<const D: usize>(
    gram: &Gram<D>,
    samples: &Samples<D>,
    mixture: &Mixture<D>,
    sigma: f64,
) -> Result<Stable<D>, String> {
    let mut best = gram.solve_for(&SMatrix::identity(), sigma, BASIS_ROUNDS)?;
    if let Ok(p) = relaxation(samples, mixture, sigma)
        && let Ok(fit) = gram.solve_for(&p, sigma, BASIS_ROUNDS)
        && fit.error < best.error
    {
        best = fit;
    }
    let mut step = 0.5;
    while step > 0.05 {
        let mut better = false;
        for r in 0..D {
            for c in r..D {
                for sign in [1.0, -1.0] {
                    // A symmetric step in the metric of P itself: P' = L (I + h E)^2 L'.
                    let Some((w, _)) = whitening(&best.p) else { continue };
                    let Some(l) = w.try_inverse() else { continue };
                    let mut e = SMatrix::<f64, D, D>::identity();
                    e[(r, c)] += sign * step;
                    if r != c {
                        e[(c, r)] += sign * step;
                    }
                    let p = l * e * e * l.transpose();
                    let p = (p + p.transpose()) * (0.5 * D as f64 / p.trace());
                    if condition(&p) > MAX_CONDITION {
                        continue;
                    }
                    if let Ok(fit) = gram.solve_for(&p, sigma, 2)
                        && fit.error < best.error * (1.0 - 1e-3)
                    {
                        best = fit;
                        better = true;
                    }
                }
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    gram.solve_for(&best.p, sigma, 2 * BASIS_ROUNDS)
}

/// P from the convex relaxation Q_k = P A_k: minimise |P v - sum gamma_k Q_k x|^2 under Q_k + Q_k' <= -2 sigma P and
/// bounds on P. Its error is weighted by P, so only P is used and the A_k are fitted anew.
fn relaxation<const D: usize>(
    samples: &Samples<D>,
    mixture: &Mixture<D>,
    sigma: f64,
) -> Result<SMatrix<f64, D, D>, String> {
    let shapes = D * (D + 1) / 2;
    let of_p = |r: usize, c: usize| {
        let (r, c) = (r.min(c), r.max(c));
        c * (c + 1) / 2 + r
    };
    let of_q = |k: usize, r: usize, c: usize| shapes + (k * D + r) * D + c;
    let n = shapes + mixture.len() * D * D;
    let mut hessian = DMatrix::<f64>::zeros(n, n);
    let share = 2.0 / samples.x.len().max(1) as f64;
    for (x, v) in samples.x.iter().zip(&samples.v) {
        let phi = features(mixture, x);
        for r in 0..D {
            let mut row = nalgebra::DVector::zeros(n);
            for c in 0..D {
                row[of_p(r, c)] += v[c];
                for k in 0..mixture.len() {
                    row[of_q(k, r, c)] = -phi[k * D + c];
                }
            }
            hessian.ger(share, &row, &row, 1.0);
        }
    }
    let mut h = Vec::new();
    for i in 0..n {
        hessian[(i, i)] += 1e-7;
        h.extend((i..n).map(|j| (i, j, hessian[(i, j)])));
    }
    // tr P = D and P >= smallest I bound the condition number.
    let smallest = D as f64 / (MAX_CONDITION + D as f64 - 1.0);

    let mut p = SMatrix::<f64, D, D>::identity();
    let mut bases = vec![SMatrix::<f64, D, D>::identity(); mixture.len() + 1];
    for _ in 0..BASIS_ROUNDS {
        let mut programme = Programme::new(n);
        let mut trace = Affine::constant(-(D as f64));
        for i in 0..D {
            trace.add(&Affine::variable(of_p(i, i)), 1.0);
        }
        programme.zero(trace);
        let m: AffineMatrix<D> = std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                let mut sum = Affine::constant(if r == c { -smallest } else { 0.0 });
                sum.add(&Affine::variable(of_p(r, c)), 1.0);
                sum
            })
        });
        programme.semidefinite(&m, &bases[0]);
        for (k, basis) in bases[1..].iter().enumerate() {
            let m: AffineMatrix<D> = std::array::from_fn(|r| {
                std::array::from_fn(|c| {
                    let mut sum = Affine::constant(if r == c { -MARGIN } else { 0.0 });
                    sum.add(&Affine::variable(of_q(k, r, c)), -1.0);
                    sum.add(&Affine::variable(of_q(k, c, r)), -1.0);
                    sum.add(&Affine::variable(of_p(r, c)), -2.0 * sigma);
                    sum
                })
            });
            programme.semidefinite(&m, basis);
        }
        let x = programme.solve(&h, &vec![0.0; n])?;
        p = SMatrix::from_fn(|r, c| x[of_p(r, c)]);
        bases[0] = adapted_basis(&(p - SMatrix::identity() * smallest));
        for (k, basis) in bases[1..].iter_mut().enumerate() {
            let q = SMatrix::<f64, D, D>::from_fn(|r, c| x[of_q(k, r, c)]);
            *basis = adapted_basis(&(-(q + q.transpose()) - p * (2.0 * sigma)));
        }
    }
    Ok(p)
}
