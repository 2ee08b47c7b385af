//! One message as bytes that can be checked.
//!
//! | bytes | what | |
//! |---|---|---|
//! | 1 | [`VERSION`] | |
//! | 2 | sequence number | little-endian |
//! | any | message | [postcard](https://postcard.jamesmunns.com) |
//! | 4 | CRC-32C of all before | little-endian |
//!
//! The message may change with the version; version, sequence number and CRC stay where they are. So a receiver can
//! always say which frame of another version it refuses.

use crc::{CRC_32_ISCSI, Crc, Table};
use serde::{Deserialize, Serialize};

/// Version of the frame and of the messages in it.
///
/// It is raised by hand, with a release that older peers would misread. [`SCHEMA`](crate::SCHEMA) changes by itself.
pub const VERSION: u8 = 1;
/// Room that every frame fits in, in bytes.
pub const FRAME_MAX: usize = 256;

const HEADER: usize = 3;
const TRAILER: usize = 4;

/// A table for one byte at a time: 1 KiB, where 16 KiB would be quicker and crowd a small part.
static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// CRC-32C (Castagnoli), as it ends a frame and as it vouches for an uploaded model.
///
/// ```
/// assert_eq!(pliant_protocol::checksum(b"123456789"), 0xe306_9283);
/// ```
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// A frame that arrived whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<M> {
    /// The sender's number of this frame, for [`Sequence`](crate::Sequence).
    pub sequence: u16,
    /// What it says.
    pub message: M,
}

/// The output is too short for the frame; [`FRAME_MAX`] bytes always do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoRoom;

impl core::fmt::Display for NoRoom {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the frame does not fit the room given")
    }
}

impl core::error::Error for NoRoom {}

/// Why bytes are not a frame, in the order it is found out.
///
/// ```
/// use pliant_protocol::{FRAME_MAX, FrameError, ToDevice, decode, encode};
///
/// assert_eq!(decode::<ToDevice>(&[1, 0, 0]), Err(FrameError::Short { len: 3 }));
///
/// let mut room = [0; FRAME_MAX];
/// let len = encode(0, &ToDevice::Stop, &mut room)?.len();
/// room[3] ^= 0x10;
/// assert_eq!(decode::<ToDevice>(&room[..len]), Err(FrameError::Crc));
/// # Ok::<(), pliant_protocol::frame::NoRoom>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// Too few bytes for any frame.
    Short {
        /// How many there are.
        len: usize,
    },
    /// Damaged on the way, or never a frame.
    Crc,
    /// A whole frame, of a version that is not [`VERSION`].
    Version {
        /// The sender's version.
        theirs: u8,
        /// The frame's sequence number.
        sequence: u16,
    },
    /// A whole frame of this version that holds none of its messages.
    Message {
        /// The frame's sequence number.
        sequence: u16,
    },
    /// A message with more bytes behind it.
    Trailing {
        /// How many more.
        extra: usize,
        /// The frame's sequence number.
        sequence: u16,
    },
}

impl FrameError {
    /// The sequence number of the refused frame, where the CRC vouches for it.
    ///
    /// ```
    /// # use pliant_protocol::FrameError;
    /// assert_eq!(FrameError::Message { sequence: 9 }.sequence(), Some(9));
    /// assert_eq!(FrameError::Crc.sequence(), None);
    /// ```
    pub const fn sequence(self) -> Option<u16> {
        match self {
            Self::Short { .. } | Self::Crc => None,
            Self::Version { sequence, .. } | Self::Message { sequence } | Self::Trailing { sequence, .. } => {
                Some(sequence)
            }
        }
    }
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Short { len } => write!(f, "{len} bytes are too few for a frame"),
            Self::Crc => f.write_str("the frame was damaged on the way (wrong CRC)"),
            Self::Version { theirs, .. } => {
                write!(f, "the frame is of version {theirs}; this side speaks version {VERSION}")
            }
            Self::Message { .. } => f.write_str("the frame holds no message that this side knows"),
            Self::Trailing { extra, .. } => write!(f, "the frame has {extra} bytes behind its message"),
        }
    }
}

impl core::error::Error for FrameError {}

/// Writes one frame to the front of `out` and gives it.
///
/// ```
/// use pliant_protocol::{FRAME_MAX, ToDevice, VERSION, encode};
///
/// let mut room = [0; FRAME_MAX];
/// let frame = encode(0x0102, &ToDevice::Stop, &mut room)?;
/// assert_eq!(frame[..3], [VERSION, 0x02, 0x01]);
/// # Ok::<(), pliant_protocol::frame::NoRoom>(())
/// ```
///
/// # Errors
///
/// [`NoRoom`] where `out` is too short. It never is with [`FRAME_MAX`] bytes and a message of this crate.
pub fn encode<'a, M: Serialize>(sequence: u16, message: &M, out: &'a mut [u8]) -> Result<&'a [u8], NoRoom> {
    let (head, rest) = out.split_first_chunk_mut::<HEADER>().ok_or(NoRoom)?;
    let [low, high] = sequence.to_le_bytes();
    *head = [VERSION, low, high];
    let len = HEADER + postcard::to_slice(message, rest).map_err(|_| NoRoom)?.len();
    let (body, rest) = out.split_at_mut_checked(len).ok_or(NoRoom)?;
    *rest.first_chunk_mut::<TRAILER>().ok_or(NoRoom)? = checksum(body).to_le_bytes();
    out.get(..len + TRAILER).ok_or(NoRoom)
}

/// Reads one whole frame: a datagram, or what [`Collector`](crate::Collector) gives.
///
/// # Errors
///
/// The first fault, in the order length, CRC, version, message, trailing bytes.
pub fn decode<'a, M: Deserialize<'a>>(bytes: &'a [u8]) -> Result<Frame<M>, FrameError> {
    let short = FrameError::Short { len: bytes.len() };
    let (body, crc) = bytes.split_last_chunk::<TRAILER>().ok_or(short)?;
    let (&[version, low, high], message) = body.split_first_chunk::<HEADER>().ok_or(short)?;
    if checksum(body) != u32::from_le_bytes(*crc) {
        return Err(FrameError::Crc);
    }
    let sequence = u16::from_le_bytes([low, high]);
    if version != VERSION {
        return Err(FrameError::Version { theirs: version, sequence });
    }
    match postcard::take_from_bytes(message) {
        Ok((message, [])) => Ok(Frame { sequence, message }),
        Ok((_, extra)) => Err(FrameError::Trailing { extra: extra.len(), sequence }),
        Err(_) => Err(FrameError::Message { sequence }),
    }
}
