//! Obstacles.

use super::{corner, finite, flat, framed, padded, round, vector, zero_in_the_plane};
use crate::message::{DeviceError, Field, Obstacle, Shape};
use pliant_core::obstacle::ObstacleError;
use pliant_core::shape::{self, Polygon};
use pliant_core::{Matrix, ObstacleSpec, Scalar, Vector, rotation};

/// An obstacle that was checked, from a [`ToDevice::Upsert`](crate::ToDevice::Upsert).
///
/// In two dimensions centre, reference point and velocity have no z, and rotation and angular velocity are about z. Of
/// semi-axes, half sides, soft ratio and margin the third is not looked at: what the plane sees of an ellipsoid on it is
/// the first two. Cylinders and capsules are of three dimensions only, polygons of two.
///
/// ```
/// use pliant_protocol::convert::obstacle;
/// use pliant_protocol::message::{DeviceError, Field, Obstacle};
///
/// let ball = Obstacle { center: [0.2, 0.21, 0.0], ..Obstacle::default() };
/// assert!(obstacle::<2>(&ball).is_ok() && obstacle::<3>(&ball).is_ok());
/// let raised = Obstacle { center: [0.2, 0.21, 0.1], ..ball.clone() };
/// assert_eq!(obstacle::<2>(&raised), Err(DeviceError::Dimension));
/// let hollow = Obstacle { soft_ratio: [0.9; 3], ..ball };
/// assert_eq!(obstacle::<3>(&hollow), Err(DeviceError::OutOfRange(Field::SoftRatio)));
/// ```
///
/// # Errors
///
/// A number is not finite, something lies in the third dimension where there are two, the shape is of the other
/// dimension, or a field is out of the range that [`ObstacleError`] states.
pub fn obstacle<const D: usize>(wire: &Obstacle) -> Result<pliant_core::Obstacle<f32, D>, DeviceError> {
    finite(&wire.center, Field::Center)?;
    finite(&wire.rotation, Field::Rotation)?;
    finite_shape(&wire.shape)?;
    finite(&wire.soft_ratio, Field::SoftRatio)?;
    finite(&wire.margin, Field::Margin)?;
    finite(&wire.reference, Field::Reference)?;
    finite(&wire.velocity, Field::Velocity)?;
    finite(&wire.angular_velocity, Field::AngularVelocity)?;
    finite(&[wire.growth], Field::Growth)?;
    let [_, x, y, _] = wire.rotation;
    let [p, q, _] = wire.angular_velocity;
    flat::<D>(&wire.center)?;
    flat::<D>(&wire.reference)?;
    flat::<D>(&wire.velocity)?;
    zero_in_the_plane::<D>([x, y, p, q])?;
    let rotation = rotation::spatial(wire.rotation).ok_or(DeviceError::OutOfRange(Field::Rotation))?;
    let spec = ObstacleSpec {
        center: vector(&wire.center),
        rotation: corner(&rotation),
        shape: shape(&wire.shape)?,
        wall: wire.wall,
        soft_ratio: vector(&wire.soft_ratio),
        margin: vector(&wire.margin),
        reference: vector(&wire.reference),
        velocity: vector(&wire.velocity),
        spin: corner(&rotation::spatial_spin(&vector(&wire.angular_velocity))),
        growth: wire.growth,
    };
    Ok(pliant_core::Obstacle::new(spec)?)
}

fn finite_shape(wire: &Shape) -> Result<(), DeviceError> {
    match wire {
        Shape::Ellipsoid { axes, .. } => finite(axes, Field::Axes),
        Shape::Box { half, rounding } => {
            finite(half, Field::Axes)?;
            finite(&[*rounding], Field::Rounding)
        }
        Shape::Cylinder { radius, half_length, rounding } => {
            finite(&[*radius, *half_length], Field::Axes)?;
            finite(&[*rounding], Field::Rounding)
        }
        Shape::Capsule { radius, half_length } => finite(&[*radius, *half_length], Field::Axes),
        Shape::Polygon { vertices } => finite(vertices.as_flattened(), Field::Vertices),
    }
}

/// The shape in the core's words; all but the number of corners is checked there.
fn shape<const D: usize>(wire: &Shape) -> Result<shape::Shape<f32, D>, DeviceError> {
    Ok(match wire {
        Shape::Ellipsoid { axes, curvature } => shape::Shape::Ellipsoid { axes: vector(axes), curvature: *curvature },
        Shape::Box { half, rounding } => shape::Shape::Box { half: vector(half), rounding: *rounding },
        Shape::Cylinder { radius, half_length, rounding } => {
            shape::Shape::Cylinder { radius: *radius, half_length: *half_length, rounding: *rounding }
        }
        Shape::Capsule { radius, half_length } => shape::Shape::Capsule { radius: *radius, half_length: *half_length },
        // Before its corners are counted: in space there is no number of them that would do.
        Shape::Polygon { .. } if D == 3 => return Err(DeviceError::Dimension),
        Shape::Polygon { vertices } => shape::Shape::Polygon(Polygon::new(vertices)?),
    })
}

impl From<ObstacleError> for DeviceError {
    fn from(error: ObstacleError) -> Self {
        Self::OutOfRange(match error {
            ObstacleError::Dimension => return Self::Dimension,
            ObstacleError::Center => Field::Center,
            ObstacleError::Rotation => Field::Rotation,
            ObstacleError::Axes => Field::Axes,
            ObstacleError::SoftRatio => Field::SoftRatio,
            ObstacleError::Margin => Field::Margin,
            ObstacleError::Curvature => Field::Curvature,
            ObstacleError::Reference => Field::Reference,
            ObstacleError::Velocity => Field::Velocity,
            ObstacleError::Spin => Field::AngularVelocity,
            ObstacleError::Rounding => Field::Rounding,
            ObstacleError::Corners | ObstacleError::Vertices => Field::Vertices,
            ObstacleError::Growth => Field::Growth,
        })
    }
}

/// Of two or three dimensions, and so is the obstacle that comes back from it.
impl<S: Scalar, const D: usize> From<&ObstacleSpec<S, D>> for Obstacle {
    fn from(core: &ObstacleSpec<S, D>) -> Self {
        let spin = framed(&core.spin);
        let mut rotation = framed(&core.rotation);
        if D == 2 {
            rotation[(2, 2)] = 1.0;
        }
        Self {
            center: padded(&core.center),
            rotation: quaternion(&rotation),
            shape: Shape::from(&core.shape),
            wall: core.wall,
            soft_ratio: padded(&core.soft_ratio),
            margin: padded(&core.margin),
            reference: padded(&core.reference),
            velocity: padded(&core.velocity),
            angular_velocity: padded(&Vector::<f64, 3>::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)])),
            growth: round(core.growth),
        }
    }
}

impl<S: Scalar, const D: usize> From<&shape::Shape<S, D>> for Shape {
    fn from(core: &shape::Shape<S, D>) -> Self {
        match core {
            shape::Shape::Ellipsoid { axes, curvature } => {
                Self::Ellipsoid { axes: padded(axes), curvature: *curvature }
            }
            shape::Shape::Box { half, rounding } => Self::Box { half: padded(half), rounding: round(*rounding) },
            shape::Shape::Cylinder { radius, half_length, rounding } => {
                Self::Cylinder { radius: round(*radius), half_length: round(*half_length), rounding: round(*rounding) }
            }
            shape::Shape::Capsule { radius, half_length } => {
                Self::Capsule { radius: round(*radius), half_length: round(*half_length) }
            }
            shape::Shape::Polygon(polygon) => {
                // No more of them than fit: both sides have the same bound.
                Self::Polygon { vertices: polygon.vertices().iter().map(|v| v.map(round)).collect() }
            }
        }
    }
}

impl Default for Obstacle {
    fn default() -> Self {
        Self::from(&ObstacleSpec::<f32, 3>::default())
    }
}

/// The unit quaternion w, x, y, z of a rotation, with w >= 0.
///
/// This is Shepperd's method: the largest of the four is found first, so that no division is by a small number.
fn quaternion(m: &Matrix<f64, 3>) -> [f32; 4] {
    let (xx, yy, zz) = (m[(0, 0)], m[(1, 1)], m[(2, 2)]);
    let (x, y, z) = (m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]);
    let (xy, yz, zx) = (m[(1, 0)] + m[(0, 1)], m[(2, 1)] + m[(1, 2)], m[(0, 2)] + m[(2, 0)]);
    let trace = xx + yy + zz;
    // Each is 4 times its own largest element times (w, x, y, z).
    let scaled = if trace >= xx && trace >= yy && trace >= zz {
        [1.0 + trace, x, y, z]
    } else if xx >= yy && xx >= zz {
        [x, 1.0 + xx - yy - zz, xy, zx]
    } else if yy >= zz {
        [y, xy, 1.0 + yy - xx - zz, yz]
    } else {
        [z, zx, yz, 1.0 + zz - xx - yy]
    };
    let length = Scalar::sqrt(scaled.iter().fold(0.0, |sum, q| sum + q * q));
    let length = if scaled[0] < 0.0 { -length } else { length };
    scaled.map(|q| (q / length) as f32)
}
