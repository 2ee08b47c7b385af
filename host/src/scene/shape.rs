//! What an obstacle's hard core looks like.

use nalgebra::Vector3;
use pliant_core::shape::{self, Polygon};
use pliant_core::{ObstacleError, Scalar};

use super::convert::vector;

/// The least length the core takes, m.
pub(super) const LEAST: f64 = <f64 as Scalar>::MIN_AXIS;

/// A hard core in its own frame, lengths in m. In two dimensions the third of three numbers is zero.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// An ellipsoid, or with a curvature p above 1 nearly a box.
    Ellipsoid {
        /// Hard semi-axes.
        axes: Vector3<f64>,
        /// p
        curvature: u8,
    },
    /// A box with rounded edges.
    Box {
        /// Half of each side.
        half: Vector3<f64>,
        /// Radius of the edges.
        rounding: f64,
    },
    /// A cylinder about the third axis; only in 3-D.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half of its length.
        half_length: f64,
        /// Radius of the rims.
        rounding: f64,
    },
    /// A segment of the third axis with everything within a radius of it; only in 3-D.
    Capsule {
        /// Radius.
        radius: f64,
        /// Half of the segment's length.
        half_length: f64,
    },
    /// A polygon that is seen whole from the origin; only in 2-D.
    Polygon {
        /// Corners, counter-clockwise.
        vertices: Vec<[f64; 2]>,
    },
}

impl Shape {
    /// Half of the extent along each axis, m.
    pub fn extent(&self) -> Vector3<f64> {
        match self {
            Self::Ellipsoid { axes, .. } => *axes,
            Self::Box { half, .. } => *half,
            Self::Cylinder { radius, half_length, .. } => Vector3::new(*radius, *radius, *half_length),
            Self::Capsule { radius, half_length } => Vector3::new(*radius, *radius, half_length + radius),
            Self::Polygon { vertices } => vertices.iter().fold(Vector3::zeros(), |most: Vector3<f64>, [x, y]| {
                Vector3::new(most.x.max(x.abs()), most.y.max(y.abs()), 0.0)
            }),
        }
    }

    /// What growth is measured by, m: half of the extent along each axis; of a polygon, which is scaled by one factor, for both axes how far the
    /// line of its nearest edge is from the origin, so that no edge moves less.
    pub(super) fn measure(&self) -> Vector3<f64> {
        match self {
            Self::Polygon { vertices } => {
                let nearest = edges(vertices).map(|(from, to)| distance(from, to)).fold(f64::INFINITY, f64::min);
                Vector3::new(nearest, nearest, 0.0)
            }
            _ => self.extent(),
        }
    }

    /// What a layer is measured by, m: half of the extent along each axis; of a polygon, for both axes how far its boundary is from the origin
    /// where it is nearest. An edge's line would not do: one that passes near the origin, as a notch's may, would make the layer many times as
    /// thick everywhere else.
    pub(super) fn layered(&self) -> Vector3<f64> {
        match self {
            Self::Polygon { vertices } => {
                let nearest = edges(vertices).map(|(from, to)| apart(from, to)).fold(f64::INFINITY, f64::min);
                Vector3::new(nearest, nearest, 0.0)
            }
            _ => self.extent(),
        }
    }

    /// The least of what [growth](Self::measure) is measured by, m.
    pub(super) fn least(&self) -> f64 {
        self.measure().iter().copied().filter(|a| *a > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// The smallest value that [`grown`](Self::grown) may be given, m: something of the core is left.
    pub(super) fn smallest(&self) -> f64 {
        (LEAST * 1.001 - self.least()).min(0.0)
    }

    /// With every half extent longer by this, m (below zero: shorter); a polygon is scaled so that its nearest edge moves as far.
    ///
    /// What a device extrapolates from one sighting to the next is never smaller than this. So rounded edges grow with what they round, as
    /// they would if the surface moved along its normal, and keep their radius where it shrinks.
    pub(super) fn grown(&self, by: f64) -> Self {
        if by == 0.0 {
            return self.clone();
        }
        let longer = |v: &Vector3<f64>| v.map(|a| if a > 0.0 { a + by } else { 0.0 });
        let round = |rounding: f64| (rounding + by.max(0.0)).min(self.least() + by);
        match self {
            Self::Ellipsoid { axes, curvature } => Self::Ellipsoid { axes: longer(axes), curvature: *curvature },
            Self::Box { half, rounding } => Self::Box { half: longer(half), rounding: round(*rounding) },
            Self::Cylinder { radius, half_length, rounding } => {
                Self::Cylinder { radius: radius + by, half_length: half_length + by, rounding: round(*rounding) }
            }
            Self::Capsule { radius, half_length } => Self::Capsule { radius: radius + by, half_length: *half_length },
            Self::Polygon { vertices } => {
                let size = 1.0 + by / self.least();
                Self::Polygon { vertices: vertices.iter().map(|v| v.map(|x| x * size)).collect() }
            }
        }
    }

    /// The core's shape.
    ///
    /// # Errors
    ///
    /// [`ObstacleError::Corners`] where a polygon has too few or too many, which no checked scene has.
    pub(super) fn to_core<S: Scalar, const D: usize>(&self) -> Result<shape::Shape<S, D>, ObstacleError> {
        let number = S::from_f64;
        Ok(match self {
            Self::Ellipsoid { axes, curvature } => {
                shape::Shape::Ellipsoid { axes: vector(axes), curvature: *curvature }
            }
            Self::Box { half, rounding } => shape::Shape::Box { half: vector(half), rounding: number(*rounding) },
            Self::Cylinder { radius, half_length, rounding } => shape::Shape::Cylinder {
                radius: number(*radius),
                half_length: number(*half_length),
                rounding: number(*rounding),
            },
            Self::Capsule { radius, half_length } => {
                shape::Shape::Capsule { radius: number(*radius), half_length: number(*half_length) }
            }
            Self::Polygon { vertices } => {
                let vertices: Vec<[S; 2]> = vertices.iter().map(|v| v.map(number)).collect();
                shape::Shape::Polygon(Polygon::new(&vertices)?)
            }
        })
    }

    /// What a scene file calls it.
    pub(super) fn key(&self) -> &'static str {
        match self {
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Polygon { .. } => "polygon",
        }
    }
}

/// The edges of a polygon, each from corner to corner.
pub(super) fn edges(vertices: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let ends = vertices.iter().skip(1).chain(vertices.iter().take(1));
    vertices.iter().copied().zip(ends.copied())
}

/// Twice the area of the triangle of an edge and the origin: above zero if the edge goes counter-clockwise round it.
pub(super) fn turn([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    ax * by - ay * bx
}

/// How far an edge, from corner to corner, is from the origin.
fn apart([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let (ex, ey) = (bx - ax, by - ay);
    let along = (-(ax * ex + ay * ey) / (ex * ex + ey * ey)).clamp(0.0, 1.0);
    (ax + along * ex).hypot(ay + along * ey)
}

/// How far an edge's line passes from the origin; below zero on the wrong side.
pub(super) fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    if length > 0.0 { turn(from, to) / length } else { 0.0 }
}
