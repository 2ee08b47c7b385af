//! Where each linear system rules: a Gaussian mixture over positions, fitted by expectation-maximisation.
//!
//! While fitting, a sample also has a direction of motion, and each component a mean direction; so strokes that
//! cross or lie side by side are told apart. The mixture that results is over positions only, as the device uses it.

use nalgebra::{SMatrix, SVector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Components a device holds.
pub const MAX_COMPONENTS: usize = 16;

const ITERATIONS: usize = 100;
const RESTARTS: u64 = 4;
/// Added to every variance, in units of the squared extent: one percent of the extent is the finest detail.
const FLOOR: f64 = 1e-4;
/// Spread of directions inside a component, for unit vectors.
const DIRECTION_SPREAD: f64 = 0.8;

/// Samples in normalised units: positions relative to the attractor, extent one, root-mean-square speed one.
#[derive(Debug, Clone)]
pub struct Samples<const D: usize> {
    /// Positions.
    pub x: Vec<SVector<f64, D>>,
    /// Velocities.
    pub v: Vec<SVector<f64, D>>,
}

/// One component, ready to evaluate.
#[derive(Debug, Clone)]
struct Gaussian<const D: usize> {
    log_weight: f64,
    mean: SVector<f64, D>,
    whitening: SMatrix<f64, D, D>,
}

/// A Gaussian mixture.
#[derive(Debug, Clone)]
pub struct Mixture<const D: usize> {
    priors: Vec<f64>,
    covariances: Vec<SMatrix<f64, D, D>>,
    gaussians: Vec<Gaussian<D>>,
}

impl<const D: usize> Mixture<D> {
    /// From its parameters; `None` where a covariance is not positive definite, a prior not positive, or a size wrong.
    pub fn new(priors: Vec<f64>, means: Vec<SVector<f64, D>>, covariances: Vec<SMatrix<f64, D, D>>) -> Option<Self> {
        let k = priors.len();
        if k == 0 || k > MAX_COMPONENTS || means.len() != k || covariances.len() != k {
            return None;
        }
        let gaussians = priors
            .iter()
            .zip(&means)
            .zip(&covariances)
            .map(|((&prior, &mean), covariance)| {
                let (whitening, log_det) = whitening(covariance)?;
                let log_weight = prior.ln() - 0.5 * log_det;
                log_weight.is_finite().then_some(Gaussian { log_weight, mean, whitening })
            })
            .collect::<Option<_>>()?;
        Some(Self { priors, covariances, gaussians })
    }

    /// Number of components.
    pub fn len(&self) -> usize {
        self.gaussians.len()
    }

    /// Never true: a mixture has a component.
    pub fn is_empty(&self) -> bool {
        self.gaussians.is_empty()
    }

    /// Prior, mean and covariance of each component.
    pub fn components(&self) -> impl Iterator<Item = (f64, &SVector<f64, D>, &SMatrix<f64, D, D>)> {
        self.priors
            .iter()
            .zip(&self.gaussians)
            .zip(&self.covariances)
            .map(|((&prior, g), covariance)| (prior, &g.mean, covariance))
    }

    /// Activations gamma_k(x), and the log-likelihood of x without the constant of the dimension.
    pub fn activations(&self, x: &SVector<f64, D>) -> ([f64; MAX_COMPONENTS], f64) {
        let mut gamma = [0.0; MAX_COMPONENTS];
        let log_sum = softmax(&mut gamma[..self.len()], |k| {
            let g = &self.gaussians[k];
            g.log_weight - 0.5 * (g.whitening * (x - g.mean)).norm_squared()
        });
        (gamma, log_sum)
    }
}

/// Lower triangular L with L L' = m.
pub fn cholesky<const D: usize>(m: &SMatrix<f64, D, D>) -> Option<SMatrix<f64, D, D>> {
    // By hand: nalgebra's needs bounds on D that a const generic cannot state.
    let mut l = SMatrix::<f64, D, D>::zeros();
    for i in 0..D {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|n| l[(i, n)] * l[(j, n)]).sum();
            let rest = m[(i, j)] - dot;
            if i == j {
                if !(rest > 0.0 && rest.is_finite()) {
                    return None;
                }
                l[(i, i)] = rest.sqrt();
            } else {
                l[(i, j)] = rest / l[(j, j)];
            }
        }
    }
    Some(l)
}

/// W with W'W = covariance^-1 and lower triangular, and log det covariance.
pub fn whitening<const D: usize>(covariance: &SMatrix<f64, D, D>) -> Option<(SMatrix<f64, D, D>, f64)> {
    let l = cholesky(covariance)?;
    let mut w = SMatrix::<f64, D, D>::zeros();
    for j in 0..D {
        for i in j..D {
            let dot: f64 = (j..i).map(|m| l[(i, m)] * w[(m, j)]).sum();
            w[(i, j)] = (if i == j { 1.0 } else { 0.0 } - dot) / l[(i, i)];
        }
    }
    let log_det = 2.0 * (0..D).map(|i| l[(i, i)].ln()).sum::<f64>();
    w.iter().all(|c| c.is_finite()).then_some((w, log_det))
}

/// Fills `out` with the normalised exponentials and returns the logarithm of their sum.
fn softmax(out: &mut [f64], log: impl Fn(usize) -> f64) -> f64 {
    let mut largest = f64::NEG_INFINITY;
    for (k, o) in out.iter_mut().enumerate() {
        *o = log(k);
        largest = largest.max(*o);
    }
    let mut sum = 0.0;
    for o in out.iter_mut() {
        *o = (*o - largest).exp();
        sum += *o;
    }
    out.iter_mut().for_each(|o| *o /= sum);
    largest + sum.ln()
}

/// The likeliest of several mixtures of `k` components. Fewer may come back where components die out.
pub fn fit<const D: usize>(samples: &Samples<D>, k: usize, direction: f64, seed: u64) -> Option<Mixture<D>> {
    let k = k.min(samples.x.len() / (D + 1)).max(1);
    let u: Vec<_> =
        samples.v.iter().map(|v| v.try_normalize(1e-9).unwrap_or_else(SVector::zeros) * direction).collect();
    (0..RESTARTS)
        .filter_map(|restart| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(RESTARTS).wrapping_add(restart));
            let start = k_means(&samples.x, &u, k, &mut rng);
            expectation_maximisation(&samples.x, &u, k, start)
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(mixture, _)| mixture)
}

/// The mixture of labelled samples; labels without enough samples give no component.
pub fn labelled<const D: usize>(x: &[SVector<f64, D>], label: &[usize], k: usize) -> Option<Mixture<D>> {
    let (mut priors, mut means, mut covariances) = (vec![], vec![], vec![]);
    for j in 0..k {
        let mine = || x.iter().zip(label).filter(|(_, l)| **l == j).map(|(x, _)| x);
        let count = mine().count();
        if count <= D {
            continue;
        }
        let mean = mine().fold(SVector::zeros(), |s: SVector<f64, D>, x| s + x) / count as f64;
        let spread = mine().fold(SMatrix::<f64, D, D>::zeros(), |s, x| s + (x - mean) * (x - mean).transpose());
        let covariance = spread / count as f64 + SMatrix::identity() * FLOOR;
        priors.push(count as f64 / x.len() as f64);
        means.push(mean);
        covariances.push((covariance + covariance.transpose()) * 0.5);
    }
    Mixture::new(priors, means, covariances)
}

/// k-means++ seeds and a few rounds of k-means, on position and weighted direction. Returns the label of each sample.
fn k_means<const D: usize>(x: &[SVector<f64, D>], u: &[SVector<f64, D>], k: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    let distance =
        |i: usize, c: &(SVector<f64, D>, SVector<f64, D>)| (x[i] - c.0).norm_squared() + (u[i] - c.1).norm_squared();
    let n = x.len();
    let first = rng.random_range(0..n);
    let mut centres = vec![(x[first], u[first])];
    while centres.len() < k {
        let weight: Vec<f64> =
            (0..n).map(|i| centres.iter().map(|c| distance(i, c)).fold(f64::MAX, f64::min)).collect();
        let mut rest = rng.random::<f64>() * weight.iter().sum::<f64>();
        let pick = weight.iter().position(|w| {
            rest -= w;
            rest < 0.0
        });
        let pick = pick.unwrap_or(n - 1);
        centres.push((x[pick], u[pick]));
    }
    let mut label = vec![0; n];
    for _ in 0..15 {
        for (i, l) in label.iter_mut().enumerate() {
            let nearest = (0..k).min_by(|&a, &b| distance(i, &centres[a]).total_cmp(&distance(i, &centres[b])));
            *l = nearest.unwrap_or(0);
        }
        for (j, centre) in centres.iter_mut().enumerate() {
            let mine: Vec<usize> = (0..n).filter(|&i| label[i] == j).collect();
            if !mine.is_empty() {
                let mean = |all: &[SVector<f64, D>]| {
                    mine.iter().fold(SVector::zeros(), |s: SVector<f64, D>, &i| s + all[i]) / mine.len() as f64
                };
                *centre = (mean(x), mean(u));
            }
        }
    }
    label
}

fn expectation_maximisation<const D: usize>(
    x: &[SVector<f64, D>],
    u: &[SVector<f64, D>],
    k: usize,
    label: Vec<usize>,
) -> Option<(Mixture<D>, f64)> {
    let n = x.len();
    let mut gamma = vec![[0.0; MAX_COMPONENTS]; n];
    for (g, l) in gamma.iter_mut().zip(label) {
        g[l] = 1.0;
    }
    let mut before = f64::NEG_INFINITY;
    let mut best = None;
    for _ in 0..ITERATIONS {
        let (mut priors, mut means, mut directions, mut covariances) = (vec![], vec![], vec![], vec![]);
        let sums: Vec<f64> = (0..k).map(|j| gamma.iter().map(|g| g[j]).sum()).collect();
        let largest = sums.iter().copied().fold(0.0, f64::max);
        for (j, &sum) in sums.iter().enumerate() {
            // Fewer samples than a Gaussian has axes: this component has died out. One always lives.
            if sum < (D + 1) as f64 && sum < largest {
                continue;
            }
            let mean = gamma.iter().zip(x).fold(SVector::zeros(), |s: SVector<f64, D>, (g, x)| s + x * g[j]) / sum;
            let heading = gamma.iter().zip(u).fold(SVector::zeros(), |s: SVector<f64, D>, (g, u)| s + u * g[j]) / sum;
            let mut covariance = SMatrix::<f64, D, D>::zeros();
            for (g, x) in gamma.iter().zip(x) {
                let e = x - mean;
                covariance += e * e.transpose() * (g[j] / sum);
            }
            covariance += SMatrix::identity() * FLOOR;
            priors.push(sum / n as f64);
            means.push(mean);
            directions.push(heading);
            covariances.push((covariance + covariance.transpose()) * 0.5);
        }
        let total: f64 = priors.iter().sum();
        priors.iter_mut().for_each(|p| *p /= total);
        let mixture = Mixture::new(priors, means, covariances)?;
        let alive = mixture.len();
        let mut likelihood = 0.0;
        for (i, g) in gamma.iter_mut().enumerate() {
            *g = [0.0; MAX_COMPONENTS];
            likelihood += softmax(&mut g[..alive], |j| {
                let c = &mixture.gaussians[j];
                c.log_weight
                    - 0.5 * (c.whitening * (x[i] - c.mean)).norm_squared()
                    - 0.5 * ((u[i] - directions[j]) / DIRECTION_SPREAD).norm_squared()
            });
        }
        best = Some((mixture, likelihood));
        if (likelihood - before).abs() < 1e-5 * n as f64 {
            break;
        }
        before = likelihood;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    fn blobs() -> Samples<2> {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut x = vec![];
        for _ in 0..300 {
            for centre in [Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)] {
                x.push(centre + Vector2::new(rng.random::<f64>() - 0.5, rng.random::<f64>() - 0.5) * 0.2);
            }
        }
        let v = vec![Vector2::new(1.0, 0.0); x.len()];
        Samples { x, v }
    }

    #[test]
    fn finds_three_blobs_and_repeats_itself() {
        let samples = blobs();
        let mixture = fit(&samples, 3, 0.5, 7).expect("fits");
        for centre in [Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)] {
            let near = mixture.components().filter(|c| (c.1 - centre).norm() < 0.03).count();
            assert_eq!(near, 1, "{centre}");
        }
        let again = fit(&samples, 3, 0.5, 7).expect("fits");
        assert!(mixture.components().zip(again.components()).all(|(a, b)| a == b));
    }

    #[test]
    fn activations_sum_to_one_far_away() {
        let mixture = fit(&blobs(), 3, 0.0, 1).expect("fits");
        let (gamma, _) = mixture.activations(&Vector2::new(1e4, -1e5));
        assert!((gamma.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn whitening_inverts_the_covariance() {
        let c = Matrix2::new(2.0, 0.7, 0.7, 0.5);
        let (w, log_det) = whitening(&c).expect("positive definite");
        assert!((w.transpose() * w * c - Matrix2::identity()).norm() < 1e-12);
        assert!((log_det - c.determinant().ln()).abs() < 1e-12);
        assert_eq!(w[(0, 1)], 0.0);
        assert!(whitening(&Matrix2::new(1.0, 2.0, 2.0, 1.0)).is_none());
    }
}
