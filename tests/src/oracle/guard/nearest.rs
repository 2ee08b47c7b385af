//! The nearest point of a set that half-spaces and a ball bound, by trying every way to touch its boundary.

use nalgebra::{DMatrix, DVector};

use super::super::geometry::{length, unit};

/// n.u >= bound, n of unit length.
#[derive(Debug, Clone)]
pub(in super::super) struct Bound {
    pub(in super::super) normal: DVector<f64>,
    pub(in super::super) least: f64,
}

/// By how much a bound may be missed, relative to the size of what is bounded.
const SLACK: f64 = 1e-11;

/// The point nearest to `wanted` that keeps every bound and is within `radius` of the origin; none where there is no such
/// point. The nearest point is the nearest of what some d or fewer of the boundaries have in common, whichever those are.
pub(in super::super) fn nearest(bounds: &[Bound], wanted: &DVector<f64>, radius: f64) -> Option<DVector<f64>> {
    // A bound that the ball keeps by itself never counts.
    let bounds: Vec<&Bound> = bounds.iter().filter(|bound| bound.least > -radius).collect();
    let size = bounds.iter().map(|bound| bound.least.abs()).fold(length(wanted), f64::max).min(radius);
    let slack = SLACK * size.max(1e-3);
    let keeps = |u: &DVector<f64>| {
        length(u) <= radius + slack && bounds.iter().all(|bound| bound.normal.dot(u) >= bound.least - slack)
    };
    let mut best: Option<(f64, DVector<f64>)> = None;
    let mut touch = |chosen: &[&Bound]| {
        for candidate in candidates(chosen, wanted, radius).into_iter().flatten() {
            let far = length(&(&candidate - wanted));
            if best.as_ref().is_none_or(|(least, _)| far < *least) && keeps(&candidate) {
                best = Some((far, candidate));
            }
        }
    };
    touch(&[]);
    for (i, a) in bounds.iter().enumerate() {
        touch(&[a]);
        for (j, b) in bounds.iter().enumerate().skip(i + 1) {
            touch(&[a, b]);
            if wanted.len() == 3 {
                bounds.iter().skip(j + 1).for_each(|c| touch(&[a, b, c]));
            }
        }
    }
    best.map(|(_, u)| u)
}

/// The points of the planes' common flat nearest to `wanted`, free of the ball and on its surface.
fn candidates(chosen: &[&Bound], wanted: &DVector<f64>, radius: f64) -> [Option<DVector<f64>>; 2] {
    let d = wanted.len();
    // The directions in which the flat goes on, and its point nearest to the origin.
    let Some((foot, across)) = flat(chosen, d) else {
        return [None, None];
    };
    let inside = |v: &DVector<f64>| v - across.iter().fold(DVector::zeros(d), |sum, n| sum + n * n.dot(v));
    let along = inside(wanted);
    let free = &foot + &along;
    let left = radius * radius - foot.norm_squared();
    if !radius.is_finite() || left < 0.0 || across.len() >= d {
        return [Some(free), None];
    }
    let rim = unit(&along).map(|way| &foot + way * left.sqrt());
    [Some(free), rim]
}

/// The point nearest to the origin of all planes together, and an orthonormal basis of their normals.
fn flat(chosen: &[&Bound], d: usize) -> Option<(DVector<f64>, Vec<DVector<f64>>)> {
    if chosen.is_empty() {
        return Some((DVector::zeros(d), Vec::new()));
    }
    let rows = DMatrix::from_fn(chosen.len(), d, |i, j| chosen[i].normal[j]);
    let gram = &rows * rows.transpose();
    if gram.determinant() < 1e-14 {
        return None;
    }
    let least = DVector::from_iterator(chosen.len(), chosen.iter().map(|bound| bound.least));
    let foot = rows.transpose() * gram.lu().solve(&least)?;
    let mut across: Vec<DVector<f64>> = Vec::new();
    for bound in chosen {
        let own = across.iter().fold(bound.normal.clone(), |rest, n| &rest - n * n.dot(&rest));
        let own = across.iter().fold(own.clone(), |rest, n| &rest - n * n.dot(&rest));
        across.push(unit(&own)?);
    }
    Some((foot, across))
}

/// The smallest t with which n.u >= least - t has a solution within the ball, by bisection.
pub(in super::super) fn least_violation(bounds: &[Bound], dimension: usize, radius: f64) -> f64 {
    let wanted = DVector::zeros(dimension);
    let possible = |t: f64| {
        let eased: Vec<Bound> = bounds.iter().map(|b| Bound { normal: b.normal.clone(), least: b.least - t }).collect();
        nearest(&eased, &wanted, radius).is_some()
    };
    let (mut too_little, mut enough) = (0.0, bounds.iter().map(|bound| bound.least).fold(0.0, f64::max));
    if possible(too_little) {
        return 0.0;
    }
    // At the origin nothing is missed by more than the largest bound.
    for _ in 0..60 {
        let middle = 0.5 * (too_little + enough);
        if possible(middle) {
            enough = middle;
        } else {
            too_little = middle;
        }
    }
    enough
}
