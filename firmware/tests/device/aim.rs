//! An attractor that moves.

use pliant_protocol::message::{DeviceError, Field, TickMode};
use pliant_protocol::{ToDevice, ToHost};

use crate::host::{HERE, Host, linear};

/// Is each component as expected, to a micrometre a second?
fn close(got: [f32; 3], expected: [f32; 3]) -> bool {
    got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6)
}

#[test]
fn an_aim_moves_the_attractor_until_another_model_comes() {
    let mut host = Host::armed(TickMode::Stepped);
    assert!(close(host.velocity(HERE), [-0.3, -0.1, 0.0]));
    host.ok(ToDevice::Aim { stamp: host.stamp, position: [0.1, 0.2, 0.0], velocity: [0.0; 3] });
    assert!(close(host.velocity(HERE), [-0.2, 0.1, 0.0]));
    host.upload(&linear(2));
    assert!(close(host.velocity(HERE), [-0.3, -0.1, 0.0]));
}

#[test]
fn an_aim_is_carried_on_by_its_age_and_from_then_on() {
    let mut host = Host::armed(TickMode::Stepped);
    host.stamp = 1_000_000;
    host.state(HERE);
    // The next tick is a millisecond after that state.
    let stamp = host.stamp + 1000 - 500_000;
    host.ok(ToDevice::Aim { stamp, position: [0.1, 0.2, 0.0], velocity: [0.1, -0.2, 0.0] });
    // At (0.15, 0.1) now, and its velocity is added to the motion's.
    assert!(close(host.velocity(HERE), [-0.15 + 0.1, -0.2, 0.0]));
    for _ in 0..99 {
        host.state(HERE);
    }
    let later = host.velocity(HERE);
    assert!(close(later, [-0.14 + 0.1, -0.02 - 0.2, 0.0]), "{later:?}");
}

#[test]
fn an_attractor_moves_while_nobody_knows_where_the_robot_is() {
    let mut host = Host::armed(TickMode::Timed);
    host.ok(ToDevice::Aim { stamp: 0, position: [0.0; 3], velocity: [0.1, 0.0, 0.0] });
    for _ in 0..100 {
        assert_eq!(host.tick(), None);
    }
    host.state(HERE);
    let (velocity, _) = host.tick().unwrap();
    assert!(close(velocity, [-0.29 + 0.1, -0.1, 0.0]), "{velocity:?}");
}

#[test]
fn a_bad_aim_is_refused_and_the_one_before_stays() {
    let aim = |stamp, position, velocity| ToDevice::Aim { stamp, position, velocity };
    let mut host = Host::greeted();
    assert_eq!(host.refused(aim(0, [0.0; 3], [0.0; 3])), DeviceError::NoModel);
    host.upload(&linear(2));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    host.stamp = 5_000_000;
    host.state(HERE);
    let now = host.stamp + 1000;
    host.ok(aim(now, [0.1, 0.2, 0.0], [0.0; 3]));
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    for (bad, error) in [
        (aim(now, [f32::NAN, 0.0, 0.0], [0.0; 3]), nan(Field::Attractor)),
        (aim(now, [0.0; 3], [0.0, f32::INFINITY, 0.0]), nan(Field::AttractorVelocity)),
        (aim(now, [0.0, 1001.0, 0.0], [0.0; 3]), out(Field::Attractor)),
        (aim(now, [0.0; 3], [0.0, 101.0, 0.0]), out(Field::AttractorVelocity)),
        (aim(now, [0.0, 0.0, 0.1], [0.0; 3]), DeviceError::Dimension),
        // It was within range when it was seen, and is not any more.
        (aim(now - 2_000_000, [900.0, 0.0, 0.0], [100.0, 0.0, 0.0]), out(Field::Attractor)),
    ] {
        assert_eq!(host.refused(bad.clone()), error, "{bad:?}");
    }
    assert!(close(host.velocity(HERE), [-0.2, 0.1, 0.0]));
}

#[test]
fn an_aim_in_space_has_three_dimensions() {
    let mut host = Host::greeted();
    host.upload(&linear(3));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    host.ok(ToDevice::Aim { stamp: 0, position: [0.0, 0.0, 0.2], velocity: [0.0, 0.0, 0.05] });
    let answer = host.state([0.0, 0.0, 0.1]);
    assert!(
        matches!(answer, Some(ToHost::Command { velocity: [_, _, z], revision: 0, .. }) if (z - 0.15).abs() < 1e-6),
        "{answer:?}"
    );
}
