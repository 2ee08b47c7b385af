//! Two ellipsoids: their deepest point in common has a closed form.

use crate::obstacle::Obstacle;
use crate::{Matrix, Scalar, Vector};

/// Halvings of the interval in which it is.
const HALVINGS: u8 = 26;

/// The minimiser of max(Gamma_a, Gamma_b) of two ellipsoids, m, or `Some(None)` where it is outside of one; nothing for other shapes and for
/// walls.
///
/// ```text
/// x(l) = ((1-l) P_a + l P_b)^-1 ((1-l) P_a c_a + l P_b c_b),   P = Q diag(1/a^2) Q'
/// ```
///
/// for the l in [0, 1] at which both are equal: Gamma_a grows with l, and Gamma_b falls.
pub(super) fn deepest<S: Scalar, const D: usize>(
    a: &Obstacle<S, D>,
    b: &Obstacle<S, D>,
) -> Option<Option<Vector<S, D>>> {
    // Only the ratio of both counts, and squares of 1/axis leave some numbers' range.
    let scale = S::one() / a.steepest().max(b.steepest());
    let (pa, pb) = (a.quadratic(scale)?, b.quadratic(scale)?);
    let (from, apart) = (a.spec().center, b.spec().center - a.spec().center);
    let at = |l: S| {
        let weighted = pb * l;
        from + solve(pa * (S::one() - l) + weighted, weighted * apart)
    };
    let (mut low, mut step) = (S::zero(), S::from_f64(0.5));
    for _ in 0..HALVINGS {
        let x = at(low + step);
        if a.gamma(&x) < b.gamma(&x) {
            low += step;
        }
        step *= S::from_f64(0.5);
    }
    let x = at(low);
    Some((a.gamma(&x).max(b.gamma(&x)) < S::one()).then_some(x))
}

/// The solution of m x = right for a positive definite m, by elimination.
fn solve<S: Scalar, const D: usize>(mut m: Matrix<S, D>, mut right: Vector<S, D>) -> Vector<S, D> {
    for k in 0..D {
        for i in k + 1..D {
            let factor = m[(i, k)] / m[(k, k)];
            for j in k..D {
                m[(i, j)] = m[(i, j)] - factor * m[(k, j)];
            }
            right[i] = right[i] - factor * right[k];
        }
    }
    for k in (0..D).rev() {
        let known = (k + 1..D).fold(S::zero(), |sum, j| sum + m[(k, j)] * right[j]);
        right[k] = (right[k] - known) / m[(k, k)];
    }
    right
}
