//! The shapes a hard core may have, and the one small trait through which the method sees them.
//!
//! A shape lives in its own frame, about the origin, and is star-shaped there: each ray from the origin meets its
//! surface once, at a distance R. The method looks at it through scaled coordinates u (one factor an axis: safety
//! factors, soft layers, growth), in which
//!
//! ```text
//! gamma(u) = (|u| / R(u))^2p          below 1 inside, 1 on the surface, above 1 outside
//! ```
//!
//! with p = 1 for all but the superellipsoid: dimensionless, homogeneous of degree 2p. lambda = |u|/R(u) is the
//! gauge. Turned inside out, as a wall, the same shape has 1/gamma. Unscaled, for q in the shape's frame (m):
//!
//! | shape | gauge |
//! |---|---|
//! | [ellipsoid](Shape::Ellipsoid), semi-axes a_i | lambda^2p = sum_i abs(q_i/a_i)^2p |
//! | [box](Shape::Box), [cylinder](Shape::Cylinder), [capsule](Shape::Capsule) | sum_i max(t_i - lambda h_i, 0)^2 = (lambda R)^2 |
//! | [polygon](Shape::Polygon), edge from v to w | lambda = a + b where q = a v + b w, a, b >= 0 |
//!
//! with R the radius of edges, h the half extents less R, and t_i = abs(q_i), of cylinder and capsule t = (abs((q_1,
//! q_2)), abs(q_3)). The first is of Khansari-Zadeh & Billard (2012), star shapes by R(u) of Huber, Billard & Slotine
//! (2019).
//!
//! An [`Obstacle`](crate::Obstacle) checks its shape; every length is in m, from [`Scalar::MIN_AXIS`] to 1000 m,
//! where nothing else is said.

mod polygon;
mod rounded;
mod superellipsoid;

#[cfg(test)]
mod tests;

pub use polygon::{MAX_VERTICES, Polygon};

use crate::{ObstacleError, RANGE, Scalar, Vector};
pub(crate) use polygon::{Pieces, SIGHT};
use rounded::Rounded;
use superellipsoid::Superellipsoid;
pub(crate) use superellipsoid::root;

/// Largest curvature exponent p.
pub const MAX_CURVATURE: u8 = 8;

/// The shape of a hard core, in its own frame about the origin; lengths in metres.
///
/// ```
/// use pliant_core::nalgebra::{Vector2, Vector3};
/// use pliant_core::{Obstacle, ObstacleError, ObstacleSpec, Shape};
/// let pallet = Shape::Box { half: Vector2::new(0.6, 0.4), rounding: 0.02 };
/// let pallet = Obstacle::new(ObstacleSpec { shape: pallet, ..ObstacleSpec::default() }).unwrap();
/// assert!((pallet.gamma(&Vector2::new(0.9_f64, 0.0)) - 1.5_f64.powi(2)).abs() < 1e-12); // (|q|/R)^2
/// let thick = Shape::Cylinder { radius: 0.1_f64, half_length: 0.2, rounding: 0.15 };
/// let thick = ObstacleSpec::<f64, 3> { shape: thick, ..ObstacleSpec::default() };
/// assert_eq!(Obstacle::new(thick).unwrap_err(), ObstacleError::Rounding);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<S: Scalar, const D: usize> {
    /// sum_i |q_i / a_i|^2p = 1: an ellipsoid for p = 1, nearly a box for p = [`MAX_CURVATURE`].
    Ellipsoid {
        /// a, the D semi-axes.
        axes: Vector<S, D>,
        /// p, the curvature exponent: a whole number from 1 to [`MAX_CURVATURE`].
        curvature: u8,
    },
    /// A box whose edges and corners are rounded; with a rounding of half the shorter side, a stadium.
    Box {
        /// Half of each of the D sides, rounded edges included.
        half: Vector<S, D>,
        /// Radius of the edges, at most the least half side.
        rounding: S,
    },
    /// A cylinder about the third axis whose rims are rounded. Only in 3-D.
    Cylinder {
        /// Radius.
        radius: S,
        /// Half of its length, rounded rims included.
        half_length: S,
        /// Radius of the rims, at most the radius and half the length.
        rounding: S,
    },
    /// A segment of the third axis with everything within `radius` of it. Only in 3-D.
    Capsule {
        /// Radius.
        radius: S,
        /// Half of the segment's length, from 0; the capsule is `radius` longer on both sides.
        half_length: S,
    },
    /// A polygon, star-shaped about the origin: once round it, counter-clockwise, seen whole from there. Only in 2-D.
    Polygon(Polygon<S>),
}

/// What the method asks of a shape: Gamma, its gradient, and half-spaces that keep a point out (or in).
pub(crate) trait Surface<S: Scalar, const D: usize> {
    /// gamma(u), and the direction of its gradient, of a length that neither overflows nor underflows; zero at the origin.
    fn level(&self, u: &Vector<S, D>) -> (S, Vector<S, D>);

    /// Calls `keep(n, slack)` for half-spaces of displacements delta, in the shape's own frame, such that a point whose displacement
    /// fulfils n.delta >= -slack for all of them is outside the body (as a wall: inside) wherever it goes within `at.step`.
    fn keep_out(&self, at: &Place<'_, S, D>, keep: impl FnMut(Vector<S, D>, S));
}

/// A point that is to be kept out, and the scale of the shape it is to be kept out of.
pub(crate) struct Place<'a, S: Scalar, const D: usize> {
    /// u, scaled coordinates.
    pub u: Vector<S, D>,
    /// u_i / q_i, dimensionless or 1/m.
    pub inverse: &'a Vector<S, D>,
    /// Is the shape a wall, to be kept inside of?
    pub wall: bool,
    /// The displacement that is wished for, in scaled coordinates: where there is a choice of half-spaces, one that leaves room for it.
    pub wish: Vector<S, D>,
    /// No displacement is longer, m.
    pub step: S,
    /// Surfaces farther than this need no half-space, m.
    pub reach: S,
    /// The share of the distance that the displacement may use up.
    pub share: S,
}

impl<S: Scalar, const D: usize> Shape<S, D> {
    /// An ellipsoid, p = 1, with these semi-axes, m; see [`Shape::Ellipsoid`].
    pub fn ellipsoid(axes: Vector<S, D>) -> Self {
        Self::Ellipsoid { axes, curvature: 1 }
    }

    /// Checks every length.
    pub(crate) fn check(&self) -> Result<(), ObstacleError> {
        let length = |x: S| x >= S::MIN_AXIS && x <= S::from_f64(RANGE);
        let check = |ok: bool, error: ObstacleError| if ok { Ok(()) } else { Err(error) };
        match self {
            Self::Ellipsoid { axes, curvature } => {
                check(axes.iter().all(|a| length(*a)), ObstacleError::Axes)?;
                check((1..=MAX_CURVATURE).contains(curvature), ObstacleError::Curvature)
            }
            Self::Box { half, rounding } => {
                check(half.iter().all(|a| length(*a)), ObstacleError::Axes)?;
                check(length(*rounding) && half.iter().all(|a| rounding <= a), ObstacleError::Rounding)
            }
            Self::Cylinder { radius, half_length, rounding } => {
                check(D == 3, ObstacleError::Dimension)?;
                check(length(*radius) && length(*half_length), ObstacleError::Axes)?;
                check(length(*rounding) && rounding <= radius && rounding <= half_length, ObstacleError::Rounding)
            }
            Self::Capsule { radius, half_length } => {
                check(D == 3, ObstacleError::Dimension)?;
                let bound = S::from_f64(RANGE);
                check(length(*radius) && *half_length >= S::zero() && *half_length <= bound, ObstacleError::Axes)
            }
            Self::Polygon(polygon) => {
                check(D == 2, ObstacleError::Dimension)?;
                polygon.check()
            }
        }
    }

    /// Half of the shape's extent along each axis of its frame, m; of a polygon the largest |coordinate|.
    pub fn extent(&self) -> Vector<S, D> {
        match self {
            Self::Ellipsoid { axes, .. } => *axes,
            Self::Box { half, .. } => *half,
            Self::Cylinder { radius, half_length, .. } => {
                Vector::from_fn(|i, _| if i < 2 { *radius } else { *half_length })
            }
            Self::Capsule { radius, half_length } => {
                Vector::from_fn(|i, _| if i < 2 { *radius } else { *half_length + *radius })
            }
            Self::Polygon(polygon) => {
                let [x, y] = polygon.extent();
                Vector::from_fn(|i, _| if i == 0 { x } else { y })
            }
        }
    }

    /// What growth is measured by, m: an extent that becomes longer by a metre makes its axis so much longer in
    /// proportion. Scaled by one factor an axis, a polygon would uncover parts of itself, so it has one for both: the
    /// distance of the nearest edge, and no edge moves less.
    pub(crate) fn growing_extent(&self) -> Vector<S, D> {
        match self {
            Self::Polygon(polygon) => {
                let (scaled, longest) = polygon.scaled();
                Vector::from_element(scaled.inner() * longest)
            }
            _ => self.extent(),
        }
    }

    /// The most the surface moves along its normal where every growing extent becomes a metre longer, m: sum_i |n_i y_i| / e_i.
    pub(crate) fn growing_most(&self) -> S {
        match self {
            Self::Ellipsoid { curvature: 1, .. } => S::one(),
            Self::Polygon(_) => self.outer() / self.growing_extent()[0],
            _ => S::from_f64(if D == 2 { core::f64::consts::SQRT_2 } else { 1.732_050_807_568_877_2 }),
        }
    }

    /// And the least.
    pub(crate) fn growing_least(&self) -> S {
        let extent = self.growing_extent();
        let least = extent.iter().fold(S::MAX, |m, x| m.min(*x));
        let most = extent.iter().fold(S::zero(), |m, x| m.max(*x));
        least / most
    }

    /// An r for which all of the shape lies in |q| <= r, m.
    pub(crate) fn outer(&self) -> S {
        crate::norm(&self.extent())
    }

    /// The body of this shape (is it a wall?), and the lengths at which its scaled coordinates are one, m.
    pub(crate) fn body(&self, wall: bool) -> (Body<S, D>, Vector<S, D>) {
        let longest = self.extent().iter().fold(S::zero(), |m, a| m.max(*a));
        let one = |x: S| x / longest;
        let rounded = match self {
            Self::Ellipsoid { axes, curvature } => {
                return (Body::Superellipsoid(Superellipsoid { p: *curvature }), *axes);
            }
            Self::Polygon(polygon) => {
                let scaled = polygon.scaled().0;
                let body = Body::Polygon { scale: scaled.scale(), pieces: scaled.pieces(wall) };
                return (body, Vector::from_element(longest));
            }
            Self::Box { half, rounding } => Rounded::rounded_box(&half.map(one), one(*rounding)),
            Self::Cylinder { radius, half_length, rounding } => {
                Rounded::cylinder(one(*radius), one(*half_length), one(*rounding))
            }
            Self::Capsule { radius, half_length } => Rounded::capsule(one(*radius), one(*half_length)),
        };
        (Body::Rounded(rounded), Vector::from_element(longest))
    }
}

/// A shape made ready for scaled coordinates: those of an ellipsoid are in semi-axes, of all else in the longest semi-extent (a
/// polygon's corners stay where they are, in the [`Shape`]).
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Body<S: Scalar, const D: usize> {
    Superellipsoid(Superellipsoid),
    Rounded(Rounded<S, D>),
    Polygon { scale: S, pieces: Pieces },
}

impl<S: Scalar, const D: usize> Body<S, D> {
    /// p: gamma is the gauge to the power of 2p.
    pub fn power(&self) -> u8 {
        match self {
            Self::Superellipsoid(body) => body.p,
            _ => 1,
        }
    }

    /// At most 1 where the whole surface is seen from, so that a reference point may be there: gamma, but of a
    /// polygon. And the direction in which it grows.
    pub fn sight(&self, shape: &Shape<S, D>, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        match (self, shape) {
            (Self::Polygon { scale, .. }, Shape::Polygon(polygon)) => polygon.at_scale(*scale).sight(u),
            _ => self.level(shape, u),
        }
    }

    /// The largest r for which |u| <= r lies inside; and the gauge |u|/R(u) changes by no more than |du|/r.
    pub fn inner(&self, shape: &Shape<S, D>) -> S {
        match (self, shape) {
            (Self::Rounded(body), _) => body.inner(),
            (Self::Polygon { scale, .. }, Shape::Polygon(polygon)) => polygon.at_scale(*scale).inner(),
            _ => S::one(),
        }
    }

    /// Is gamma = |u|^2?
    pub fn is_ellipsoid(&self) -> bool {
        matches!(self, Self::Superellipsoid(Superellipsoid { p: 1 }))
    }

    /// gamma(u), and the direction of its gradient.
    #[inline(always)]
    pub fn level(&self, shape: &Shape<S, D>, u: &Vector<S, D>) -> (S, Vector<S, D>) {
        match (self, shape) {
            (Self::Superellipsoid(body), _) => body.level(u),
            (Self::Rounded(body), _) => body.level(u),
            (Self::Polygon { scale, pieces }, Shape::Polygon(polygon)) => polygon.in_pieces(*scale, pieces).level(u),
            _ => (S::zero(), Vector::zeros()),
        }
    }

    /// Of all u inside the one with the largest w.u.
    pub fn farthest(&self, shape: &Shape<S, D>, w: &Vector<S, D>) -> Vector<S, D> {
        match (self, shape) {
            (Self::Superellipsoid(body), _) => body.farthest(w),
            (Self::Rounded(body), _) => body.farthest(w),
            (Self::Polygon { scale, .. }, Shape::Polygon(polygon)) => polygon.at_scale(*scale).farthest(w),
            _ => Vector::zeros(),
        }
    }

    /// A polygon's convex pieces, of a wall those of what is outside.
    pub fn pieces(&self) -> Option<&Pieces> {
        if let Self::Polygon { pieces, .. } = self { Some(pieces) } else { None }
    }

    /// Of a polygon, how far u is from it, or of a wall, from what is outside.
    pub fn distance(&self, shape: &Shape<S, D>, u: &Vector<S, D>) -> Option<S> {
        match (self, shape) {
            (Self::Polygon { scale, .. }, Shape::Polygon(polygon)) => Some(polygon.at_scale(*scale).distance(u)),
            _ => None,
        }
    }

    /// Half-spaces that keep a point out of the body, or inside it as a wall; see [`Surface::keep_out`].
    pub fn keep_out(&self, shape: &Shape<S, D>, at: &Place<'_, S, D>, keep: impl FnMut(Vector<S, D>, S)) {
        match (self, shape) {
            (Self::Superellipsoid(body), _) => body.keep_out(at, keep),
            (Self::Rounded(body), _) => body.keep_out(at, keep),
            (Self::Polygon { scale, pieces }, Shape::Polygon(polygon)) => {
                polygon.in_pieces(*scale, pieces).keep_out(at, keep);
            }
            _ => {}
        }
    }
}

/// Points into a body's half-spaces at its very centre, where it has no gradient: out along the first axis.
fn first_axis<S: Scalar, const D: usize>(length: S) -> Vector<S, D> {
    Vector::from_fn(|i, _| if i == 0 { length } else { S::zero() })
}
