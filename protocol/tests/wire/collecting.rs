//! A serial line, with noise on it.

use pliant_protocol::frame::NoRoom;
use pliant_protocol::serial::stuff;
use pliant_protocol::{Arrival, Collector, FRAME_MAX, SERIAL_MAX, Sequence, ToDevice, decode, encode};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::generate::to_device;

fn line(sequence: u16, message: &ToDevice) -> Vec<u8> {
    let (mut frame, mut line) = ([0; FRAME_MAX], [0; SERIAL_MAX]);
    stuff(encode(sequence, message, &mut frame).unwrap(), &mut line).unwrap().to_vec()
}

fn frames(collector: &mut Collector, bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes.iter().filter_map(|byte| collector.push(*byte).map(<[u8]>::to_vec)).collect()
}

proptest! {
    #[test]
    fn any_frame_comes_back(frame in vec(any::<u8>(), 1..=FRAME_MAX)) {
        let mut room = [0; SERIAL_MAX];
        let line = stuff(&frame, &mut room).unwrap();
        prop_assert_eq!(line.iter().position(|b| *b == 0), Some(line.len() - 1));
        let mut collector = Collector::new();
        prop_assert_eq!(frames(&mut collector, line), vec![frame]);
        prop_assert_eq!((collector.overruns(), collector.malformed()), (0, 0));
    }

    #[test]
    fn the_frame_after_noise_and_a_zero_is_whole(noise in vec(any::<u8>(), 0..900), message in to_device()) {
        let mut collector = Collector::new();
        frames(&mut collector, &noise);
        frames(&mut collector, &[0]);
        let got = frames(&mut collector, &line(9, &message));
        prop_assert_eq!(got.len(), 1);
        let got = decode::<ToDevice>(&got[0]).unwrap();
        prop_assert_eq!((got.sequence, format!("{:?}", got.message)), (9, format!("{message:?}")));
    }

    #[test]
    fn noise_costs_one_frame_at_most(noise in vec(1..=255u8, 0..900), message in to_device()) {
        let mut bytes = noise;
        for sequence in 0..4 {
            bytes.extend(line(sequence, &message));
        }
        let numbers: Vec<_> = frames(&mut Collector::new(), &bytes)
            .iter()
            .filter_map(|frame| decode::<ToDevice>(frame).ok())
            .map(|frame| frame.sequence)
            .collect();
        prop_assert!(numbers.ends_with(&[1, 2, 3]), "{:?}", numbers);
    }

    #[test]
    fn what_is_given_is_never_longer_than_a_frame(bytes in vec(any::<u8>(), 0..2_000)) {
        for frame in frames(&mut Collector::new(), &bytes) {
            prop_assert!(frame.len() <= FRAME_MAX);
        }
    }

    #[test]
    fn too_little_room_is_said(frame in vec(any::<u8>(), 0..=FRAME_MAX), room in 0..SERIAL_MAX) {
        let mut room = vec![0; room];
        let needed = stuff(&frame, &mut [0; SERIAL_MAX]).unwrap().len();
        match stuff(&frame, &mut room) {
            Ok(line) => prop_assert_eq!(line.len(), needed),
            Err(NoRoom) => prop_assert!(room.len() < needed + 2),
        }
    }

    #[test]
    fn a_sequence_counts_what_was_dropped(start: u16, steps in vec(1..200u16, 1..300)) {
        let mut sequence = Sequence::new();
        sequence.restart(start);
        let (mut at, mut lost) = (start, 0);
        for step in &steps {
            at = at.wrapping_add(*step);
            match sequence.arrived(at) {
                Arrival::Next => prop_assert_eq!(*step, 1),
                Arrival::After { lost: n } => lost += u32::from(n),
                Arrival::Stale => prop_assert!(false, "{} is newer", at),
            }
            prop_assert_eq!(sequence.arrived(at), Arrival::Stale);
            prop_assert_eq!(sequence.arrived(at.wrapping_sub(*step)), Arrival::Stale);
        }
        prop_assert_eq!(lost, steps.iter().map(|s| u32::from(*s) - 1).sum::<u32>());
    }
}

#[test]
fn overlong_and_broken_frames_are_counted_apart() {
    let mut collector = Collector::new();
    // A hundred runs of nine bytes and a zero: well stuffed, and a thousand bytes long.
    let long = [&[10, 1, 1, 1, 1, 1, 1, 1, 1, 1].repeat(100)[..], &[0]].concat();
    assert!(frames(&mut collector, &long).is_empty());
    assert_eq!((collector.overruns(), collector.malformed()), (1, 0));
    // Ten bytes promised, two sent.
    assert!(frames(&mut collector, &[10, 1, 1, 0]).is_empty());
    assert_eq!((collector.overruns(), collector.malformed()), (1, 1));
    // Zeros between frames are idle line.
    assert!(frames(&mut collector, &[0; 50]).is_empty());
    assert_eq!((collector.overruns(), collector.malformed()), (1, 1));
    assert_eq!(frames(&mut collector, &line(3, &ToDevice::Clear)).len(), 1);
}

#[test]
fn a_frame_of_exactly_the_greatest_length_is_no_overrun() {
    let mut room = [0; SERIAL_MAX];
    let mut collector = Collector::new();
    let line = stuff(&[7; FRAME_MAX], &mut room).unwrap();
    assert_eq!(frames(&mut collector, line), [[7; FRAME_MAX]]);
    let mut room = [0; SERIAL_MAX + 1];
    let line = stuff(&[7; FRAME_MAX + 1], &mut room).unwrap();
    assert!(frames(&mut collector, line).is_empty());
    assert_eq!(collector.overruns(), 1);
}

#[test]
fn sequence_numbers_go_round_and_restart() {
    let mut sequence = Sequence::new();
    assert_eq!(sequence.arrived(40_000), Arrival::Next);
    assert_eq!(sequence.arrived(7_231), Arrival::After { lost: 32_766 });
    assert_eq!(sequence.arrived(7_231_u16.wrapping_add(32_768)), Arrival::Stale);
    sequence.restart(7_000);
    assert_eq!(sequence.arrived(7_000), Arrival::Stale);
    assert_eq!(sequence.arrived(7_001), Arrival::Next);
}
