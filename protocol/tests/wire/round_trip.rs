//! What is sent arrives; what was damaged does not.

use core::fmt::Debug;

use pliant_protocol::frame::NoRoom;
use pliant_protocol::model::{MODEL_MAX, Model};
use pliant_protocol::{FRAME_MAX, Frame, FrameError, ToDevice, ToHost, VERSION, checksum, decode, encode};
use proptest::collection::vec;
use proptest::prelude::*;
use serde::{Serialize, de::DeserializeOwned};

use crate::generate::{model, to_device, to_host};

fn framed<M: Serialize>(sequence: u16, message: &M) -> Vec<u8> {
    encode(sequence, message, &mut [0; FRAME_MAX]).unwrap().to_vec()
}

/// Comes back with the same number, the same text and the same bytes: not-a-number is equal to itself in both.
fn comes_back<M: Serialize + DeserializeOwned + Debug>(sequence: u16, message: &M) -> Result<(), TestCaseError> {
    let frame = framed(sequence, message);
    let back: Frame<M> = decode(&frame).unwrap();
    prop_assert_eq!(back.sequence, sequence);
    prop_assert_eq!(format!("{:?}", back.message), format!("{message:?}"));
    prop_assert_eq!(framed(sequence, &back.message), frame);
    Ok(())
}

fn every_flip_is_seen<M: Serialize + DeserializeOwned + Debug + PartialEq>(message: &M) -> Result<(), TestCaseError> {
    let frame = framed(1, message);
    for bit in 0..8 * frame.len() {
        let mut damaged = frame.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        prop_assert_eq!(decode::<M>(&damaged), Err(FrameError::Crc));
    }
    Ok(())
}

/// A frame of any bytes whose CRC is right.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut frame = bytes.to_vec();
    frame.extend_from_slice(&checksum(bytes).to_le_bytes());
    frame
}

proptest! {
    #[test]
    fn messages_to_the_device_come_back(sequence: u16, message in to_device()) {
        comes_back(sequence, &message)?;
    }

    #[test]
    fn messages_to_the_host_come_back(sequence: u16, message in to_host()) {
        comes_back(sequence, &message)?;
    }

    #[test]
    fn models_come_back(model in model()) {
        let mut room = [0; MODEL_MAX];
        let bytes = model.to_bytes(&mut room).unwrap().to_vec();
        let back = Model::from_bytes(&bytes).unwrap();
        prop_assert_eq!(format!("{back:?}"), format!("{model:?}"));
        prop_assert_eq!(back.to_bytes(&mut room).unwrap(), &bytes[..]);
    }

    #[test]
    fn a_single_flipped_bit_is_refused(to_device in to_device(), to_host in to_host()) {
        every_flip_is_seen(&to_device)?;
        every_flip_is_seen(&to_host)?;
    }

    #[test]
    fn a_cut_frame_is_refused(message in to_device(), keep: prop::sample::Index) {
        let frame = framed(1, &message);
        let keep = keep.index(frame.len());
        let expected = if keep < 7 { FrameError::Short { len: keep } } else { FrameError::Crc };
        prop_assert_eq!(decode::<ToDevice>(&frame[..keep]), Err(expected));
    }

    #[test]
    fn too_little_room_is_said(message in to_device(), room: prop::sample::Index) {
        let mut room = vec![0; room.index(framed(1, &message).len())];
        prop_assert_eq!(encode(1, &message, &mut room), Err(NoRoom));
    }

    #[test]
    fn any_bytes_are_answered(bytes in vec(any::<u8>(), 0..300)) {
        let _ = decode::<ToDevice>(&bytes);
        let _ = decode::<ToHost>(&bytes);
        let _ = Model::from_bytes(&bytes);
    }

    #[test]
    fn any_bytes_with_a_right_crc_are_answered(sequence: u16, tag in 0..16u8, bytes in vec(any::<u8>(), 0..250)) {
        let [low, high] = sequence.to_le_bytes();
        let frame = sealed(&[&[VERSION, low, high, tag], &bytes[..]].concat());
        for error in [decode::<ToDevice>(&frame).err(), decode::<ToHost>(&frame).err()].into_iter().flatten() {
            prop_assert_eq!(error.sequence(), Some(sequence));
        }
    }

    #[test]
    fn another_version_is_named_with_its_frame(theirs: u8, sequence: u16, bytes in vec(any::<u8>(), 0..250)) {
        prop_assume!(theirs != VERSION);
        let [low, high] = sequence.to_le_bytes();
        let frame = sealed(&[&[theirs, low, high], &bytes[..]].concat());
        prop_assert_eq!(decode::<ToDevice>(&frame), Err(FrameError::Version { theirs, sequence }));
    }

    #[test]
    fn bytes_behind_a_message_are_counted(sequence: u16, message in to_host(), extra in 1..20usize) {
        let mut bytes = framed(sequence, &message);
        bytes.truncate(bytes.len() - 4);
        bytes.resize(bytes.len() + extra, 0);
        prop_assert_eq!(decode::<ToHost>(&sealed(&bytes)), Err(FrameError::Trailing { extra, sequence }));
    }
}

#[test]
fn faults_are_found_in_order() {
    let stop = framed(5, &ToDevice::Stop);
    // A wrong version and a wrong CRC: the CRC is looked at first, for without it the version is only a rumour.
    let mut damaged = stop.clone();
    damaged[0] = 9;
    assert_eq!(decode::<ToDevice>(&damaged), Err(FrameError::Crc));
    // A wrong version and an unknown message: the version is looked at first, for it says what the message would mean.
    let newer = sealed(&[9, 5, 0, 200]);
    assert_eq!(decode::<ToDevice>(&newer), Err(FrameError::Version { theirs: 9, sequence: 5 }));
    let unknown = sealed(&[VERSION, 5, 0, 200, 0]);
    assert_eq!(decode::<ToDevice>(&unknown), Err(FrameError::Message { sequence: 5 }));
    assert_eq!(decode::<ToDevice>(&sealed(&[VERSION, 5, 0])), Err(FrameError::Message { sequence: 5 }));
    assert_eq!(decode::<ToDevice>(&[]), Err(FrameError::Short { len: 0 }));
}
