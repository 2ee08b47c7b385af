//! The proof that a skill ends at its attractor, checked on the very numbers that run.

use core::ops::Deref;

use super::LpvDs;
use crate::{Matrix, Scalar};

/// A model whose certificate was checked: P = P' > 0 and A_k' P + P A_k < 0 for every k, so that V = (x - x*)' P (x -
/// x*) decreases along f everywhere but at x*. The only way to get one is [`LpvDs::certify`]; the model itself is
/// what it derefs to, and cannot be changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Certified<M> {
    model: M,
}

impl<M> Deref for Certified<M> {
    type Target = M;
    fn deref(&self) -> &M {
        &self.model
    }
}

/// What the check found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate<S> {
    /// A rate sigma, 1/s, for which A_k' P + P A_k <= -2 sigma P holds for every k, rounding included: V decreases at
    /// least as fast as e^(-2 sigma t), the distance (in P's norm) as e^(-sigma t).
    pub rate: S,
    /// The component that limits the rate, counted from 0.
    pub slowest: usize,
}

/// Why a model is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CertificateError {
    /// P is not symmetric positive definite.
    Lyapunov,
    /// A_k' P + P A_k is not negative definite for this k.
    Component(usize),
}

impl core::fmt::Display for CertificateError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Lyapunov => f.write_str("lyapunov is not symmetric positive definite"),
            Self::Component(k) => {
                write!(f, "components[{k}].a breaks the certificate: A'P + PA is not negative definite")
            }
        }
    }
}

impl core::error::Error for CertificateError {}

impl<S: Scalar, const D: usize> LpvDs<S, D> {
    /// Checks P = P' > 0 and A_k' P + P A_k < 0 for every k, in this model's own precision (Figueroa & Billard, CoRL
    /// 2018; eqs. 1-5 of Chen et al.).
    ///
    /// Both are decided by elimination with every pivot positive after the diagonal was lowered by a bound on the
    /// rounding error of the products and of the elimination (8 d^2 [`Scalar::rounding`] of the largest term, some
    /// twice what d <= 3 needs), so "holds" means it holds for the exact values of the stored numbers.
    ///
    /// # Errors
    /// Which part fails, with its k.
    ///
    /// ```
    /// use pliant_core::nalgebra::{Matrix2, Vector2};
    /// use pliant_core::{Component, LpvDs, ds::CertificateError};
    /// let part = |a| Component { log_weight: 0.0, mean: Vector2::zeros(), whitening: Matrix2::identity(), a };
    /// let stable = part(Matrix2::new(-1.0_f32, 0.5, -0.5, -1.0));
    /// let not = part(Matrix2::new(-1.0_f32, 3.0, 0.0, -1.0));
    /// let model = |c: &[_]| LpvDs::new(Vector2::zeros(), Matrix2::identity(), c).unwrap();
    /// assert!(model(&[stable.clone()]).certify().is_ok());
    /// assert_eq!(model(&[stable, not]).certify().unwrap_err(), CertificateError::Component(1));
    /// ```
    pub fn certify(self) -> Result<Certified<Self>, CertificateError> {
        self.check_certificate(S::zero())?;
        Ok(Certified { model: self })
    }

    fn check_certificate(&self, rate: S) -> Result<(), CertificateError> {
        let p = self.lyapunov();
        if *p != p.transpose() || !positive_definite(p, rounding(p)) {
            return Err(CertificateError::Lyapunov);
        }
        match self.components().iter().position(|c| !decreases(&c.a, p, rate)) {
            None => Ok(()),
            Some(k) => Err(CertificateError::Component(k)),
        }
    }
}

impl<S: Scalar, const D: usize> Certified<LpvDs<S, D>> {
    /// The guaranteed rate of convergence, found by bisection: the largest sigma (1/s) with A_k' P + P A_k + 2 sigma
    /// P < 0 for every k. Some thousands of operations: not for the tick.
    pub fn certificate(&self) -> Certificate<S> {
        let mut found = Certificate { rate: S::MAX, slowest: 0 };
        for (k, c) in self.components().iter().enumerate() {
            let (mut low, mut high) = (S::zero(), S::from_f64(1.0));
            while decreases(&c.a, self.lyapunov(), high) && high < S::from_f64(1e6) {
                (low, high) = (high, high + high);
            }
            for _ in 0..20 {
                let middle = (low + high) * S::from_f64(0.5);
                if decreases(&c.a, self.lyapunov(), middle) { low = middle } else { high = middle }
            }
            if low < found.rate {
                found = Certificate { rate: low, slowest: k };
            }
        }
        found
    }
}

/// Is A' P + P A + 2 rate P negative definite, rounding included?
fn decreases<S: Scalar, const D: usize>(a: &Matrix<S, D>, p: &Matrix<S, D>, rate: S) -> bool {
    let pa = p * a;
    let two_rate = rate + rate;
    let m = -(pa + pa.transpose()) - p * two_rate;
    let (a, p) = (a.map(|x| x.abs()), p.map(|x| x.abs()));
    let pa = p * a;
    positive_definite(&m, rounding(&(pa + pa.transpose() + p * two_rate)))
}

/// A bound on the spectral norm of all rounding errors, from the sizes of the terms that went in.
fn rounding<S: Scalar, const D: usize>(terms: &Matrix<S, D>) -> S {
    let largest = terms.iter().fold(S::zero(), |m, x| m.max(x.abs()));
    S::rounding(largest) * S::from_f64(8.0 * (D * D) as f64)
}

/// Does elimination of m - shift I find positive pivots only? False for anything not-a-number.
///
/// The largest diagonal element comes first. Then no factor of a positive definite matrix is larger than one, and
/// errors do not grow: in fixed point, where they are absolute, as little as in floating point.
fn positive_definite<S: Scalar, const D: usize>(m: &Matrix<S, D>, shift: S) -> bool {
    let mut m = m - Matrix::<S, D>::identity() * shift;
    for k in 0..D {
        let largest = (k..D).fold(k, |best, i| if m[(i, i)] > m[(best, best)] { i } else { best });
        m.swap_rows(k, largest);
        m.swap_columns(k, largest);
        let pivot = m[(k, k)];
        if !(pivot > S::zero() && pivot.is_finite()) {
            return false;
        }
        for i in k + 1..D {
            let factor = m[(i, k)] / pivot;
            if !(factor.abs() <= S::one()) {
                return false;
            }
            for j in k + 1..D {
                let taken = factor * m[(k, j)];
                m[(i, j)] -= taken;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn definite_is_what_eigenvalues_say(entries in prop::array::uniform6(-1.0..1.0f64), diagonal in 0.0..2.0f64) {
            let [a, b, c, d, e, f] = entries;
            let m = Matrix::<f64, 3>::new(a + diagonal, b, c, b, d + diagonal, e, c, e, f + diagonal);
            // Sylvester: the leading minors.
            let two = m[(0, 0)] * m[(1, 1)] - b * b;
            let minor = |i: usize, j: usize| m[(1, i)] * m[(2, j)] - m[(1, j)] * m[(2, i)];
            let three = m[(0, 0)] * minor(1, 2) - b * minor(0, 2) + c * minor(0, 1);
            prop_assume!(two.abs() > 1e-9 && three.abs() > 1e-9);
            prop_assert_eq!(positive_definite(&m, 0.0), m[(0, 0)] > 0.0 && two > 0.0 && three > 0.0);
        }
    }

    /// A and P in S with the largest eigenvalue of A'P + PA near `edge`, and whether the check accepts them.
    fn on_the_edge<S: Scalar>(
        l: [f64; 3],
        r: [f64; 2],
        skew: f64,
        edge: f64,
    ) -> (Matrix<f64, 2>, Matrix<f64, 2>, bool) {
        let root = Matrix::<f64, 2>::new(l[0], 0.0, l[1], l[2]);
        let p = (root * root.transpose()).map(S::from_f64);
        let exact = p.map(S::to_f64);
        let fall = Matrix::<f64, 2>::new(r[0] * r[0], r[0] * r[1] - skew, r[0] * r[1] + skew, r[1] * r[1]);
        let inverse = Matrix::<f64, 2>::new(exact[(1, 1)], -exact[(0, 1)], -exact[(1, 0)], exact[(0, 0)])
            / (exact[(0, 0)] * exact[(1, 1)] - exact[(0, 1)] * exact[(1, 0)]);
        let a = (inverse * (Matrix::<f64, 2>::identity() * (edge * 0.5) - fall)).map(S::from_f64);
        (a.map(S::to_f64), exact, decreases(&a, &p, S::zero()))
    }

    /// The larger eigenvalue, in f64: its own error is a millionth of what f32 and fixed point round away.
    fn largest(a: &Matrix<f64, 2>, p: &Matrix<f64, 2>) -> f64 {
        let m = a.transpose() * p + p * a;
        let (mean, half) = ((m[(0, 0)] + m[(1, 1)]) * 0.5, (m[(0, 0)] - m[(1, 1)]) * 0.5);
        mean + libm::hypot(half, m[(0, 1)])
    }

    proptest! {
        /// Within a few roundings of the edge, what is accepted is negative definite; well inside, a skill is accepted.
        #[test]
        fn nothing_is_accepted_that_rounding_made(
            l in prop::array::uniform3(0.3..1.5f64), r in prop::array::uniform2(-2.0..2.0f64), skew in -5.0..5.0f64, edge in -1.0..1.0f64,
        ) {
            for unit in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
                let (a, p, accepted) = on_the_edge::<f32>(l, r, skew, edge * unit);
                prop_assert!(!accepted || largest(&a, &p) < 0.0);
                let (a, p, accepted) = on_the_edge::<crate::Fixed>(l, r, skew, edge * unit);
                prop_assert!(!accepted || largest(&a, &p) < 0.0);
            }
            // As round as what is learnt: fixed point has room for it.
            if l[0] > 0.6 && l[2] > 0.6 && l[1] < 0.8 {
                prop_assert!(on_the_edge::<f32>(l, r, skew, -0.05).2);
                prop_assert!(on_the_edge::<crate::Fixed>(l, r, skew, -0.05).2);
            }
        }
    }
}
