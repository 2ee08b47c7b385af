//! A point inside several hard cores at once, if there is one.

use crate::obstacle::Obstacle;
use crate::shape::{Shape, root};
use crate::{Matrix, Scalar, Vector, norm, unit};

/// Steps of the search for a point that several cores have in common, and how much shorter each is than the one before: as deep as it gets,
const STEPS: (u8, f64) = (48, 0.9);
/// and where a point inside will do.
const STEPS_INSIDE: (u8, f64) = (24, 0.82);
/// Of those, after so many it ends where it is inside.
const STEPS_AMPLE: u8 = 12;
/// Halvings of the interval in which two ellipsoids have their common point.
const HALVINGS: u8 = 26;
/// Halvings of the way to where such a search starts.
const HALVINGS_TO_START: u8 = 8;

/// What a point that is searched for has to be inside of.
#[derive(Clone, Copy)]
pub(crate) enum Inside<'a, S: Scalar, const D: usize> {
    /// An obstacle's hard core.
    Core(&'a Obstacle<S, D>),
    /// Where an obstacle's reference point may be: of a polygon, where all of it is seen from.
    Sight(&'a Obstacle<S, D>),
}

impl<'a, S: Scalar, const D: usize> Inside<'a, S, D> {
    /// Below one inside; and where that grows, for [`Obstacle::outward`].
    fn look(&self, x: &Vector<S, D>) -> (S, Vector<S, D>) {
        match self {
            Self::Core(o) => o.look(x),
            Self::Sight(o) => o.sight(x),
        }
    }

    /// Below one inside.
    fn level(&self, x: &Vector<S, D>) -> S {
        self.look(x).0
    }

    pub fn obstacle(&self) -> &'a Obstacle<S, D> {
        match self {
            Self::Core(o) | Self::Sight(o) => o,
        }
    }
}

/// How deep inside a point is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Inside: the first point that is will do.
    Any,
    /// Well inside, if that is possible.
    Ample,
    /// As deep as the search gets.
    Deepest,
}

impl Depth {
    /// The Gamma below which no deeper point is searched.
    fn enough<S: Scalar>(self) -> S {
        match self {
            Self::Any => S::one(),
            Self::Ample => S::from_f64(0.5),
            Self::Deepest => S::zero(),
        }
    }
}

/// May these overlap, as far as balls round them say, and for what is inside a wall the corners of its box?
pub(crate) fn are_near<S: Scalar, const D: usize>(a: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    match (a.spec().wall, b.spec().wall) {
        (true, true) => false,
        (true, false) => may_reach(a, b),
        (false, true) => may_reach(b, a),
        _ => norm(&(a.spec().center - b.spec().center)) <= a.outer() + b.outer(),
    }
}

/// May an obstacle reach a wall?
fn may_reach<S: Scalar, const D: usize>(wall: &Obstacle<S, D>, b: &Obstacle<S, D>) -> bool {
    let gamma = wall.gamma(&b.spec().center);
    let inside = gamma > S::one() && !wall.is_near(gamma, b.outer());
    // Where the free space is convex it holds all that is between corners it holds.
    let convex = !matches!(wall.spec().shape, Shape::Polygon(_));
    !(inside || convex && (0..1 << D).all(|n| wall.gamma(&b.corner(n)) > S::one()))
}

/// A point inside both of two that [`are_near`], m; `None` if there is none.
pub(crate) fn between<S: Scalar, const D: usize>(
    a: Inside<'_, S, D>,
    b: Inside<'_, S, D>,
    depth: Depth,
) -> Option<Vector<S, D>> {
    let (one, other) = (a.obstacle(), b.obstacle());
    // Only the ratio of both counts, and squares of 1/axis leave some numbers' range.
    let most = |o: &Obstacle<S, D>| o.inverse_axes().iter().fold(S::zero(), |m, x| m.max(*x));
    let scale = S::one() / most(one).max(most(other));
    let (gamma, start) = match (ellipsoid(one, scale), ellipsoid(other, scale)) {
        (Some(p), Some(q)) => {
            let (gamma, point) = between_ellipsoids(one, &p, other, &q, depth);
            return (gamma < S::one()).then_some(point);
        }
        _ if one.spec().wall => beyond_wall(one, &b, depth),
        _ if other.spec().wall => beyond_wall(other, &a, depth),
        _ => on_the_way(&a, &b, depth),
    };
    let walls = one.spec().wall || other.spec().wall;
    if gamma < S::one() && (walls || depth != Depth::Deepest) {
        return Some(start);
    }
    // What sticks into a wall need not do so along the wall's normal, nor overlap on the way between the centres.
    search(&[a, b], &start, depth)
}

/// A point inside several cores, m, by bounded steps: each away from the one it is least inside of, along that one's
/// Gamma. The deepest of all it comes by, if that is inside all.
pub(crate) fn search<S: Scalar, const D: usize>(
    members: &[Inside<'_, S, D>],
    start: &Vector<S, D>,
    depth: Depth,
) -> Option<Vector<S, D>> {
    let (mut x, mut best) = (*start, (S::one(), None));
    let mut length = members.iter().fold(S::MAX, |m, o| m.min(o.obstacle().outer()));
    let (steps, shrink) = if depth == Depth::Deepest { STEPS } else { STEPS_INSIDE };
    for taken in 0..steps {
        let looks = members.iter().map(|o| (o.look(&x), o));
        let ((gamma, slope), worst) = looks.reduce(|worst, o| if o.0.0 > worst.0.0 { o } else { worst })?;
        if gamma < best.0 {
            best = (gamma, Some(x));
        }
        if gamma < depth.enough() || best.1.is_some() && depth == Depth::Ample && taken >= STEPS_AMPLE {
            break;
        }
        let (slopes, away) = unit(&worst.obstacle().outward(&slope));
        if !(slopes > S::zero()) || gamma >= S::one() && are_apart(members, worst, &x, gamma, &away) {
            break;
        }
        // A shrinking step: the maximum of convex functions has no other descent that is as simple.
        x -= away * length;
        length *= S::from_f64(shrink);
    }
    best.1
}

/// Is one of two members behind the tangent plane that the other, `one`, has on the ray from its centre to x, where
/// it has this Gamma and its slope has this direction? Never true of two that overlap.
fn are_apart<S: Scalar, const D: usize>(
    members: &[Inside<'_, S, D>],
    one: &Inside<'_, S, D>,
    x: &Vector<S, D>,
    gamma: S,
    normal: &Vector<S, D>,
) -> bool {
    let [a, b] = members else { return false };
    let other = if core::ptr::eq(a, one) { b.obstacle() } else { a.obstacle() };
    let own = one.obstacle();
    if own.spec().wall || other.spec().wall {
        return false;
    }
    let along = |v: Vector<S, D>| S::dot(v.as_slice(), normal.as_slice());
    let extent = match one {
        // It may have notches.
        Inside::Core(o) if matches!(o.spec().shape, Shape::Polygon(_)) => o.support(normal),
        // Of a Gamma so large its root is not told, or it is no number any more.
        Inside::Core(o) | Inside::Sight(o) if !(gamma < S::FAR) => o.support(normal),
        // The gauge is convex, and as steep along the whole ray.
        _ => along(x - own.spec().center) / root(gamma, own.power()),
    };
    along(other.spec().center - own.spec().center) > extent + other.support(&-normal)
}

/// The greatest of both Gammas, and where.
type Found<S, const D: usize> = (S, Vector<S, D>);

/// Between the centres, the point where both Gammas are equal.
fn on_the_way<S: Scalar, const D: usize>(a: &Inside<'_, S, D>, b: &Inside<'_, S, D>, depth: Depth) -> Found<S, D> {
    let (from, to) = (a.obstacle().spec().center, b.obstacle().spec().center);
    halve(|l| from + (to - from) * l, |x| (a.level(x), b.level(x)), HALVINGS_TO_START, depth)
}

/// Out of a wall's free space along its normal at an obstacle's centre, the point where both Gammas are equal.
fn beyond_wall<S: Scalar, const D: usize>(wall: &Obstacle<S, D>, b: &Inside<'_, S, D>, depth: Depth) -> Found<S, D> {
    let (center, outer) = (b.obstacle().spec().center, b.obstacle().outer());
    let (_, direction) = unit(&-wall.gradient(&center));
    // The wall's Gamma falls on the way out.
    halve(|l| center + direction * (l * outer), |x| (b.level(x), wall.gamma(x)), HALVINGS, depth)
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
/// both are equal. No other x(l) has both less: where both are 1 or more for any l, no point has.
fn between_ellipsoids<S: Scalar, const D: usize>(
    a: &Obstacle<S, D>,
    pa: &Matrix<S, D>,
    b: &Obstacle<S, D>,
    pb: &Matrix<S, D>,
    depth: Depth,
) -> Found<S, D> {
    let (ca, cb) = (a.spec().center, b.spec().center);
    let apart = cb - ca;
    let at = |l: S| {
        let (wa, wb) = (pa * (S::one() - l), pb * l);
        let right = wb * apart;
        ca + solve(wa + wb, right)
    };
    halve(at, |x| (a.gamma(x), b.gamma(x)), HALVINGS, depth)
}

/// Along a way on which the first of two levels grows and the second falls: the point where both are equal; or the
/// first one that is deep enough, or where both say that the whole way is outside of one.
fn halve<S: Scalar, const D: usize>(
    at: impl Fn(S) -> Vector<S, D>,
    levels: impl Fn(&Vector<S, D>) -> (S, S),
    halvings: u8,
    depth: Depth,
) -> Found<S, D> {
    let (mut low, mut high) = (S::zero(), S::one());
    let mut left = halvings;
    loop {
        let middle = (low + high) * S::from_f64(0.5);
        let x = at(middle);
        let (first, second) = levels(&x);
        let (most, least) = (first.max(second), first.min(second));
        // Of a point that need not be the deepest, a tenth more is not worth the way.
        let near = depth != Depth::Deepest && most < S::one() && least > most * S::from_f64(0.9);
        if most < depth.enough() || least >= S::one() || near || left == 0 {
            return (most, x);
        }
        left -= 1;
        if first < second { low = middle } else { high = middle }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fixed, ObstacleSpec};

    /// Needles with flat ends across a ball, looked at from as far as there are numbers.
    fn overlapping_ones_are_never_apart<S: Scalar>() {
        let vector = |x: f64, y: f64| Vector::<S, 2>::new(S::from_f64(x), S::from_f64(y));
        let mut beyond = 0;
        for curvature in [1, 3, 8] {
            let shape = Shape::Ellipsoid { axes: vector(0.002, 1.0), curvature };
            let needle = Obstacle::new(ObstacleSpec { shape, ..ObstacleSpec::default() }).unwrap();
            let ball = ObstacleSpec { shape: Shape::ellipsoid(vector(0.5, 0.5)), ..ObstacleSpec::default() };
            let ball = Obstacle::new(ObstacleSpec { center: vector(0.5003, 0.8), ..ball }).unwrap();
            let common = vector(0.0008, 0.8);
            assert!(needle.gamma(&common) < S::one() && ball.gamma(&common) < S::one());
            let members = [Inside::Core(&needle), Inside::Core(&ball)];
            for (i, distance) in (0..400).flat_map(|i| [(i, 0.05), (i, 1.0), (i, 30.0), (i, 900.0)]) {
                let angle = f64::from(i) * 0.0157;
                let x = vector(distance * angle.cos(), distance * angle.sin());
                for one in &members {
                    let (gamma, slope) = one.look(&x);
                    let (length, away) = unit(&one.obstacle().outward(&slope));
                    if gamma >= S::one() && length > S::zero() {
                        beyond += u32::from(!(gamma < S::FAR));
                        assert!(!are_apart(&members, one, &x, gamma, &away), "p = {curvature}, from {x}: {gamma}");
                    }
                }
            }
        }
        assert!(beyond > 0, "no Gamma was too large");
    }

    #[test]
    fn overlapping_ones_are_never_apart_in_any_number() {
        overlapping_ones_are_never_apart::<f64>();
        overlapping_ones_are_never_apart::<f32>();
        overlapping_ones_are_never_apart::<Fixed>();
    }
}
