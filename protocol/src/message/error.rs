//! Why a device refuses a request.

use super::Mode;
use crate::frame::{FrameError, VERSION};
use core::fmt::{Display, Formatter, Result};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Why a device refuses a request.
///
/// ```
/// use pliant_protocol::message::{DeviceError, Field};
///
/// let error = DeviceError::OutOfRange(Field::SoftRatio);
/// assert_eq!(error.to_string(), "soft is out of range");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum DeviceError {
    /// The host's schema is not the device's.
    Schema {
        /// The device's [`SCHEMA`](crate::SCHEMA).
        ours: u64,
    },
    /// A whole frame came that the device cannot read.
    Frame(FrameFault),
    /// Not allowed in this mode.
    Mode(Mode),
    /// The field holds a number that is not finite.
    NotFinite(Field),
    /// The field holds a number that is out of its range.
    OutOfRange(Field),
    /// Made for another number of dimensions than the device runs, or holds something in the third where it runs two.
    Dimension,
    /// The obstacle table has no room for another.
    TableFull,
    /// No obstacle has this number.
    UnknownObstacle,
    /// There is no model to run.
    NoModel,
    /// The upload went wrong; begin it again.
    Upload(UploadError),
    /// The model's certificate does not hold.
    Certificate {
        /// The first component that fails it; none where the Lyapunov matrix itself is not positive definite.
        component: Option<u8>,
    },
    /// The device serves another host, or has restarted since it served this one: say hello.
    NotGreeted,
    /// A piece of a scan is not the one that was expected.
    Scan(ScanFault),
}

/// Why a whole frame cannot be read. A damaged one is counted and not answered: its sender is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FrameFault {
    /// It is of another version.
    Version {
        /// The device's [`VERSION`].
        ours: u8,
    },
    /// It holds no message that the device knows.
    Message,
    /// It has bytes behind its message.
    Trailing,
}

/// Why an upload failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum UploadError {
    /// A piece or a commit came before a begin.
    NotBegun,
    /// Longer than the device has room for, or than it said it would be.
    TooLarge,
    /// A piece does not begin where the last one ended.
    Gap,
    /// The model's checksum is not the one announced.
    Crc,
    /// Committed before all of it had come.
    Incomplete,
    /// The bytes are no model.
    Malformed,
}

/// Why a piece of a scan is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ScanFault {
    /// It does not begin where the last one ended, or is of a scan that was not begun.
    Gap {
        /// The start that was expected: 0 where the scan was not begun.
        expected: u16,
    },
    /// It has another total than the pieces before, or goes beyond it.
    Total {
        /// The total that was expected.
        expected: u16,
    },
}

/// The part of a message that is at fault.
///
/// It is shown by the name it has in a scene or model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Field {
    /// Centre of an obstacle.
    Center,
    /// Its rotation.
    Rotation,
    /// Its lengths: semi-axes, half sides, radius or half length.
    Axes,
    /// Its curvature exponent.
    Curvature,
    /// Its soft surface as multiples of the hard one.
    SoftRatio,
    /// Its safety factors.
    Margin,
    /// Its reference point.
    Reference,
    /// Its velocity.
    Velocity,
    /// Its angular velocity.
    AngularVelocity,
    /// Position of the robot.
    Position,
    /// Gain c of the push in a soft layer.
    Gain,
    /// Angle or beta of the steering.
    Steering,
    /// Speed limit.
    Speed,
    /// Acceleration limit.
    Acceleration,
    /// Deceleration of a ramp to a stop.
    Deceleration,
    /// Time to live, growth or hold time of an obstacle that is not seen again.
    Ageing,
    /// Attractor of a motion.
    Attractor,
    /// Gain of a linear motion.
    LinearGain,
    /// Lyapunov matrix of a model.
    Lyapunov,
    /// Number of components of a model.
    Components,
    /// Weight of a component: its prior and the size of its covariance.
    Prior,
    /// Mean of a component.
    Mean,
    /// Whitening matrix of a component: its covariance.
    Whitening,
    /// Linear system of a component.
    Matrix,
    /// Radius of an obstacle's edges or rims.
    Rounding,
    /// Corners of a polygon.
    Vertices,
    /// How fast an obstacle grows.
    Growth,
    /// The share of a distance that the guard lets a sample use up.
    Guard,
    /// Points of a scan, or how many there are.
    Points,
    /// Radius of a scan's points.
    Radius,
    /// Velocity of the attractor.
    AttractorVelocity,
}

impl DeviceError {
    /// The answer to bytes that [`decode`](crate::decode) refused, with the sequence number that it answers; none where
    /// the bytes were damaged, for then nobody is known to have sent them.
    ///
    /// ```
    /// use pliant_protocol::{FrameError, message::{DeviceError, FrameFault}};
    ///
    /// let answer = DeviceError::of_frame(FrameError::Message { sequence: 9 });
    /// assert_eq!(answer, Some((9, DeviceError::Frame(FrameFault::Message))));
    /// assert_eq!(DeviceError::of_frame(FrameError::Crc), None);
    /// ```
    pub const fn of_frame(error: FrameError) -> Option<(u16, Self)> {
        match error {
            FrameError::Short { .. } | FrameError::Crc => None,
            FrameError::Version { sequence, .. } => {
                Some((sequence, Self::Frame(FrameFault::Version { ours: VERSION })))
            }
            FrameError::Message { sequence } => Some((sequence, Self::Frame(FrameFault::Message))),
            FrameError::Trailing { sequence, .. } => Some((sequence, Self::Frame(FrameFault::Trailing))),
        }
    }
}

impl Field {
    /// Its name in a scene or model file.
    ///
    /// ```
    /// assert_eq!(pliant_protocol::message::Field::Matrix.name(), "a");
    /// ```
    pub const fn name(self) -> &'static str {
        match self {
            Self::Center => "center",
            Self::Rotation => "rotation",
            Self::Axes => "shape",
            Self::Curvature => "curvature",
            Self::SoftRatio => "soft",
            Self::Margin => "margin",
            Self::Reference => "reference",
            Self::Velocity => "velocity",
            Self::AngularVelocity => "angular_velocity",
            Self::Position => "position",
            Self::Gain => "c",
            Self::Steering => "steering",
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
            Self::Deceleration => "deceleration",
            Self::Ageing => "ageing",
            Self::Attractor => "attractor",
            Self::LinearGain => "gain",
            Self::Lyapunov => "lyapunov",
            Self::Components => "component",
            Self::Prior => "prior",
            Self::Mean => "mean",
            Self::Whitening => "covariance",
            Self::Matrix => "a",
            Self::Rounding => "rounding",
            Self::Vertices => "polygon",
            Self::Growth => "growth",
            Self::Guard => "approach",
            Self::Points => "points",
            Self::Radius => "radius",
            Self::AttractorVelocity => "velocity",
        }
    }
}

impl Display for Field {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(self.name())
    }
}

impl Display for DeviceError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Schema { ours } => {
                write!(f, "built from other messages than the device (its schema is {ours:016x}): flash new firmware")
            }
            Self::Frame(fault) => fault.fmt(f),
            Self::Mode(mode) => write!(f, "not allowed while the device is {mode}"),
            Self::NotFinite(field) => write!(f, "{field} is not finite"),
            Self::OutOfRange(field) => write!(f, "{field} is out of range"),
            Self::Dimension => f.write_str("made for another number of dimensions than the device runs"),
            Self::TableFull => f.write_str("the device's obstacle table is full"),
            Self::UnknownObstacle => f.write_str("the device has no obstacle of this number"),
            Self::NoModel => f.write_str("the device has no model to run: upload one"),
            Self::Upload(error) => error.fmt(f),
            Self::Scan(fault) => fault.fmt(f),
            Self::NotGreeted => f.write_str("the device has restarted, or serves another host: say hello first"),
            Self::Certificate { component: None } => {
                f.write_str("the Lyapunov matrix is not symmetric and positive definite")
            }
            Self::Certificate { component: Some(k) } => {
                write!(f, "component {k} breaks the certificate: A'P + PA is not negative definite")
            }
        }
    }
}

impl Display for FrameFault {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Version { ours } => write!(f, "the device speaks version {ours} of the protocol"),
            Self::Message => f.write_str("the device does not know this message"),
            Self::Trailing => f.write_str("the frame had bytes behind its message"),
        }
    }
}

impl Display for ScanFault {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Gap { expected } => {
                write!(f, "a piece of the scan is missing: the one from point {expected} was expected")
            }
            Self::Total { expected } => write!(f, "a piece that does not go with a scan of {expected} points in all"),
        }
    }
}

impl Display for UploadError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(match self {
            Self::NotBegun => "no upload was begun",
            Self::TooLarge => "the model is larger than the device takes, or than announced",
            Self::Gap => "a piece of the model is missing",
            Self::Crc => "the model was damaged on the way (wrong CRC)",
            Self::Incomplete => "the model was committed before all of it had come",
            Self::Malformed => "the bytes uploaded are no model",
        })
    }
}

impl core::error::Error for DeviceError {}
impl core::error::Error for FrameFault {}
impl core::error::Error for ScanFault {}
impl core::error::Error for UploadError {}
