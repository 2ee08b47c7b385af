//! What is in the way.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most corners of a [`Shape::Polygon`].
pub const VERTICES_MAX: usize = pliant_core::shape::MAX_VERTICES;

/// A hard core, perhaps with a soft layer; or a wall around a free space.
///
/// In two dimensions it lies in the plane: see [`convert::obstacle`](crate::convert::obstacle()).
///
/// The default is that of `pliant_core`: a rigid ball of 5 cm radius at the origin, at rest.
///
/// ```
/// use pliant_protocol::message::{Obstacle, Shape};
///
/// // A hard core of 4 cm in a layer of foam that is 2 cm thick.
/// let foam = Obstacle { shape: Shape::ellipsoid([0.04; 3]), soft_ratio: [1.5; 3], ..Obstacle::default() };
/// # assert_eq!(foam.rotation, [1.0, 0.0, 0.0, 0.0]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Obstacle {
    /// Centre: where the shape's frame has its origin, in m.
    pub center: [f32; 3],
    /// Rotation from the obstacle's frame to the world's: a unit quaternion w, x, y, z.
    pub rotation: [f32; 4],
    /// The hard core, in the obstacle's frame.
    pub shape: Shape,
    /// Turned inside out: the shape is the free space, what is around it a wall.
    pub wall: bool,
    /// The soft layer's surface, as multiples of the hard one along each axis (dimensionless, at least 1; 1 is rigid).
    pub soft_ratio: [f32; 3],
    /// Safety factors along each axis (dimensionless, at least 1).
    pub margin: [f32; 3],
    /// Reference point in the obstacle's frame, inside the core (of a wall, inside the free space), in m.
    pub reference: [f32; 3],
    /// Velocity of the centre, in m/s.
    pub velocity: [f32; 3],
    /// Angular velocity in the world's frame, in rad/s.
    pub angular_velocity: [f32; 3],
    /// How fast each semi-extent becomes longer (below zero: shorter), in m/s.
    pub growth: f32,
}

/// The shape of a hard core, in its own frame.
///
/// Cylinders and capsules are for three dimensions, polygons for two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Shape {
    /// sum_i |q_i / axes_i|^2p = 1.
    Ellipsoid {
        /// Semi-axes, in m.
        axes: [f32; 3],
        /// Curvature exponent p: 1 an ellipsoid, larger ever more of a box (dimensionless).
        curvature: u8,
    },
    /// A box whose edges are rounded.
    Box {
        /// Half of each side, in m.
        half: [f32; 3],
        /// Radius of the edges, at most the least half side, in m.
        rounding: f32,
    },
    /// A cylinder about the third axis whose rims are rounded.
    Cylinder {
        /// Radius, in m.
        radius: f32,
        /// Half of its length, in m.
        half_length: f32,
        /// Radius of the rims, at most the radius and half the length, in m.
        rounding: f32,
    },
    /// A segment of the third axis with everything within `radius` of it.
    Capsule {
        /// Radius, in m.
        radius: f32,
        /// Half of the segment's length, in m; the capsule is `radius` longer on both sides.
        half_length: f32,
    },
    /// A polygon that is seen whole from the frame's origin.
    Polygon {
        /// Corners, counter-clockwise, in m; at least three.
        vertices: Vec<[f32; 2], VERTICES_MAX>,
    },
}

impl Shape {
    /// An ellipsoid with these semi-axes, in m.
    pub const fn ellipsoid(axes: [f32; 3]) -> Self {
        Self::Ellipsoid { axes, curvature: 1 }
    }
}
