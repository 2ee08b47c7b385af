//! The obstacle table.

use pliant_protocol::message::{DeviceError, Obstacle, Shape, TickMode};
use pliant_protocol::{ToDevice, ToHost};

use crate::host::{HERE, Host, linear};

#[test]
fn every_command_names_the_table_it_was_computed_from() {
    let mut host = Host::armed(TickMode::Stepped);
    let revision = |answer| match answer {
        Some(ToHost::Command { revision, nearest, .. }) => (revision, nearest),
        other => panic!("{other:?}"),
    };
    let flat = Obstacle::default();
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
        let seen = Obstacle { velocity: [0.1, 0.0, 0.0], shape: Shape::ellipsoid([0.05; 3]), ..Obstacle::default() };
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
fn a_full_table_is_an_error_and_not_a_drop() {
    let mut host = Host::armed(TickMode::Stepped);
    let obstacle = Obstacle { shape: Shape::ellipsoid([0.01; 3]), ..Obstacle::default() };
    for id in 0..64 {
        host.ok(ToDevice::Upsert { id, stamp: 0, obstacle: obstacle.clone() });
    }
    assert_eq!(host.refused(ToDevice::Upsert { id: 64, stamp: 0, obstacle: obstacle.clone() }), DeviceError::TableFull);
    host.ok(ToDevice::Upsert { id: 63, stamp: 0, obstacle });
}

#[test]
fn obstacles_move_while_nobody_knows_where_the_robot_is() {
    let mut host = Host::armed(TickMode::Timed);
    let moving = Obstacle { velocity: [0.1, 0.0, 0.0], shape: Shape::ellipsoid([0.05; 3]), ..Obstacle::default() };
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle: moving });
    for _ in 0..100 {
        assert_eq!(host.tick(), None);
    }
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    let answer = host.state(HERE);
    let expected = ((HERE[0] - 0.01_f32).powi(2) + HERE[1].powi(2)) / 0.0025;
    assert!(matches!(answer, Some(ToHost::Command { gamma, .. }) if (gamma - expected).abs() < 1e-3), "{answer:?}");
}

fn upsert(shape: Shape, wall: bool) -> ToDevice {
    ToDevice::Upsert { id: 5, stamp: 0, obstacle: Obstacle { shape, wall, ..Obstacle::default() } }
}

/// Twelve corners, as many as there can be: a star whose arms are 0.1 m long.
fn star() -> Shape {
    let corner = |i: u32| {
        let (radius, angle) = ([0.1, 0.05][i as usize % 2], core::f32::consts::TAU * i as f32 / 12.0);
        [radius * angle.cos(), radius * angle.sin()]
    };
    Shape::Polygon { vertices: (0..12).map(corner).collect() }
}

#[test]
fn a_polygon_is_an_obstacle_and_inside_out_a_wall() {
    let mut host = Host::armed(TickMode::Stepped);
    host.ok(upsert(star(), false));
    let (gamma, nearest) = host.gamma([0.3, 0.0, 0.0]);
    assert!((gamma - 9.0).abs() < 1e-4 && nearest == Some(5), "{gamma} {nearest:?}");
    host.ok(upsert(star(), true));
    let (gamma, _) = host.gamma([0.05, 0.0, 0.0]);
    assert!((gamma - 4.0).abs() < 1e-4, "{gamma}");
}

#[test]
fn every_shape_runs_in_its_dimension_and_in_no_other() {
    let rounded = Shape::Box { half: [0.1, 0.05, 0.05], rounding: 0.02 };
    let cylinder = Shape::Cylinder { radius: 0.1, half_length: 0.05, rounding: 0.02 };
    let capsule = Shape::Capsule { radius: 0.1, half_length: 0.05 };
    let mut plane = Host::armed(TickMode::Stepped);
    let mut space = Host::greeted();
    space.upload(&linear(3));
    space.ok(ToDevice::Arm { tick: TickMode::Stepped });
    // Each reaches 0.1 m along the first axis.
    let reaches_to_a_tenth = |host: &mut Host, shape: &Shape| {
        host.ok(upsert(shape.clone(), false));
        let (gamma, _) = host.gamma([0.3, 0.0, 0.0]);
        assert!((gamma - 9.0).abs() < 1e-4, "{shape:?}: {gamma}");
    };
    reaches_to_a_tenth(&mut plane, &rounded);
    for shape in [&rounded, &cylinder, &capsule] {
        reaches_to_a_tenth(&mut space, shape);
    }
    assert_eq!(plane.refused(upsert(cylinder, false)), DeviceError::Dimension);
    assert_eq!(plane.refused(upsert(capsule, false)), DeviceError::Dimension);
    assert_eq!(space.refused(upsert(star(), false)), DeviceError::Dimension);
}

#[test]
fn a_sighting_has_grown_by_its_age() {
    let mut host = Host::armed(TickMode::Stepped);
    host.stamp = 1_000_000;
    host.state(HERE);
    let growing = Obstacle { growth: 0.5, ..Obstacle::default() };
    host.ok(ToDevice::Upsert { id: 1, stamp: host.stamp + 1000 - 100_000, obstacle: growing });
    // 5 cm, and 0.5 m/s for 0.1 s.
    let (gamma, _) = host.gamma([0.3, 0.0, 0.0]);
    assert!((gamma - 9.0).abs() < 1e-3, "{gamma}");
}
