//! What the fuzz targets share. `cargo xtask fuzz` runs them.

use pliant_protocol::{FRAME_MAX, Frame, VERSION, checksum, decode, encode};
use serde::{Serialize, de::DeserializeOwned};

/// A frame of this version around `data`, which is a sequence number and a message, with the CRC that it should have:
/// without one, hardly any input would get past it.
pub fn sealed(data: &[u8]) -> Vec<u8> {
    let mut frame = vec![VERSION];
    frame.extend_from_slice(data);
    frame.extend_from_slice(&checksum(&frame).to_le_bytes());
    frame
}

/// Reads `data` as a frame, as it is and sealed. Whatever is understood must fit a frame, come back the same, and not
/// grow on the way.
pub fn understood<M: Serialize + DeserializeOwned + PartialEq>(data: &[u8]) -> Option<M> {
    let _ = decode::<M>(data);
    let frame = sealed(data);
    let Frame { sequence, message } = match decode::<M>(&frame) {
        Ok(frame) => frame,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return None;
        }
    };
    let mut room = [0; FRAME_MAX];
    let again = encode(sequence, &message, &mut room).expect("every message fits a frame");
    assert!(again.len() <= frame.len());
    let back: Frame<M> = decode(again).expect("what was encoded is understood");
    assert_eq!(back.sequence, sequence);
    // Not-a-number is not equal to itself, but has the same bytes.
    assert!(back.message == message || encode(sequence, &back.message, &mut [0; FRAME_MAX]) == Ok(again));
    Some(message)
}
