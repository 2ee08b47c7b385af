//! From what came over the wire to what the method runs on, and back.
//!
//! Inward, every number is looked at: first that all are finite, then that nothing is said about a third dimension
//! where there are two, then the ranges, which are `pliant_core`'s own. The first fault is named by its
//! [`Field`]. Outward nothing can fail; what is wider than `f32` is rounded.
//!
//! The same functions run on the device and on the host, so both have the same bits of the same message.

mod motion;
mod obstacle;
mod scan;
mod settings;
mod target;

pub use motion::motion;
pub use obstacle::obstacle;
pub use scan::scan;
pub use settings::settings;
pub use target::{Target, target};

use crate::message::{self, DeviceError, Field};
use pliant_core::{Matrix, Region, RobotState, Scalar, Vector};

/// Where the robot is, from the position in a [`ToDevice::State`](crate::ToDevice::State).
///
/// ```
/// use pliant_protocol::convert::state;
/// use pliant_protocol::message::{DeviceError, Field};
///
/// assert_eq!(state::<2>(&[0.37, 0.41, 0.0]).unwrap().position().y, 0.41);
/// assert_eq!(state::<2>(&[0.37, 0.41, 0.1]), Err(DeviceError::Dimension));
/// assert_eq!(state::<3>(&[0.37, f32::NAN, 0.1]), Err(DeviceError::NotFinite(Field::Position)));
/// assert_eq!(state::<3>(&[0.37, 2e3, 0.1]), Err(DeviceError::OutOfRange(Field::Position)));
/// ```
///
/// # Errors
///
/// A coordinate is not finite or out of range, or there is a z in two dimensions.
pub fn state<const D: usize>(position: &[f32; 3]) -> Result<RobotState<f32, D>, DeviceError> {
    finite(position, Field::Position)?;
    flat::<D>(position)?;
    RobotState::new(vector(position)).ok_or(DeviceError::OutOfRange(Field::Position))
}

/// A vector as it is written into a message: rounded, and with a zero for what it does not have.
///
/// ```
/// use pliant_core::Vector;
///
/// let position = Vector::<f64, 2>::new(0.37, 0.41);
/// assert_eq!(pliant_protocol::convert::padded(&position), [0.37, 0.41, 0.0]);
/// ```
pub fn padded<S: Scalar, const D: usize>(v: &Vector<S, D>) -> [f32; 3] {
    let mut out = [0.0; 3];
    for (out, x) in out.iter_mut().zip(v.iter()) {
        *out = round(*x);
    }
    out
}

impl From<Region> for message::Region {
    fn from(region: Region) -> Self {
        match region {
            Region::Free => Self::Free,
            Region::Soft => Self::Soft,
            Region::Intersection => Self::Intersection,
            Region::Hard => Self::Hard,
        }
    }
}

impl From<message::Region> for Region {
    fn from(region: message::Region) -> Self {
        match region {
            message::Region::Free => Self::Free,
            message::Region::Soft => Self::Soft,
            message::Region::Intersection => Self::Intersection,
            message::Region::Hard => Self::Hard,
        }
    }
}

fn finite(numbers: &[f32], field: Field) -> Result<(), DeviceError> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(DeviceError::NotFinite(field)) }
}

/// In two dimensions, is everything zero that belongs to the third?
fn zero_in_the_plane<const D: usize>(third: impl IntoIterator<Item = f32>) -> Result<(), DeviceError> {
    const { assert!(D == 2 || D == 3, "the method is for two and three dimensions") };
    if D == 3 || third.into_iter().all(|x| x == 0.0) { Ok(()) } else { Err(DeviceError::Dimension) }
}

fn flat<const D: usize>(v: &[f32; 3]) -> Result<(), DeviceError> {
    zero_in_the_plane::<D>([v[2]])
}

/// The first D numbers.
fn vector<const D: usize>(v: &[f32; 3]) -> Vector<f32, D> {
    const { assert!(D <= 3) };
    Vector::from_fn(|i, _| v[i])
}

/// The upper left D x D part.
fn corner<const D: usize>(m: &Matrix<f32, 3>) -> Matrix<f32, D> {
    const { assert!(D <= 3) };
    Matrix::from_fn(|i, j| m[(i, j)])
}

/// The D x D matrix as the upper left part of one of three dimensions, zero elsewhere.
fn framed<S: Scalar, const D: usize>(m: &Matrix<S, D>) -> Matrix<f64, 3> {
    Matrix::from_fn(|i, j| if i < D && j < D { m[(i, j)].to_f64() } else { 0.0 })
}

fn round<S: Scalar>(x: S) -> f32 {
    x.to_f64() as f32
}
