//! The certificate, proved without rounding.
//!
//! A device checks its skill in its own arithmetic, with a bound on what rounding may do
//! ([`LpvDs::certify`](pliant_core::LpvDs::certify)). Here the same numbers are taken for what they are, whole multiples of powers of two, and
//!
//! ```text
//! P = P' > 0    and    -(A_k' P + P A_k) - 2 sigma P > 0    for every k
//! ```
//!
//! is decided exactly, by Sylvester's criterion: a symmetric matrix is positive definite if and only if all its leading principal minors are
//! positive (Horn & Johnson, *Matrix Analysis*, theorem 7.2.5).

mod dyadic;

use dyadic::Dyadic;
use nalgebra::SMatrix;
use pliant_core::ds::{CertificateError, LpvDs};
use pliant_core::{Matrix, Scalar};

/// What was proved of a skill's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proof {
    /// A rate sigma, 1/s, that is proved: A_k' P + P A_k < -2 sigma P for every k, so that the distance to the attractor in P's norm falls as
    /// e^(-sigma t) or faster. The largest there is, less a millionth of it.
    pub margin: f64,
    /// The component that allows no larger one.
    pub slowest: usize,
}

/// Proves the certificate of the numbers in `model`, in whatever precision they are.
///
/// # Errors
/// What does not hold, with the first k.
///
/// ```
/// use nalgebra::{Matrix2, Vector2};
/// use pliant::proof::prove;
/// use pliant_core::{Component, LpvDs, ds::CertificateError};
/// let model = |a: f32| {
///     let a = Matrix2::new(-0.5, a, 0.0, -0.5);
///     let part = Component { log_weight: 0.0, mean: Vector2::zeros(), whitening: Matrix2::identity(), a };
///     LpvDs::new(Vector2::zeros(), Matrix2::identity(), &[part]).unwrap()
/// };
/// // A'P + PA has the eigenvalues -1 - a and -1 + a.
/// assert!((prove(&model(0.75)).unwrap().margin - 0.125).abs() < 1e-6);
/// assert!(prove(&model(1.0 - f32::EPSILON)).is_ok());
/// assert_eq!(prove(&model(1.0)), Err(CertificateError::Component(0)));
/// ```
pub fn prove<S: Scalar, const D: usize>(model: &LpvDs<S, D>) -> Result<Proof, CertificateError> {
    let p = Exact::new(model.lyapunov()).ok_or(CertificateError::Lyapunov)?;
    if !p.is_symmetric() || !p.is_positive_definite() {
        return Err(CertificateError::Lyapunov);
    }
    let mut proof = Proof { margin: f64::INFINITY, slowest: 0 };
    for (k, component) in model.components().iter().enumerate() {
        let a = Exact::new(&component.a).ok_or(CertificateError::Component(k))?;
        let fall = Fall::new(&a, &p);
        if !fall.is_faster_than(0.0) {
            return Err(CertificateError::Component(k));
        }
        if proof.margin.is_infinite() || !fall.is_faster_than(proof.margin) {
            proof = Proof { margin: fall.rate(), slowest: k };
        }
    }
    Ok(proof)
}

/// A component's -(A' P + P A), and 2 P.
struct Fall<const D: usize> {
    fall: Exact<D>,
    twice_p: Exact<D>,
}

impl<const D: usize> Fall<D> {
    fn new(a: &Exact<D>, p: &Exact<D>) -> Self {
        let fall = Exact::from_fn(|r, c| {
            // The entry (r, c) of A'P + PA.
            let sum = (0..D).fold(Dyadic::zero(), |sum, s| {
                let (ap, pa) = (&a.0[s][r] * &p.0[s][c], &p.0[r][s] * &a.0[s][c]);
                &(&sum + &ap) + &pa
            });
            -&sum
        });
        Self { fall, twice_p: Exact::from_fn(|r, c| &p.0[r][c] + &p.0[r][c]) }
    }

    /// -(A' P + P A) - 2 rate P > 0? Not for a rate that is not finite.
    fn is_faster_than(&self, rate: f64) -> bool {
        Dyadic::new(rate).is_some_and(|rate| {
            Exact::<D>::from_fn(|r, c| &self.fall.0[r][c] - &(&rate * &self.twice_p.0[r][c])).is_positive_definite()
        })
    }

    /// The largest rate, less a millionth of it; zero below 1e-30 1/s. Between a rate that is proved and one that is not, by bisection.
    fn rate(&self) -> f64 {
        let mut low = 1.0;
        while !self.is_faster_than(low) {
            low *= 0.5;
            if low < 1e-30 {
                return 0.0;
            }
        }
        let mut high = 2.0 * low;
        while self.is_faster_than(high) {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..21 {
            let middle = 0.5 * (low + high);
            if self.is_faster_than(middle) { low = middle } else { high = middle }
        }
        low
    }
}

/// A matrix without rounding, row by row.
struct Exact<const D: usize>([[Dyadic; D]; D]);

impl<const D: usize> Exact<D> {
    fn from_fn(entry: impl Fn(usize, usize) -> Dyadic) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c))))
    }

    /// `None` where an entry is not finite.
    fn new<S: Scalar>(m: &Matrix<S, D>) -> Option<Self> {
        let m: SMatrix<f64, D, D> = m.map(S::to_f64);
        let finite = m.iter().all(|x| x.is_finite());
        finite.then(|| Self::from_fn(|r, c| Dyadic::new(m[(r, c)]).unwrap_or_else(Dyadic::zero)))
    }

    fn is_symmetric(&self) -> bool {
        (0..D).all(|r| (0..r).all(|c| (&self.0[r][c] - &self.0[c][r]).is_zero()))
    }

    /// Sylvester's criterion.
    fn is_positive_definite(&self) -> bool {
        (1..=D).all(|n| {
            let rows: Vec<usize> = (0..n).collect();
            self.minor(&rows, &rows).is_positive()
        })
    }

    /// The determinant of these rows and columns, by expansion along the first row.
    fn minor(&self, rows: &[usize], columns: &[usize]) -> Dyadic {
        let [row, rows @ ..] = rows else { return Dyadic::new(1.0).unwrap_or_else(Dyadic::zero) };
        columns.iter().enumerate().fold(Dyadic::zero(), |sum, (i, &column)| {
            let others: Vec<usize> = columns.iter().copied().filter(|&c| c != column).collect();
            let term = &self.0[*row][column] * &self.minor(rows, &others);
            if i % 2 == 0 { &sum + &term } else { &sum - &term }
        })
    }
}

#[cfg(test)]
mod tests;
