//! Frames on a serial line: consistent-overhead byte stuffing, each ended by a zero byte.
//!
//! No byte within a stuffed frame is zero, so a receiver that joins late, or reads noise, is in step again after the
//! next zero. Noise costs at most the frame it touches.

use crate::frame::{FRAME_MAX, NoRoom};
use cobs::{CobsEncoder, DecodeResult, DecoderState};

/// Room that every frame fits in once stuffed, with its ending zero, in bytes.
pub const SERIAL_MAX: usize = cobs::max_encoding_length(FRAME_MAX) + 1;

/// Stuffs a frame for a serial line, to the front of `out`, its ending zero included.
///
/// ```
/// use pliant_protocol::serial::{SERIAL_MAX, stuff};
///
/// let mut room = [0; SERIAL_MAX];
/// assert_eq!(stuff(&[7, 0, 9], &mut room)?, [2, 7, 2, 9, 0]);
/// # Ok::<(), pliant_protocol::frame::NoRoom>(())
/// ```
///
/// # Errors
///
/// [`NoRoom`] where `out` has fewer bytes than the frame could need. [`SERIAL_MAX`] bytes do for a frame of
/// [`FRAME_MAX`].
pub fn stuff<'a>(frame: &[u8], out: &'a mut [u8]) -> Result<&'a [u8], NoRoom> {
    if out.len() <= cobs::max_encoding_length(frame.len()) {
        return Err(NoRoom);
    }
    let mut encoder = CobsEncoder::new(out);
    encoder.push(frame).map_err(|_| NoRoom)?;
    let len = encoder.finalize();
    *out.get_mut(len).ok_or(NoRoom)? = 0;
    out.get(..=len).ok_or(NoRoom)
}

/// Collects the bytes of a serial line into frames.
///
/// Each byte is unstuffed as it comes, so a byte costs the same whether it ends a frame or not.
///
/// ```
/// use pliant_protocol::{Collector, FRAME_MAX, SERIAL_MAX, ToDevice, decode, encode, serial::stuff};
///
/// let (mut frame, mut line) = ([0; FRAME_MAX], [0; SERIAL_MAX]);
/// let line = stuff(encode(1, &ToDevice::Stop, &mut frame)?, &mut line)?;
///
/// let mut collector = Collector::new();
/// let mut seen = 0;
/// for &byte in b"noise\0".iter().chain(line) {
///     if let Some(frame) = collector.push(byte) {
///         seen += usize::from(decode::<ToDevice>(frame).is_ok());
///     }
/// }
/// assert_eq!(seen, 1);
/// # Ok::<(), pliant_protocol::frame::NoRoom>(())
/// ```
#[derive(Debug, Default)]
pub struct Collector {
    frame: heapless::Vec<u8, FRAME_MAX>,
    state: DecoderState,
    /// The frame under way is longer than any: the rest of it is passed over.
    too_long: bool,
    overruns: u32,
    malformed: u32,
}

impl Collector {
    /// One that has seen nothing.
    pub const fn new() -> Self {
        Self { frame: heapless::Vec::new(), state: DecoderState::Idle, too_long: false, overruns: 0, malformed: 0 }
    }

    /// Takes one byte; gives the frame that it ends.
    ///
    /// What it gives is at most [`FRAME_MAX`] bytes long and else unchecked: that is [`decode`](crate::decode)'s work.
    pub fn push(&mut self, byte: u8) -> Option<&[u8]> {
        match self.state.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.frame.clear();
                self.too_long = false;
                None
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                self.too_long |= self.frame.push(byte).is_err();
                None
            }
            Ok(DecodeResult::DataComplete) if self.too_long => {
                self.overruns = self.overruns.saturating_add(1);
                None
            }
            Ok(DecodeResult::DataComplete) => Some(&self.frame),
            // A zero where stuffing promised more: the frame is lost, and the next byte begins another.
            Err(_) => {
                let counter = if self.too_long { &mut self.overruns } else { &mut self.malformed };
                *counter = counter.saturating_add(1);
                None
            }
        }
    }

    /// Frames passed over because they were longer than [`FRAME_MAX`].
    pub const fn overruns(&self) -> u32 {
        self.overruns
    }

    /// Frames passed over because a zero came where the stuffing promised another byte.
    pub const fn malformed(&self) -> u32 {
        self.malformed
    }
}
