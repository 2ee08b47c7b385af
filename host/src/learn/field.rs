//! The motion in the parameters that learning moves, with its derivatives.
//!
//! ```text
//! f(x) = sum_k gamma_k(x) A_k x,   gamma_k = softmax_k( w_k - 1/2 |W_k (x - mu_k)|^2 )
//! A_k = P^-1 (S_k - L_k L_k' - 1/2 eps I) - sigma P^-1 P
//! ```
//!
//! with S_k skew, L_k and W_k lower triangular and P = R R': whatever the numbers are, A_k' P + P A_k = -2 L_k L_k' - eps I - 2 sigma P, so every
//! step of the optimiser stays inside the certificate. Positions are relative to the attractor, in normalised units.

use super::fit::MARGIN;
use super::gmm::{MAX_COMPONENTS, Mixture, cholesky, whitening};
use nalgebra::{SMatrix, SVector};

/// Parameters of one component, in the order of a row of the Jacobian: w, mu, W, L, S. B of them: 10 in the plane, 19 in space.
#[derive(Debug, Clone)]
pub struct Part<const D: usize> {
    /// w
    pub log_weight: f64,
    /// mu
    pub mean: SVector<f64, D>,
    /// W, lower triangular
    pub whitening: SMatrix<f64, D, D>,
    /// L, lower triangular
    pub root: SMatrix<f64, D, D>,
    /// S, skew
    pub skew: SMatrix<f64, D, D>,
    /// A, from the others
    pub a: SMatrix<f64, D, D>,
}

/// All parameters.
#[derive(Debug, Clone)]
pub struct Field<const D: usize> {
    /// The components.
    pub parts: Vec<Part<D>>,
    /// R, lower triangular, P = R R'.
    pub r: SMatrix<f64, D, D>,
    /// P
    pub p: SMatrix<f64, D, D>,
    /// P^-1
    pub inverse: SMatrix<f64, D, D>,
    /// sigma
    pub sigma: f64,
}

/// What is computed at one point.
pub struct Local<const D: usize> {
    /// gamma_k
    pub gamma: [f64; MAX_COMPONENTS],
    /// W_k (x - mu_k)
    pub y: [SVector<f64, D>; MAX_COMPONENTS],
    /// A_k x
    pub each: [SVector<f64, D>; MAX_COMPONENTS],
    /// f
    pub f: SVector<f64, D>,
}

/// Number of entries of a lower triangle.
pub const fn triangle(d: usize) -> usize {
    d * (d + 1) / 2
}

impl<const D: usize> Field<D> {
    /// From a mixture and matrices that meet the inequality, or nearly so.
    pub fn new(mixture: &Mixture<D>, p: &SMatrix<f64, D, D>, a: &[SMatrix<f64, D, D>], sigma: f64) -> Option<Self> {
        let r = cholesky(p)?;
        let parts = mixture
            .components()
            .zip(a)
            .map(|((prior, mean, covariance), a)| {
                let (w, log_det) = whitening(covariance)?;
                let m = p * (a + SMatrix::identity() * sigma) + SMatrix::identity() * (0.5 * MARGIN);
                let fall = -(m + m.transpose()) * 0.5;
                // On the edge of the inequality L loses rank, and with it its derivative: start a little inside.
                let size = (p * a).norm();
                let root = [0.01, 0.05, 0.2, 1.0]
                    .iter()
                    .find_map(|inside| cholesky(&(fall + SMatrix::identity() * (inside * size))))?;
                Some(Part {
                    log_weight: prior.ln() - 0.5 * log_det,
                    mean: *mean,
                    whitening: w,
                    root,
                    skew: (m - m.transpose()) * 0.5,
                    a: *a,
                })
            })
            .collect::<Option<Vec<_>>>()?;
        let mut field = Self { parts, r, p: *p, inverse: *p, sigma };
        field.update().then_some(field)
    }

    /// Brings P and A_k up to date; false where a number left its range.
    pub fn update(&mut self) -> bool {
        // The scale of P is free: its trace is D.
        let trace = (self.r * self.r.transpose()).trace();
        if !(trace > 0.0 && trace.is_finite()) {
            return false;
        }
        let scale = (D as f64 / trace).sqrt();
        self.r *= scale;
        for part in &mut self.parts {
            part.root *= scale;
            part.skew *= scale * scale;
        }
        self.p = self.r * self.r.transpose();
        let Some((w, _)) = whitening(&self.p) else { return false };
        self.inverse = w.transpose() * w;
        for part in &mut self.parts {
            let m = part.skew - part.root * part.root.transpose() - SMatrix::identity() * (0.5 * MARGIN);
            part.a = self.inverse * m - SMatrix::identity() * self.sigma;
        }
        self.parts.iter().all(|c| c.a.iter().all(|a| a.is_finite()))
    }

    /// Everything at x.
    #[inline]
    pub fn at(&self, x: &SVector<f64, D>) -> Local<D> {
        let mut local = Local {
            gamma: [0.0; MAX_COMPONENTS],
            y: [SVector::zeros(); MAX_COMPONENTS],
            each: [SVector::zeros(); MAX_COMPONENTS],
            f: SVector::zeros(),
        };
        let mut largest = f64::NEG_INFINITY;
        for (k, c) in self.parts.iter().enumerate() {
            local.y[k] = c.whitening * (x - c.mean);
            local.gamma[k] = c.log_weight - 0.5 * local.y[k].norm_squared();
            largest = largest.max(local.gamma[k]);
        }
        let mut sum = 0.0;
        for (k, c) in self.parts.iter().enumerate() {
            let exponent = local.gamma[k] - largest;
            local.gamma[k] = if exponent > -30.0 { exponent.exp() } else { 0.0 };
            sum += local.gamma[k];
            if local.gamma[k] > 0.0 {
                local.each[k] = c.a * x;
            }
        }
        let share = 1.0 / sum;
        for k in 0..self.parts.len() {
            local.gamma[k] *= share;
            local.f += local.each[k] * local.gamma[k];
        }
        local
    }

    /// f(x)
    #[inline]
    pub fn velocity(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        self.at(x).f
    }

    /// df/dx
    pub fn slope(&self, local: &Local<D>) -> SMatrix<f64, D, D> {
        let mut j = SMatrix::zeros();
        for (k, c) in self.parts.iter().enumerate() {
            if local.gamma[k] > 1e-6 {
                let away = c.whitening.transpose() * local.y[k];
                j += (c.a - (local.each[k] - local.f) * away.transpose()) * local.gamma[k];
            }
        }
        j
    }

    /// df/d(parameters of component k), a row an axis.
    #[inline]
    pub fn block<const B: usize>(&self, k: usize, x: &SVector<f64, D>, local: &Local<D>) -> [[f64; B]; D] {
        let c = &self.parts[k];
        let (gamma, y) = (local.gamma[k], &local.y[k]);
        let shift = (local.each[k] - local.f) * gamma;
        let off = x - c.mean;
        let away = c.whitening.transpose() * y;
        let mut out = [[0.0; B]; D];
        let mut at = 0;
        let mut put = |column: SVector<f64, D>| {
            for r in 0..D {
                out[r][at] = column[r];
            }
            at += 1;
        };
        put(shift);
        for j in 0..D {
            put(shift * away[j]);
        }
        for i in 0..D {
            for j in 0..=i {
                put(shift * (-y[i] * off[j]));
            }
        }
        let u = c.root.transpose() * x;
        let inverse = self.inverse * gamma;
        for i in 0..D {
            for j in 0..=i {
                let mut v = c.root.column(j) * -x[i];
                v[i] -= u[j];
                put(inverse * v);
            }
        }
        for i in 0..D {
            for j in i + 1..D {
                put(inverse.column(i) * x[j] - inverse.column(j) * x[i]);
            }
        }
        out
    }

    /// df/dR, a column an entry of R's lower triangle. dA = -P^-1 dP (A + sigma I).
    #[inline]
    pub fn shared(&self, x: &SVector<f64, D>, local: &Local<D>) -> [[f64; 6]; D] {
        let g = local.f + x * self.sigma;
        let u = self.r.transpose() * g;
        let mut out = [[0.0; 6]; D];
        let mut at = 0;
        for i in 0..D {
            for j in 0..=i {
                let mut v = self.r.column(j) * -g[i];
                v[i] -= u[j];
                let v = self.inverse * v;
                for r in 0..D {
                    out[r][at] = v[r];
                }
                at += 1;
            }
        }
        out
    }

    /// Adds a step to every parameter, B a component and then R.
    pub fn moved<const B: usize>(&self, step: &[f64]) -> Self {
        let mut field = self.clone();
        for (k, c) in field.parts.iter_mut().enumerate() {
            let mut rest = step[k * B..(k + 1) * B].iter();
            let mut next = || rest.next().copied().unwrap_or(0.0);
            c.log_weight += next();
            for j in 0..D {
                c.mean[j] += next();
            }
            for i in 0..D {
                for j in 0..=i {
                    c.whitening[(i, j)] += next();
                }
            }
            for i in 0..D {
                for j in 0..=i {
                    c.root[(i, j)] += next();
                }
            }
            for i in 0..D {
                for j in i + 1..D {
                    let s = next();
                    c.skew[(i, j)] += s;
                    c.skew[(j, i)] -= s;
                }
            }
        }
        let mut rest = step[self.parts.len() * B..].iter();
        for i in 0..D {
            for j in 0..=i {
                field.r[(i, j)] += rest.next().copied().unwrap_or(0.0);
            }
        }
        field
    }

    /// The mixture, with priors that sum to one.
    pub fn mixture(&self) -> Option<Mixture<D>> {
        // log pi = w + 1/2 log det Sigma = w - sum of log W_ii
        let logs: Vec<f64> = self
            .parts
            .iter()
            .map(|c| c.log_weight - (0..D).map(|i| c.whitening[(i, i)].abs().ln()).sum::<f64>())
            .collect();
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = logs.iter().map(|l| (l - largest).exp()).sum();
        let priors = logs.iter().map(|l| (l - largest).exp() / total).collect();
        let covariances = self
            .parts
            .iter()
            .map(|c| {
                let inverse = c.whitening.try_inverse()?;
                let s = inverse * inverse.transpose();
                Some((s + s.transpose()) * 0.5)
            })
            .collect::<Option<_>>()?;
        Mixture::new(priors, self.parts.iter().map(|c| c.mean).collect(), covariances)
    }
}
