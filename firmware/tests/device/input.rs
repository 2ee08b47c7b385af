//! Bytes that are wrong, or say what is wrong.

use pliant_protocol::message::{DeviceError, Field, Obstacle, Settings, Shape, Steering, TickMode, UploadError};
use pliant_protocol::{FRAME_MAX, ToDevice, ToHost, checksum, encode};
use proptest::prelude::*;

use crate::host::{HERE, Host, speed};

#[test]
fn bad_input_is_refused_counted_and_changes_nothing() {
    let good = Obstacle::default;
    let shaped = |shape| Obstacle { shape, ..good() };
    let upsert = |obstacle| ToDevice::Upsert { id: 2, stamp: 0, obstacle };
    let configure = |settings| ToDevice::Configure(settings);
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    let cases = [
        (upsert(Obstacle { center: [f32::NAN, 0.0, 0.0], ..good() }), nan(Field::Center)),
        (upsert(Obstacle { center: [2000.0, 0.0, 0.0], ..good() }), out(Field::Center)),
        (upsert(Obstacle { rotation: [1.0, 0.0, 0.0, 0.1], ..good() }), out(Field::Rotation)),
        (upsert(Obstacle { shape: Shape::ellipsoid([0.05, 0.0, 0.05]), ..good() }), out(Field::Axes)),
        (upsert(Obstacle { shape: Shape::ellipsoid([0.05, -1.0, 0.05]), ..good() }), out(Field::Axes)),
        (upsert(Obstacle { soft_ratio: [0.9; 3], ..good() }), out(Field::SoftRatio)),
        (upsert(Obstacle { margin: [0.5; 3], ..good() }), out(Field::Margin)),
        (upsert(shaped(Shape::Ellipsoid { axes: [0.05; 3], curvature: 0 })), out(Field::Curvature)),
        (upsert(shaped(Shape::Box { half: [0.05; 3], rounding: 0.06 })), out(Field::Rounding)),
        (
            upsert(shaped(Shape::Polygon { vertices: [[0.1, 0.0], [0.0, 0.1]].into_iter().collect() })),
            out(Field::Vertices),
        ),
        (upsert(shaped(Shape::Capsule { radius: 0.05, half_length: 0.05 })), DeviceError::Dimension),
        (upsert(Obstacle { growth: 101.0, ..good() }), out(Field::Growth)),
        (upsert(Obstacle { reference: [0.06, 0.0, 0.0], ..good() }), out(Field::Reference)),
        (upsert(Obstacle { velocity: [f32::INFINITY, 0.0, 0.0], ..good() }), nan(Field::Velocity)),
        (upsert(Obstacle { center: [0.0, 0.0, 0.5], ..good() }), DeviceError::Dimension),
        (configure(Settings { gain: f32::NAN, ..Settings::default() }), nan(Field::Gain)),
        (configure(Settings { speed: 0.0, ..Settings::default() }), out(Field::Speed)),
        (configure(Settings { acceleration: Some(-1.0), ..Settings::default() }), out(Field::Acceleration)),
        (
            configure(Settings { steering: Steering::WithFlow { beta: -1.0 }, ..Settings::default() }),
            out(Field::Steering),
        ),
        (configure(Settings { guard: Some(0.0), ..Settings::default() }), out(Field::Guard)),
        (configure(Settings { hold: 0.0, ..Settings::default() }), out(Field::Ageing)),
        (ToDevice::State { stamp: 0, position: [f32::NAN, 0.0, 0.0] }, nan(Field::Position)),
        (ToDevice::State { stamp: 0, position: [1001.0, 0.0, 0.0] }, out(Field::Position)),
        (ToDevice::State { stamp: 0, position: [0.0, 0.0, 1.0] }, DeviceError::Dimension),
        (
            ToDevice::UploadChunk { offset: 0, data: [1].into_iter().collect() },
            DeviceError::Upload(UploadError::NotBegun),
        ),
    ];
    let mut host = Host::armed(TickMode::Stepped);
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle: good() });
    let before = host.state(HERE);
    for (n, (message, error)) in cases.iter().enumerate() {
        assert_eq!(host.refused(message.clone()), *error, "{message:?}");
        assert_eq!(host.statistics().refused, n as u32 + 1);
    }
    assert_eq!(host.statistics().rejected_states, 3);
    let (Some(ToHost::Command { velocity, revision, .. }), Some(ToHost::Command { velocity: v, revision: r, .. })) =
        (before, host.state(HERE))
    else {
        panic!("no command");
    };
    assert_eq!((velocity, revision), (v, r), "the running state is untouched");
}

#[test]
fn damaged_and_foreign_frames_are_counted_and_never_obeyed() {
    let mut host = Host::armed(TickMode::Stepped);
    host.state(HERE);
    let mut room = [0; FRAME_MAX];
    let frame = encode(500, &ToDevice::Clear, &mut room).unwrap().to_vec();
    let mut answer = [0; FRAME_MAX];
    for bit in 0..frame.len() * 8 {
        let mut bent = frame.clone();
        bent[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(host.device.receive(&bent, &mut answer), None);
    }
    for len in 0..frame.len() {
        assert_eq!(host.device.receive(&frame[..len], &mut answer), None);
    }
    let damaged = (frame.len() * 8 + frame.len()) as u32;
    let s = host.statistics();
    assert_eq!((s.crc_errors, s.refused), (damaged, 0));
}

proptest! {
    /// Whatever comes in, whatever the order, the device answers or keeps silent, and never commands what is not finite.
    #[test]
    fn never_panic(frames in prop::collection::vec((any::<u16>(), 0..16u8, prop::collection::vec(any::<u8>(), 0..230)), 1..60)) {
        let mut host = Host::armed(TickMode::Timed);
        host.state(HERE);
        let mut room = [0; FRAME_MAX];
        for (sequence, tag, bytes) in frames {
            let mut frame = vec![pliant_protocol::VERSION];
            frame.extend(sequence.to_le_bytes());
            frame.push(tag);
            frame.extend(bytes);
            let crc = checksum(&frame);
            frame.extend(crc.to_le_bytes());
            let _ = host.device.receive(&frame, &mut room);
            if let Some((velocity, _)) = host.tick() {
                prop_assert!(velocity.iter().all(|v| v.is_finite()) && speed(velocity) <= 100.0);
            }
        }
    }
}
