#![doc = include_str!("../README.md")]
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
