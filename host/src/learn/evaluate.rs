//! The learnt motion in f64, as it is evaluated while learning.

use super::gmm::Mixture;
use nalgebra::{SMatrix, SVector};

/// f(x) = sum_k gamma_k(x) A_k (x - x*).
#[derive(Debug, Clone)]
pub struct Motion<const D: usize> {
    /// x*
    pub attractor: SVector<f64, D>,
    /// Of gamma_k.
    pub mixture: Mixture<D>,
    /// A_k
    pub a: Vec<SMatrix<f64, D, D>>,
}

impl<const D: usize> Motion<D> {
    /// f(x)
    pub fn velocity(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        let (gamma, _) = self.mixture.activations(x);
        let offset = x - self.attractor;
        let mut blend = SMatrix::<f64, D, D>::zeros();
        for (a, gamma) in self.a.iter().zip(gamma) {
            blend += a * gamma;
        }
        blend * offset
    }

    /// One step of the classic Runge-Kutta rule.
    pub fn step(&self, x: &SVector<f64, D>, dt: f64) -> SVector<f64, D> {
        let k1 = self.velocity(x);
        let k2 = self.velocity(&(x + k1 * (dt / 2.0)));
        let k3 = self.velocity(&(x + k2 * (dt / 2.0)));
        let k4 = self.velocity(&(x + k3 * dt));
        x + (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0)
    }

    /// The path from `start` until it is within `near` of the attractor or `seconds` have passed, and whether it arrived.
    pub fn rollout(&self, start: &SVector<f64, D>, dt: f64, seconds: f64, near: f64) -> (Vec<SVector<f64, D>>, bool) {
        let mut path = vec![*start];
        let mut x = *start;
        for _ in 0..(seconds / dt).ceil() as usize {
            if (x - self.attractor).norm() <= near {
                return (path, true);
            }
            x = self.step(&x, dt);
            if !x.iter().all(|c| c.is_finite()) {
                return (path, false);
            }
            path.push(x);
        }
        (path, false)
    }
}
