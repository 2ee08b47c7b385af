//! The whole device, byte by byte: what it answers, how its modes change, and what it never lets through.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_firmware::{Device, Identity, LATE_TICKS, LOST_STEPPED_TICKS, LOST_TICKS};
use pliant_protocol::message::{
    DeviceError, Field, Mode, Obstacle, Settings, Statistics, Steering, StopReason, TickMode, UploadError,
};
use pliant_protocol::model::{Component, MODEL_MAX, Model, Motion};
use pliant_protocol::{FRAME_MAX, SCHEMA, ToDevice, ToHost, checksum, decode, encode};

/// A host that counts its frames.
struct Host {
    device: Device,
    sequence: u16,
    stamp: u64,
}

impl Host {
    fn stranger() -> Self {
        Self { device: Device::new(Identity { board: "test", firmware: [0, 1, 0] }), sequence: 0, stamp: 0 }
    }

    fn greeted() -> Self {
        let mut host = Self::stranger();
        assert!(matches!(host.say(ToDevice::Hello { schema: SCHEMA }), Some(ToHost::Hello { schema: SCHEMA, .. })));
        host
    }

    /// With a linear skill, armed.
    fn armed(tick: TickMode) -> Self {
        let mut host = Self::greeted();
        host.upload(&linear(2));
        host.ok(ToDevice::Arm { tick });
        host
    }

    fn say(&mut self, message: ToDevice) -> Option<ToHost> {
        let mut room = [0; FRAME_MAX];
        self.sequence = self.sequence.wrapping_add(1);
        let frame = encode(self.sequence, &message, &mut room).unwrap();
        let mut answer = [0; FRAME_MAX];
        self.device.receive(frame, &mut answer).map(|bytes| decode(bytes).unwrap().message)
    }

    fn ok(&mut self, message: ToDevice) {
        let answer = self.say(message.clone());
        assert!(matches!(answer, Some(ToHost::Ack { of, .. }) if of == self.sequence), "{message:?}: {answer:?}");
    }

    fn refused(&mut self, message: ToDevice) -> DeviceError {
        match self.say(message.clone()) {
            Some(ToHost::Refused { of, error }) if of == self.sequence => error,
            other => panic!("{message:?} was not refused: {other:?}"),
        }
    }

    fn upload(&mut self, model: &Model) {
        self.announce(model);
        self.ok(ToDevice::UploadCommit);
    }

    /// All but the commit.
    fn announce(&mut self, model: &Model) {
        let mut room = [0; MODEL_MAX];
        let bytes = model.to_bytes(&mut room).unwrap();
        self.ok(ToDevice::UploadBegin { bytes: bytes.len() as u32, crc: checksum(bytes) });
        for (i, piece) in bytes.chunks(50).enumerate() {
            self.ok(ToDevice::UploadChunk { offset: i as u32 * 50, data: piece.iter().copied().collect() });
        }
    }

    fn state(&mut self, position: [f32; 3]) -> Option<ToHost> {
        self.stamp += 1000;
        self.say(ToDevice::State { stamp: self.stamp, position })
    }

    /// A tick of the device's own clock: velocity and mode.
    fn tick(&mut self) -> Option<([f32; 3], Mode)> {
        let mut room = [0; FRAME_MAX];
        match decode::<ToHost>(self.device.tick(0, &mut room)?).unwrap().message {
            ToHost::Command { velocity, mode, .. } => Some((velocity, mode)),
            other => panic!("{other:?}"),
        }
    }

    fn statistics(&mut self) -> Statistics {
        match self.say(ToDevice::Statistics) {
            Some(ToHost::Statistics(s)) => s,
            other => panic!("{other:?}"),
        }
    }
}

fn linear(dimension: u8) -> Model {
    Model { dimension, motion: Motion::Linear { attractor: [0.0; 3], gain: 1.0 } }
}

fn speed([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

const HERE: [f32; 3] = [0.3, 0.1, 0.0];

#[test]
fn a_stranger_is_told_the_schema_and_nothing_else() {
    let mut host = Host::stranger();
    assert_eq!(host.refused(ToDevice::Clear), DeviceError::NotGreeted);
    assert!(matches!(host.say(ToDevice::Hello { schema: 1 }), Some(ToHost::Hello { schema: SCHEMA, .. })));
    assert_eq!(host.refused(ToDevice::Clear), DeviceError::NotGreeted);
    assert!(matches!(host.say(ToDevice::Hello { schema: SCHEMA }), Some(ToHost::Hello { tick_hz: 1000, .. })));
    host.ok(ToDevice::Clear);
    assert!(matches!(host.say(ToDevice::Hello { schema: 1 }), Some(ToHost::Hello { schema: SCHEMA, .. })));
    host.ok(ToDevice::Clear);
}

#[test]
fn nothing_moves_without_a_skill_an_arm_and_a_state() {
    let mut host = Host::greeted();
    assert_eq!(host.refused(ToDevice::Arm { tick: TickMode::Timed }), DeviceError::NoModel);
    assert_eq!(host.refused(ToDevice::State { stamp: 0, position: HERE }), DeviceError::NoModel);
    host.upload(&linear(2));
    assert_eq!(host.refused(ToDevice::State { stamp: 0, position: HERE }), DeviceError::Mode(Mode::Idle));
    assert_eq!(host.tick(), None);
    host.ok(ToDevice::Arm { tick: TickMode::Timed });
    assert_eq!(host.tick(), None, "armed, but the robot is nobody knows where");
    assert_eq!(host.state(HERE), None);
    let (velocity, mode) = host.tick().unwrap();
    assert_eq!((velocity, mode), ([-0.3, -0.1, 0.0], Mode::Running));
}

#[test]
fn a_late_state_ramps_to_rest_and_a_fresh_one_goes_on() {
    let mut host = Host::armed(TickMode::Timed);
    host.state(HERE);
    for _ in 0..LATE_TICKS {
        assert_eq!(host.tick().unwrap().1, Mode::Running);
    }
    let mut last = speed(HERE);
    for _ in 0..150 {
        host.say(ToDevice::Statistics);
        let (velocity, mode) = host.tick().unwrap();
        assert_eq!(mode, Mode::Degraded);
        // 2 m/s^2 by default
        assert!((last - speed(velocity) - 0.002).abs() < 1e-5, "{last} {velocity:?}");
        last = speed(velocity);
    }
    host.state(HERE);
    assert_eq!(host.tick().unwrap().1, Mode::Running);
    assert_eq!(host.statistics().late, 150);
}

#[test]
fn a_lost_link_and_a_stop_are_latched() {
    let mut host = Host::armed(TickMode::Timed);
    host.state(HERE);
    for _ in 0..LOST_TICKS {
        host.tick();
    }
    assert_eq!(host.tick().unwrap(), ([0.0; 3], Mode::Stopped(StopReason::LinkLost)));
    host.state(HERE);
    assert_eq!(host.tick().unwrap(), ([0.0; 3], Mode::Stopped(StopReason::LinkLost)), "states alone do not re-arm");
    host.ok(ToDevice::Arm { tick: TickMode::Timed });
    host.state(HERE);
    assert_eq!(host.tick().unwrap().1, Mode::Running);
    host.ok(ToDevice::Stop);
    host.state(HERE);
    assert_eq!(host.tick().unwrap(), ([0.0; 3], Mode::Stopped(StopReason::Requested)));
}

#[test]
fn a_stop_is_obeyed_from_a_stranger_and_out_of_order() {
    let mut host = Host::armed(TickMode::Timed);
    host.state(HERE);
    host.sequence = host.sequence.wrapping_sub(10);
    assert!(matches!(host.say(ToDevice::Stop), Some(ToHost::Ack { .. })));
    assert_eq!(host.tick().unwrap(), ([0.0; 3], Mode::Stopped(StopReason::Requested)));
}

#[test]
fn stepped_ticks_once_a_state_and_not_by_the_clock() {
    let mut host = Host::armed(TickMode::Stepped);
    for n in 0..3 {
        assert_eq!(host.tick(), None);
        let answer = host.state(HERE);
        let sequence = host.sequence;
        assert!(
            matches!(answer, Some(ToHost::Command { tick, state, mode: Mode::Running, .. }) if tick == n && state == sequence),
            "{answer:?}"
        );
    }
}

#[test]
fn every_command_names_the_table_it_was_computed_from() {
    let mut host = Host::armed(TickMode::Stepped);
    let revision = |answer| match answer {
        Some(ToHost::Command { revision, nearest, .. }) => (revision, nearest),
        other => panic!("{other:?}"),
    };
    let flat = Obstacle { axes: [0.05, 0.05, 0.05], ..Obstacle::default() };
    assert_eq!(revision(host.state(HERE)), (0, None));
    host.ok(ToDevice::Upsert { id: 9, stamp: host.stamp, obstacle: flat });
    assert_eq!(revision(host.state(HERE)), (1, Some(9)));
    host.ok(ToDevice::Remove { id: 9 });
    assert_eq!(host.refused(ToDevice::Remove { id: 9 }), DeviceError::UnknownObstacle);
    assert_eq!(revision(host.state(HERE)), (2, None));
}

#[test]
fn a_sighting_is_carried_on_by_its_age() {
    let gamma = |age: u64| {
        let mut host = Host::armed(TickMode::Stepped);
        host.stamp = 1_000_000;
        host.state(HERE);
        let seen = Obstacle { velocity: [0.1, 0.0, 0.0], axes: [0.05; 3], ..Obstacle::default() };
        // The next tick is a millisecond after that state.
        host.ok(ToDevice::Upsert { id: 1, stamp: host.stamp + 1000 - age, obstacle: seen });
        match host.state(HERE) {
            Some(ToHost::Command { gamma, .. }) => gamma,
            other => panic!("{other:?}"),
        }
    };
    let expected = |age: f32| (HERE[0] - 0.1 * age).powi(2) / 0.0025 + HERE[1].powi(2) / 0.0025;
    for (age, seconds) in [(0, 0.0), (50_000, 0.05), (100_000, 0.1)] {
        assert!((gamma(age) - expected(seconds)).abs() < 1e-3, "{age}: {} {}", gamma(age), expected(seconds));
    }
}

#[test]
fn bad_input_is_refused_counted_and_changes_nothing() {
    let good = Obstacle { axes: [0.05; 3], ..Obstacle::default() };
    let upsert = |obstacle| ToDevice::Upsert { id: 2, stamp: 0, obstacle };
    let configure = |settings| ToDevice::Configure(settings);
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    let cases = [
        (upsert(Obstacle { center: [f32::NAN, 0.0, 0.0], ..good }), nan(Field::Center)),
        (upsert(Obstacle { center: [2000.0, 0.0, 0.0], ..good }), out(Field::Center)),
        (upsert(Obstacle { rotation: [1.0, 0.0, 0.0, 0.1], ..good }), out(Field::Rotation)),
        (upsert(Obstacle { axes: [0.05, 0.0, 0.05], ..good }), out(Field::Axes)),
        (upsert(Obstacle { axes: [0.05, -1.0, 0.05], ..good }), out(Field::Axes)),
        (upsert(Obstacle { soft_ratio: [0.9; 3], ..good }), out(Field::SoftRatio)),
        (upsert(Obstacle { margin: [0.5; 3], ..good }), out(Field::Margin)),
        (upsert(Obstacle { curvature: 0, ..good }), out(Field::Curvature)),
        (upsert(Obstacle { reference: [0.06, 0.0, 0.0], ..good }), out(Field::Reference)),
        (upsert(Obstacle { velocity: [f32::INFINITY, 0.0, 0.0], ..good }), nan(Field::Velocity)),
        (upsert(Obstacle { center: [0.0, 0.0, 0.5], ..good }), DeviceError::Dimension),
        (configure(Settings { gain: f32::NAN, ..Settings::default() }), nan(Field::Gain)),
        (configure(Settings { speed: 0.0, ..Settings::default() }), out(Field::Speed)),
        (configure(Settings { acceleration: Some(-1.0), ..Settings::default() }), out(Field::Acceleration)),
        (
            configure(Settings { steering: Steering::WithFlow { beta: -1.0 }, ..Settings::default() }),
            out(Field::Steering),
        ),
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
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle: good });
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
fn a_skill_that_fails_its_certificate_leaves_the_old_one_running() {
    let part =
        |a: [f32; 9]| Component { log_weight: 0.0, mean: [0.0; 3], whitening: [10.0, 0.0, 10.0, 0.0, 0.0, 0.0], a };
    let stable = part([-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let unstable = part([-1.0, 5.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let lyapunov = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let model = |components: &[Component]| Model {
        dimension: 2,
        motion: Motion::Lpv { attractor: [0.0; 3], lyapunov, components: components.iter().copied().collect() },
    };
    let mut host = Host::armed(TickMode::Stepped);
    let before = match host.state(HERE) {
        Some(ToHost::Command { velocity, .. }) => velocity,
        other => panic!("{other:?}"),
    };
    host.announce(&model(&[stable, unstable]));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Certificate { component: Some(1) });
    host.announce(&model(&[]));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::OutOfRange(Field::Components));
    // Half an upload, and then another thing altogether.
    host.ok(ToDevice::UploadBegin { bytes: 100, crc: 0 });
    assert!(matches!(host.state(HERE), Some(ToHost::Command { velocity, .. }) if velocity == before));
    host.announce(&linear(3));
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Mode(Mode::Running));
    host.announce(&model(&[stable]));
    host.ok(ToDevice::UploadCommit);
    assert!(matches!(host.state(HERE), Some(ToHost::Command { mode: Mode::Running, .. })));
}

#[test]
fn a_full_table_is_an_error_and_not_a_drop() {
    let mut host = Host::armed(TickMode::Stepped);
    let obstacle = Obstacle { axes: [0.01; 3], ..Obstacle::default() };
    for id in 0..64 {
        host.ok(ToDevice::Upsert { id, stamp: 0, obstacle });
    }
    assert_eq!(host.refused(ToDevice::Upsert { id: 64, stamp: 0, obstacle }), DeviceError::TableFull);
    host.ok(ToDevice::Upsert { id: 63, stamp: 0, obstacle });
}

#[test]
fn three_dimensions_are_another_workspace() {
    let mut host = Host::greeted();
    host.upload(&linear(3));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    let answer = host.state([0.1, 0.1, 0.2]);
    assert!(matches!(answer, Some(ToHost::Command { velocity: [_, _, z], .. }) if z == -0.2), "{answer:?}");
    host.ok(ToDevice::Stop);
    host.upload(&linear(2));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    assert_eq!(host.refused(ToDevice::State { stamp: 0, position: [0.1, 0.1, 0.2] }), DeviceError::Dimension);
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

#[test]
fn a_late_clock_moves_time_on_and_skips_a_computation() {
    let mut host = Host::armed(TickMode::Timed);
    let moving = Obstacle { velocity: [0.1, 0.0, 0.0], axes: [0.05; 3], ..Obstacle::default() };
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle: moving });
    let mut room = [0; FRAME_MAX];
    let mut tick = |host: &mut Host, overdue| {
        let answer = host.device.tick(overdue, &mut room).map(|bytes| decode::<ToHost>(bytes).unwrap().message);
        answer.map(|m| match m {
            ToHost::Command { tick, gamma, .. } => (tick, gamma),
            other => panic!("{other:?}"),
        })
    };
    host.state(HERE);
    let gamma = |seconds: f32| ((HERE[0] - 0.1 * seconds).powi(2) + HERE[1].powi(2)) / 0.0025;
    let (first, now) = tick(&mut host, 0).unwrap();
    assert!((now - gamma(0.0)).abs() < 1e-3);
    assert_eq!(tick(&mut host, 9), None, "late: the links come first");
    let (next, _) = tick(&mut host, 0).unwrap();
    assert_eq!(next, first + 11, "ten due ticks were not computed");
    let (_, now) = tick(&mut host, 0).unwrap();
    assert!((now - gamma(0.012)).abs() < 1e-3, "{now} {}", gamma(0.012));
    assert_eq!((host.statistics().missed, host.statistics().ticks), (10, 3));
    // Twenty milliseconds are twenty milliseconds, however few of them were computed.
    tick(&mut host, 20);
    let mut answer = [0; FRAME_MAX];
    let late = decode::<ToHost>(host.device.tick(0, &mut answer).unwrap()).unwrap().message;
    assert!(matches!(late, ToHost::Command { mode: Mode::Degraded, .. }), "{late:?}");
}

#[test]
fn obstacles_move_while_nobody_knows_where_the_robot_is() {
    let mut host = Host::armed(TickMode::Timed);
    let moving = Obstacle { velocity: [0.1, 0.0, 0.0], axes: [0.05; 3], ..Obstacle::default() };
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle: moving });
    for _ in 0..100 {
        assert_eq!(host.tick(), None);
    }
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    let answer = host.state(HERE);
    let expected = ((HERE[0] - 0.01_f32).powi(2) + HERE[1].powi(2)) / 0.0025;
    assert!(matches!(answer, Some(ToHost::Command { gamma, .. }) if (gamma - expected).abs() < 1e-3), "{answer:?}");
}

#[test]
fn a_commit_sent_again_is_answered_alike() {
    let mut host = Host::greeted();
    host.upload(&linear(2));
    host.ok(ToDevice::UploadCommit);
    host.ok(ToDevice::UploadBegin { bytes: 10, crc: 0 });
    assert_eq!(host.refused(ToDevice::UploadCommit), DeviceError::Upload(UploadError::Incomplete));
}

#[test]
fn a_stepped_run_that_falls_silent_is_stopped_too() {
    let mut host = Host::armed(TickMode::Stepped);
    host.state(HERE);
    let mut room = [0; FRAME_MAX];
    for _ in 0..=LOST_STEPPED_TICKS {
        assert!(host.device.tick(0, &mut room).is_none());
    }
    let answer = host.state(HERE);
    let lost = Mode::Stopped(StopReason::LinkLost);
    assert!(
        matches!(answer, Some(ToHost::Command { velocity: [0.0, 0.0, 0.0], mode, .. }) if mode == lost),
        "{answer:?}"
    );
}

/// Two peers at one desk.
mod peers {
    use super::*;
    use pliant_firmware::{Control, Desk};

    struct Table {
        desk: Desk<u8>,
        control: Control,
    }

    impl Table {
        fn say(&mut self, from: u8, sequence: u16, message: ToDevice) -> Option<ToHost> {
            let mut room = [0; FRAME_MAX];
            let frame = encode(sequence, &message, &mut room).unwrap();
            self.desk.receive(from, frame, &mut self.control)
        }

        /// A host, 1, that drives.
        fn driven() -> Self {
            let desk = Desk::new(Identity { board: "test", firmware: [0, 1, 0] });
            let mut table = Self { desk, control: Control::new() };
            let mut room = [0; MODEL_MAX];
            let model = linear(2);
            let bytes = model.to_bytes(&mut room).unwrap();
            let (len, crc, data) = (bytes.len() as u32, checksum(bytes), bytes.iter().copied().collect());
            let session = [
                ToDevice::Hello { schema: SCHEMA },
                ToDevice::UploadBegin { bytes: len, crc },
                ToDevice::UploadChunk { offset: 0, data },
                ToDevice::UploadCommit,
                ToDevice::Arm { tick: TickMode::Timed },
                ToDevice::State { stamp: 0, position: HERE },
            ];
            for (sequence, message) in session.into_iter().enumerate() {
                let answer = table.say(1, sequence as u16, message);
                assert!(!matches!(answer, Some(ToHost::Refused { .. })), "{answer:?}");
            }
            table
        }

        fn mode(&mut self) -> Mode {
            self.control.tick(0);
            match self.control.take_report() {
                Some(ToHost::Command { mode, .. }) => mode,
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_stranger_can_stop_and_nothing_else() {
        let mut table = Table::driven();
        for (sequence, message) in [(9, ToDevice::Clear), (10, ToDevice::Arm { tick: TickMode::Timed })] {
            let answer = table.say(2, sequence, message);
            assert!(matches!(answer, Some(ToHost::Refused { error: DeviceError::NotGreeted, .. })), "{answer:?}");
        }
        for schema in [SCHEMA, 1] {
            let answer = table.say(2, 30_000, ToDevice::Hello { schema });
            assert!(matches!(answer, Some(ToHost::Refused { error: DeviceError::Mode(_), .. })), "{answer:?}");
        }
        assert_eq!((table.desk.host(), table.mode()), (Some(1), Mode::Running));
        assert!(matches!(table.say(2, 20_000, ToDevice::Stop), Some(ToHost::Ack { .. })));
        assert_eq!(table.mode(), Mode::Stopped(StopReason::Requested));
        // The host's own numbers still count.
        assert!(matches!(table.say(1, 6, ToDevice::Arm { tick: TickMode::Timed }), Some(ToHost::Ack { .. })));
    }

    #[test]
    fn a_strangers_chatter_does_not_keep_a_lost_link_alive() {
        let mut table = Table::driven();
        for sequence in 0..=LOST_TICKS as u16 {
            table.say(2, sequence, ToDevice::Statistics);
            table.control.tick(0);
        }
        assert_eq!(table.mode(), Mode::Stopped(StopReason::LinkLost));
        // Now another may come, and has to say hello.
        assert!(matches!(table.say(2, 999, ToDevice::Hello { schema: SCHEMA }), Some(ToHost::Hello { .. })));
        assert_eq!(table.desk.host(), Some(2));
        assert!(matches!(table.say(2, 1000, ToDevice::Clear), Some(ToHost::Ack { .. })));
    }

    #[test]
    fn no_command_that_moves_follows_the_answer_to_a_stop() {
        let mut table = Table::driven();
        table.control.tick(0);
        // The tick's command has not been sent yet when the stop comes in.
        assert!(matches!(table.say(1, 6, ToDevice::Stop), Some(ToHost::Ack { .. })));
        assert_eq!(table.control.take_report(), None);
    }
}

mod any_bytes {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever comes in, whatever the order, the device answers or keeps silent, and never commands what is not finite.
        #[test]
        fn never_panic(frames in prop::collection::vec((any::<u16>(), prop::collection::vec(any::<u8>(), 0..80)), 1..60)) {
            let mut host = Host::armed(TickMode::Timed);
            host.state(HERE);
            let mut room = [0; FRAME_MAX];
            for (sequence, bytes) in frames {
                let mut frame = vec![pliant_protocol::VERSION];
                frame.extend(sequence.to_le_bytes());
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
}
