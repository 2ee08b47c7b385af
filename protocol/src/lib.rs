//! Messages between a Pliant device and its host, and how they lie in a frame.
//!
//! The host sends [`ToDevice`], the device answers with [`ToHost`]. Both travel in the same [`frame`], which is a
//! datagram over UDP and is stuffed and ended by a zero byte over a [`serial`] line. Each side numbers its frames, so
//! that the other sees what was lost on the way ([`sequence`]). A skill is too large for one frame: it is sent as
//! pieces of one [`model`] file. [`convert`] is where bytes end and checked `pliant_core` types begin.
//!
//! ```
//! use pliant_protocol::{FRAME_MAX, Frame, ToDevice, decode, encode};
//!
//! let state = ToDevice::State { stamp: 1_000, position: [0.37, 0.41, 0.0] };
//! let mut room = [0; FRAME_MAX];
//! let bytes = encode(7, &state, &mut room)?;
//! assert_eq!(decode::<ToDevice>(bytes), Ok(Frame { sequence: 7, message: state }));
//! # Ok::<(), pliant_protocol::frame::NoRoom>(())
//! ```
//!
//! # A session
//!
//! 1. The host says [`ToDevice::Hello`], the device [`ToHost::Hello`]. Both carry [`SCHEMA`]; where they differ, the two
//!    were built from different messages and must not talk on.
//! 2. The host uploads a skill, configures, and keeps the obstacle table up to date. Each of these is answered by
//!    [`ToHost::Ack`] or [`ToHost::Refused`], naming the sequence number of the request. A refusal changes nothing.
//! 3. The host arms the device and sends [`ToDevice::State`] at the rate it has it; the device sends
//!    [`ToHost::Command`] every tick.
//!
//! # Conventions
//!
//! Units are SI. A vector is always three `f32`; in two dimensions z is zero, and anything else there is refused. Bytes
//! from outside never make this crate panic, whatever they are.
#![no_std]
#![forbid(unsafe_code)]

pub mod convert;
pub mod frame;
pub mod message;
pub mod model;
pub mod sequence;
pub mod serial;

pub use frame::{FRAME_MAX, Frame, FrameError, VERSION, checksum, decode, encode};
pub use message::{SCHEMA, ToDevice, ToHost};
pub use sequence::{Arrival, Sequence};
pub use serial::{Collector, SERIAL_MAX};
