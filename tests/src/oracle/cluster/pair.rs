//! The point of two ellipsoids where the larger Gamma is least: Newton's method on what holds there.

use nalgebra::{DMatrix, DVector};

use super::super::obstacle::Body;
use super::super::shape::Shape;

/// Where the gradients are opposite and the Gammas equal: (1-l) g_a + l g_b = 0, Gamma_a = Gamma_b. None for other shapes, or
/// if the search does not end.
pub(super) fn meeting(a: &Body, b: &Body) -> Option<DVector<f64>> {
    let (pa, pb) = (quadratic(a)?, quadratic(b)?);
    let d = a.center.len();
    let gammas = |x: &DVector<f64>| {
        let (qa, qb) = (x - &a.center, x - &b.center);
        (qa.dot(&(&pa * &qa)), qb.dot(&(&pb * &qb)))
    };
    // On the line between the centres the two are equal somewhere.
    let (mut low, mut high) = (0.0, 1.0);
    let on = |t: f64| &a.center * (1.0 - t) + &b.center * t;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let (ga, gb) = gammas(&on(middle));
        if ga < gb {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut x = on(low);
    let mut share = 0.5;
    let merit = |r: &DVector<f64>| r.norm();
    let residual = |x: &DVector<f64>, share: f64| {
        let (ga, gb) = gammas(x);
        let slope = &pa * (x - &a.center) * (1.0 - share) + &pb * (x - &b.center) * share;
        // Both in the same units.
        let size = (pa.norm() + pb.norm()).sqrt();
        DVector::from_fn(d + 1, |i, _| if i < d { slope[i] / size } else { 0.5 * (ga - gb) })
    };
    for _ in 0..200 {
        let now = residual(&x, share);
        let size = (pa.norm() + pb.norm()).sqrt();
        let (sa, sb) = (&pa * (&x - &a.center), &pb * (&x - &b.center));
        let jacobian = DMatrix::from_fn(d + 1, d + 1, |i, j| match (i < d, j < d) {
            (true, true) => ((1.0 - share) * pa[(i, j)] + share * pb[(i, j)]) / size,
            (true, false) => (sb[i] - sa[i]) / size,
            (false, true) => sa[j] - sb[j],
            (false, false) => 0.0,
        });
        let step = jacobian.lu().solve(&now)?;
        let mut length = 1.0;
        let mut moved = (x.clone(), share);
        while length > 1e-6 {
            moved = (&x - step.rows(0, d) * length, (share - step[d] * length).clamp(0.0, 1.0));
            if merit(&residual(&moved.0, moved.1)) < merit(&now) {
                break;
            }
            length *= 0.5;
        }
        if length <= 1e-6 {
            // Rounding is all that is left.
            break;
        }
        (x, share) = moved;
    }
    (merit(&residual(&x, share)) < 1e-11).then_some(x)
}

/// P = Q diag(1/a^2) Q' of a surface that is an ellipsoid.
fn quadratic(body: &Body) -> Option<DMatrix<f64>> {
    let Shape::Ellipsoid { axes, exponent } = &body.shape else {
        return None;
    };
    if body.wall || *exponent != 2.0 {
        return None;
    }
    let squares = axes.component_mul(&body.hard).map(|a| 1.0 / (a * a));
    Some(&body.rotation * DMatrix::from_diagonal(&squares) * body.rotation.transpose())
}
