//! Who is greeted, what may move when, and what makes a tick.

use pliant_firmware::{LATE_TICKS, LOST_STEPPED_TICKS, LOST_TICKS};
use pliant_protocol::message::{DeviceError, Mode, Obstacle, Shape, StopReason, TickMode};
use pliant_protocol::{FRAME_MAX, SCHEMA, ToDevice, ToHost, decode};

use crate::host::{HERE, Host, linear, speed};

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
fn a_late_clock_moves_time_on_and_skips_a_computation() {
    let mut host = Host::armed(TickMode::Timed);
    let moving = Obstacle { velocity: [0.1, 0.0, 0.0], shape: Shape::ellipsoid([0.05; 3]), ..Obstacle::default() };
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
