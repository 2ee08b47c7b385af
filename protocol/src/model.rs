//! A skill, as it is uploaded.
//!
//! It is too large for one frame, so it is encoded by itself, and its bytes go over in
//! [`UploadChunk`](crate::ToDevice::UploadChunk)s between a begin that announces their length and
//! [`checksum`](crate::checksum), and a commit.
//!
//! Matrices are those of three dimensions; in two, every element with a third index is zero.

use crate::frame::NoRoom;
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Room that every model fits in, in bytes.
pub const MODEL_MAX: usize = 2048;
/// Most components of a model.
pub const COMPONENTS_MAX: usize = pliant_core::ds::MAX_COMPONENTS;

/// A skill: where the robot would go if nothing were in the way.
///
/// ```
/// use pliant_protocol::model::{MODEL_MAX, Model, Motion};
///
/// let model = Model { dimension: 2, motion: Motion::Linear { attractor: [0.0; 3], gain: 1.0 } };
/// let mut room = [0; MODEL_MAX];
/// let bytes = model.to_bytes(&mut room)?;
/// assert_eq!(Model::from_bytes(bytes), Ok(model));
/// # Ok::<(), pliant_protocol::frame::NoRoom>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Model {
    /// Number of dimensions, 2 or 3.
    pub dimension: u8,
    /// The motion.
    pub motion: Motion,
}

/// The motion of a skill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(clippy::large_enum_variant, reason = "a model is decoded, converted and dropped, where there is no heap")]
pub enum Motion {
    /// Straight to the attractor: f(x) = -gain (x - attractor).
    Linear {
        /// Where the motion ends, in m.
        attractor: [f32; 3],
        /// Gain, in 1/s.
        gain: f32,
    },
    /// Learnt from demonstrations: f(x) = sum_k gamma_k(x) A_k (x - attractor).
    Lpv {
        /// Where the motion ends, in m.
        attractor: [f32; 3],
        /// Upper triangle, row by row, of the symmetric matrix P that certifies stability: p11, p12, p13, p22, p23, p33
        /// (only its shape counts, so it has no unit).
        lyapunov: [f32; 6],
        /// The linear systems that are blended.
        components: Vec<Component, COMPONENTS_MAX>,
    },
}

/// One linear system of a skill and the Gaussian that says where it holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Component {
    /// log pi - 1/2 log det Sigma, up to a constant common to all components (dimensionless).
    pub log_weight: f32,
    /// Mean mu, in m.
    pub mean: [f32; 3],
    /// Lower triangle, row by row, of W with W'W = Sigma^-1: w11, w21, w22, w31, w32, w33, in 1/m.
    pub whitening: [f32; 6],
    /// Matrix A, row by row, in 1/s.
    pub a: [f32; 9],
}

/// Why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// More bytes than [`MODEL_MAX`].
    TooLarge {
        /// How many there are.
        len: usize,
    },
    /// Not the encoding of a model, or cut short.
    Malformed,
    /// A model with more bytes behind it.
    Trailing {
        /// How many more.
        extra: usize,
    },
}

impl core::fmt::Display for ReadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooLarge { len } => write!(f, "{len} bytes are too many for a model: the most is {MODEL_MAX}"),
            Self::Malformed => f.write_str("the bytes are no model, or it is cut short"),
            Self::Trailing { extra } => write!(f, "{extra} bytes follow the model"),
        }
    }
}

impl core::error::Error for ReadError {}

impl Model {
    /// Writes the model to the front of `out` and gives its bytes.
    ///
    /// # Errors
    ///
    /// [`NoRoom`] where `out` is too short. It never is with [`MODEL_MAX`] bytes.
    pub fn to_bytes<'a>(&self, out: &'a mut [u8]) -> Result<&'a [u8], NoRoom> {
        postcard::to_slice(self, out).map(|bytes| &*bytes).map_err(|_| NoRoom)
    }

    /// Reads a model. Its numbers are not looked at: that is the work of [`convert`](crate::convert).
    ///
    /// # Errors
    ///
    /// See [`ReadError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        if bytes.len() > MODEL_MAX {
            return Err(ReadError::TooLarge { len: bytes.len() });
        }
        match postcard::take_from_bytes(bytes) {
            Ok((model, [])) => Ok(model),
            Ok((_, extra)) => Err(ReadError::Trailing { extra: extra.len() }),
            Err(_) => Err(ReadError::Malformed),
        }
    }
}
