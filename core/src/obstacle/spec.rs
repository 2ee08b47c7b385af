//! What an obstacle is made from.

use crate::shape::Shape;
use crate::{Matrix, Scalar, Vector, in_range, rotation};

/// Largest linear (m/s) and angular (rad/s) speed of an obstacle.
pub const MAX_SPEED: f64 = 100.0;
/// Smallest semi-axis in floating point, m; see [`Scalar::MIN_AXIS`].
pub const MIN_AXIS: f64 = 1e-4;
/// Largest soft ratio and largest safety factor.
pub const MAX_RATIO: f64 = 100.0;

/// What an obstacle is made from; [`Obstacle::new`](crate::Obstacle::new) checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSpec<S: Scalar, const D: usize> {
    /// c, m: each coordinate within +-1000 m.
    pub center: Vector<S, D>,
    /// Q, D x D, from the obstacle's frame to the world's: x = c + Q q. Orthonormal to 1e-3, right-handed; see
    /// [`rotation`].
    pub rotation: Matrix<S, D>,
    /// The hard core, in the obstacle's frame, without safety factors.
    pub shape: Shape<S, D>,
    /// Turned inside out: the shape is the free space, what is around it a wall.
    pub wall: bool,
    /// rho >= 1 along each axis of the frame: the soft layer's surface is the core's, this much larger (of a wall,
    /// smaller); 1 is rigid. From 1 to [`MAX_RATIO`]; of a polygon the same along both axes. For one stiffness k of
    /// Chen et al.: rho = ln k + 1.
    pub soft_ratio: Vector<S, D>,
    /// eta >= 1, the safety factor along each axis of the frame: the hard core's surface is the shape's, this much
    /// larger (of a wall, smaller). From 1 to [`MAX_RATIO`]; of a polygon the same along both axes.
    pub margin: Vector<S, D>,
    /// r0, the reference point in the obstacle's frame, m: strictly inside the shape as given (of a wall, inside the
    /// free space), and where all of a polygon is seen from.
    pub reference: Vector<S, D>,
    /// v, of the centre, m/s, in the world's frame: each entry within +-[`MAX_SPEED`].
    pub velocity: Vector<S, D>,
    /// w, the angular velocity as a skew D x D matrix in the world's frame, rad/s: each entry within +-[`MAX_SPEED`];
    /// see [`rotation::planar_spin`] and [`rotation::spatial_spin`].
    pub spin: Matrix<S, D>,
    /// How fast each semi-extent becomes longer (below zero: shorter), m/s, within +-[`MAX_SPEED`]. The soft layer
    /// grows with the core.
    pub growth: S,
}

impl<S: Scalar, const D: usize> Default for ObstacleSpec<S, D> {
    /// A rigid ball of 5 cm radius at the origin, at rest.
    fn default() -> Self {
        let ones = Vector::<S, D>::from_element(S::one());
        Self {
            center: Vector::zeros(),
            rotation: Matrix::identity(),
            shape: Shape::ellipsoid(ones * S::from_f64(0.05)),
            wall: false,
            soft_ratio: ones,
            margin: ones,
            reference: Vector::zeros(),
            velocity: Vector::zeros(),
            spin: Matrix::zeros(),
            growth: S::zero(),
        }
    }
}

/// The field for which a specification is refused. Not-a-number is out of every range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObstacleError {
    /// Not finite, or beyond +-1000 m.
    Center,
    /// Not a rotation (orthonormal to 1e-3, right-handed).
    Rotation,
    /// A shape of the other dimension: polygons are for the plane, cylinders and capsules for space.
    Dimension,
    /// A semi-axis, half side, radius or length is not between [`Scalar::MIN_AXIS`] and 1000 m.
    Axes,
    /// p is not between 1 and [`MAX_CURVATURE`](crate::shape::MAX_CURVATURE).
    Curvature,
    /// The radius of edges is below [`Scalar::MIN_AXIS`] or larger than the body has room for.
    Rounding,
    /// A polygon with fewer than three corners, or more than [`MAX_VERTICES`](crate::shape::MAX_VERTICES).
    Corners,
    /// Not a polygon once round its origin, counter-clockwise and seen whole from there.
    Vertices,
    /// Not between 1 and 100, or not the same along both axes of a polygon.
    SoftRatio,
    /// Not between 1 and 100, or not the same along both axes of a polygon.
    Margin,
    /// Gamma of the shape as given is not below 1 there, or from there the polygon is not seen whole.
    Reference,
    /// Not finite, or beyond [`MAX_SPEED`].
    Velocity,
    /// Not skew, not finite, or beyond [`MAX_SPEED`].
    Spin,
    /// Not finite, or beyond [`MAX_SPEED`].
    Growth,
}

impl core::fmt::Display for ObstacleError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Center => "center is not finite, or beyond +-1000 m",
            Self::Rotation => "rotation is not a right-handed rotation matrix, orthonormal to 1e-3",
            Self::Dimension => {
                "shape is of the other dimension: polygons are for the plane, cylinders and capsules for space"
            }
            Self::Axes => "shape has a length that is not from 0.1 mm (in fixed point 2 mm) to 1000 m",
            Self::Curvature => "shape has a curvature that is not from 1 to 8",
            Self::Rounding => {
                "shape has a rounding below 0.1 mm (in fixed point 2 mm), or larger than the body has room for"
            }
            Self::Corners => "shape is a polygon that has not 3 to 12 corners",
            Self::Vertices => {
                "shape is not a polygon once round its origin, counter-clockwise and seen whole from there"
            }
            Self::SoftRatio => "soft_ratio is not from 1 to 100, or of a polygon not the same along both axes",
            Self::Margin => "margin is not from 1 to 100, or of a polygon not the same along both axes",
            Self::Reference => "reference is not inside the shape as given, or does not see the whole of the polygon",
            Self::Velocity => "velocity is not finite, or beyond +-100 m/s",
            Self::Spin => "spin is not skew, not finite, or beyond +-100 rad/s",
            Self::Growth => "growth is not finite, or beyond +-100 m/s",
        })
    }
}

impl core::error::Error for ObstacleError {}

impl<S: Scalar, const D: usize> ObstacleSpec<S, D> {
    /// Checks every field but the reference point, which needs the body.
    pub(super) fn check(&self) -> Result<(), ObstacleError> {
        let check = |ok: bool, error: ObstacleError| if ok { Ok(()) } else { Err(error) };
        let ratio = |v: &Vector<S, D>| v.iter().all(|x| *x >= S::one() && *x <= S::from_f64(MAX_RATIO));
        let max_speed = S::from_f64(MAX_SPEED);
        check(in_range(&self.center), ObstacleError::Center)?;
        check(rotation::is_rotation(&self.rotation), ObstacleError::Rotation)?;
        self.shape.check()?;
        // A factor an axis would uncover parts of a polygon.
        let near = |x: S, y: S| (x - y).abs() <= S::from_f64(1e-4) * y;
        let one = |v: &Vector<S, D>| !matches!(self.shape, Shape::Polygon(_)) || v.iter().all(|x| near(*x, v[0]));
        check(ratio(&self.soft_ratio) && one(&self.soft_ratio), ObstacleError::SoftRatio)?;
        check(ratio(&self.margin) && one(&self.margin), ObstacleError::Margin)?;
        check(self.velocity.iter().all(|v| v.abs() <= max_speed), ObstacleError::Velocity)?;
        check(rotation::is_spin(&self.spin, max_speed), ObstacleError::Spin)?;
        check(self.growth.abs() <= max_speed, ObstacleError::Growth)
    }
}
