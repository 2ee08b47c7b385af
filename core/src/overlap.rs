//! A point inside several hard cores at once, if there is one.

use crate::obstacle::Obstacle;
use crate::shape::Shape;
use crate::{Matrix, Scalar, Vector, norm};

/// Steps of the search for a point that several cores have in common.
const STEPS: u8 = 48;
/// Halvings of the interval in which two ellipsoids have their common point.
const HALVINGS: u8 = 26;

/// What a point that is searched for has to be inside of.
#[derive(Clone, Copy)]
pub(crate) enum Inside<'a, S: Scalar, const D: usize> {
    /// An obstacle's hard core.
    Core(&'a Obstacle<S, D>),
    /// Where an obstacle's reference point may be: of a polygon, where all of it is seen from.
    Sight(&'a Obstacle<S, D>),
}

impl<S: Scalar, const D: usize> Inside<'_, S, D> {
    /// Below one inside.
    fn level(&self, x: &Vector<S, D>) -> S {
        match self {
            Self::Core(o) => o.gamma(x),
            Self::Sight(o) => o.sight(x),
        }
    }

    /// Where that grows.
    fn slope(&self, x: &Vector<S, D>) -> Vector<S, D> {
        match self {
            Self::Core(o) => o.gradient(x),
            Self::Sight(o) => o.sight_slope(x),
        }
    }

    fn outer(&self) -> S {
        match self {
            Self::Core(o) | Self::Sight(o) => o.outer(),
        }
    }
}

/// A point well inside both hard cores, m; `None` if they do not overlap.
pub(crate) fn between<S: Scalar, const D: usize>(a: &Obstacle<S, D>, b: &Obstacle<S, D>) -> Option<Vector<S, D>> {
    let (ca, cb) = (&a.spec().center, &b.spec().center);
    let walls = a.spec().wall || b.spec().wall;
    if a.spec().wall && b.spec().wall || !walls && norm(&(ca - cb)) > a.outer() + b.outer() {
        return None;
    }
    // Only the ratio of both counts, and squares of 1/axis leave some numbers' range.
    let most = |o: &Obstacle<S, D>| o.inverse_axes().iter().fold(S::zero(), |m, x| m.max(*x));
    let scale = S::one() / most(a).max(most(b));
    let point = match (ellipsoid(a, scale), ellipsoid(b, scale)) {
        (Some(pa), Some(pb)) => between_ellipsoids(a, &pa, b, &pb),
        _ if a.spec().wall => beyond_wall(a, b),
        _ if b.spec().wall => beyond_wall(b, a),
        _ => {
            let start = on_the_way(a, cb, b);
            return common(&[Inside::Core(a), Inside::Core(b)], &start);
        }
    };
    let both = [Inside::Core(a), Inside::Core(b)];
    if both.iter().all(|o| o.level(&point) < S::one()) {
        return Some(point);
    }
    // What sticks into a wall need not do so along the wall's normal.
    if walls { common(&both, &point) } else { None }
}

/// A point inside all of these, m, searched from `start` by bounded steps: each away from the one it is least inside of, along
/// that one's Gamma. `None` if none was found.
pub(crate) fn common<S: Scalar, const D: usize>(
    members: &[Inside<'_, S, D>],
    start: &Vector<S, D>,
) -> Option<Vector<S, D>> {
    let mut x = *start;
    let mut best: Option<(S, Vector<S, D>)> = None;
    let mut step = members.iter().fold(S::MAX, |m, o| m.min(o.outer()));
    for _ in 0..STEPS {
        let worst = members.iter().map(|o| (o.level(&x), o)).reduce(|worst, o| if o.0 > worst.0 { o } else { worst });
        let (gamma, obstacle) = worst?;
        if best.as_ref().is_none_or(|(least, _)| gamma < *least) {
            best = Some((gamma, x));
        }
        let slope = obstacle.slope(&x);
        let length = norm(&slope);
        if !(length > S::zero()) {
            break;
        }
        // A shrinking step: the maximum of convex functions has no other descent that is as simple.
        x -= slope * (step / length);
        step *= S::from_f64(0.9);
    }
    best.filter(|(gamma, _)| *gamma < S::one()).map(|(_, x)| x)
}

/// Between the centres, the point where both Gammas are equal.
fn on_the_way<S: Scalar, const D: usize>(a: &Obstacle<S, D>, to: &Vector<S, D>, b: &Obstacle<S, D>) -> Vector<S, D> {
    let from = a.spec().center;
    halve(|l| from + (to - from) * l, |x| a.gamma(x) < b.gamma(x))
}

/// Out of a wall's free space along its normal at an obstacle's centre, the point where both Gammas are equal.
fn beyond_wall<S: Scalar, const D: usize>(wall: &Obstacle<S, D>, b: &Obstacle<S, D>) -> Vector<S, D> {
    let center = b.spec().center;
    let into = -wall.gradient(&center);
    let length = norm(&into);
    let direction = if length > S::zero() { into / length } else { Vector::zeros() };
    // The wall's Gamma falls on the way out.
    halve(|l| center + direction * (l * b.outer()), |x| b.gamma(x) < wall.gamma(x))
}

/// scale^2 Q diag(1/a^2) Q' of an ellipsoid, or nothing for all else.
fn ellipsoid<S: Scalar, const D: usize>(o: &Obstacle<S, D>, scale: S) -> Option<Matrix<S, D>> {
    let simple = matches!(o.spec().shape, Shape::Ellipsoid { curvature: 1, .. }) && !o.spec().wall;
    simple.then(|| {
        let q = &o.spec().rotation;
        let inverse = o.inverse_axes() * scale;
        let scaled = Matrix::<S, D>::from_fn(|i, j| q[(i, j)] * inverse[j]);
        scaled * scaled.transpose()
    })
}

/// The minimiser of max(Gamma_a, Gamma_b): x(l) = ((1-l) P_a + l P_b)^-1 ((1-l) P_a c_a + l P_b c_b), for the l in [0, 1] at which
/// both are equal.
fn between_ellipsoids<S: Scalar, const D: usize>(
    a: &Obstacle<S, D>,
    pa: &Matrix<S, D>,
    b: &Obstacle<S, D>,
    pb: &Matrix<S, D>,
) -> Vector<S, D> {
    let (ca, cb) = (a.spec().center, b.spec().center);
    let apart = cb - ca;
    let at = |l: S| {
        let (wa, wb) = (pa * (S::one() - l), pb * l);
        let right = wb * apart;
        ca + solve(wa + wb, right)
    };
    halve(at, |x| a.gamma(x) < b.gamma(x))
}

/// The point at the end of a bisection: `early` says whether l is still too small.
fn halve<S: Scalar, const D: usize>(
    at: impl Fn(S) -> Vector<S, D>,
    early: impl Fn(&Vector<S, D>) -> bool,
) -> Vector<S, D> {
    let (mut low, mut high) = (S::zero(), S::one());
    for _ in 0..HALVINGS {
        let middle = (low + high) * S::from_f64(0.5);
        if early(&at(middle)) { low = middle } else { high = middle }
    }
    at((low + high) * S::from_f64(0.5))
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
