//! Scans, which come in pieces.

use pliant_core::Status;
use pliant_protocol::message::{DeviceError, Field, PIECE_MAX, SCAN_MAX, ScanFault, TickMode};
use pliant_protocol::{ToDevice, ToHost};

use crate::host::{HERE, Host, linear};

const RADIUS: f32 = 0.02;

/// A wall at x = 0.1, all of it below HERE but for its last point, which is beside it.
fn wall(points: usize) -> Vec<[f32; 3]> {
    (0..points).map(|i| [0.1, 0.1 - 0.01 * (points - 1 - i) as f32, 0.0]).collect()
}

/// Gamma at HERE of a wall with all its points.
fn gamma_here(radius: f32) -> f32 {
    ((HERE[0] - 0.1) / radius).powi(2)
}

fn piece(stamp: u64, start: u16, total: u16, points: &[[f32; 3]]) -> ToDevice {
    ToDevice::Scan { stamp, start, total, radius: RADIUS, points: points.iter().copied().collect() }
}

fn pieces(stamp: u64, points: &[[f32; 3]]) -> Vec<ToDevice> {
    let cut = |(i, part)| piece(stamp, (i * PIECE_MAX) as u16, points.len() as u16, part);
    points.chunks(PIECE_MAX).enumerate().map(cut).collect()
}

/// Says all of them.
fn send(host: &mut Host, pieces: &[ToDevice]) {
    for piece in pieces {
        host.ok(piece.clone());
    }
}

fn gap(expected: u16) -> DeviceError {
    DeviceError::Scan(ScanFault::Gap { expected })
}

fn other_total(expected: u16) -> DeviceError {
    DeviceError::Scan(ScanFault::Total { expected })
}

fn sees_a_wall(host: &mut Host) -> bool {
    let (gamma, nearest) = host.gamma(HERE);
    assert_eq!(nearest, None, "a scan has no number");
    (gamma / gamma_here(RADIUS) - 1.0).abs() < 1e-4
}

fn sees_nothing(host: &mut Host) -> bool {
    host.gamma(HERE).0 == f32::MAX
}

#[test]
fn a_scan_counts_once_it_is_whole() {
    let mut host = Host::armed(TickMode::Stepped);
    let pieces = pieces(0, &wall(SCAN_MAX));
    assert_eq!(pieces.len(), 8);
    let (last, first) = pieces.split_last().unwrap();
    for piece in first {
        host.ok(piece.clone());
        assert!(sees_nothing(&mut host));
    }
    assert_eq!(host.device.control().revision(), 0);
    host.ok(last.clone());
    assert!(sees_a_wall(&mut host));
    assert_eq!(host.device.control().revision(), 1);
}

#[test]
fn a_scan_replaces_the_one_before_and_none_takes_it_away() {
    let mut host = Host::armed(TickMode::Stepped);
    send(&mut host, &pieces(0, &[[0.3, 0.0, 0.0]]));
    assert!(!sees_a_wall(&mut host));
    send(&mut host, &pieces(0, &wall(40)));
    assert!(sees_a_wall(&mut host));
    host.ok(piece(0, 0, 0, &[]));
    assert!(sees_nothing(&mut host));
    send(&mut host, &pieces(0, &wall(40)));
    assert!(sees_a_wall(&mut host), "the same scan again");
    host.ok(ToDevice::Clear);
    assert!(sees_nothing(&mut host));
    send(&mut host, &pieces(0, &wall(40)));
    assert!(sees_a_wall(&mut host), "and again");
}

#[test]
fn pieces_in_another_order_are_refused_by_name_and_the_scan_stays() {
    let mut host = Host::armed(TickMode::Stepped);
    send(&mut host, &pieces(0, &wall(40)));
    let other = vec![[0.3, 0.0, 0.0]; 48];
    let new = pieces(7, &other);
    assert_eq!(host.refused(new[1].clone()), gap(0), "not begun");
    host.ok(new[0].clone());
    assert_eq!(host.refused(new[2].clone()), gap(16));
    assert_eq!(host.refused(piece(7, 8, 48, &other[..16])), gap(16), "neither there already nor next");
    assert_eq!(host.refused(piece(7, 16, 47, &other[..16])), other_total(48));
    assert_eq!(host.refused(piece(8, 16, 48, &other[..16])), gap(0), "of another scan");
    let ToDevice::Scan { stamp, start, total, points, .. } = new[1].clone() else { unreachable!() };
    assert_eq!(host.refused(ToDevice::Scan { stamp, start, total, radius: 0.03, points }), gap(0));
    assert_eq!(host.refused(piece(7, 40, 48, &other[..16])), other_total(48), "beyond its end");
    assert_eq!(host.refused(piece(7, 0, 2, &other[..3])), other_total(2));
    assert_eq!(host.refused(piece(7, 0, 0, &other[..1])), other_total(0));
    assert!(sees_a_wall(&mut host));
    // None of these has spoilt the scan under way.
    send(&mut host, &new[1..]);
    assert!(!sees_a_wall(&mut host));
}

#[test]
fn a_scan_that_was_broken_off_is_replaced_by_the_next() {
    let mut host = Host::armed(TickMode::Stepped);
    let (old, new) = (pieces(1, &[[0.3, 0.0, 0.0]; 40]), pieces(2, &wall(40)));
    send(&mut host, &old[..2]);
    host.ok(new[0].clone());
    assert_eq!(host.refused(old[2].clone()), gap(0));
    send(&mut host, &new[1..]);
    assert!(sees_a_wall(&mut host));
}

#[test]
fn a_piece_sent_again_is_answered_alike() {
    let mut host = Host::armed(TickMode::Stepped);
    let pieces = pieces(0, &wall(40));
    for piece in &pieces {
        host.ok(piece.clone());
        host.ok(piece.clone());
    }
    assert_eq!(host.device.control().revision(), 1);
    assert!(sees_a_wall(&mut host));
}

#[test]
fn a_scan_ages_from_its_stamp() {
    for (age, grown, expected) in
        [(100_000, 0.0, Status::empty()), (500_000, 0.3, Status::EXTRAPOLATED), (2_000_000, 0.8, Status::HELD)]
    {
        let mut host = Host::armed(TickMode::Stepped);
        host.stamp = 5_000_000;
        host.state(HERE);
        // The next tick is a millisecond after that state.
        let stamp = host.stamp + 1000 - age;
        send(&mut host, &pieces(stamp, &wall(40)));
        let (gamma, _) = host.gamma(HERE);
        // By default it grows by 2 cm/s, from 0.2 s until 1 s.
        let radius = RADIUS + 0.02 * grown;
        assert!((gamma / gamma_here(radius) - 1.0).abs() < 1e-4, "{age}: {gamma}");
        assert_eq!(host.status(HERE), expected);
    }
}

#[test]
fn a_bad_piece_is_refused_and_the_next_good_one_goes_on() {
    let mut host = Host::greeted();
    let good = pieces(0, &wall(20));
    assert_eq!(host.refused(good[0].clone()), DeviceError::NoModel);
    host.upload(&linear(2));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    host.ok(good[0].clone());
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    let single =
        |radius, point| ToDevice::Scan { stamp: 0, start: 0, total: 1, radius, points: [point].into_iter().collect() };
    for (bad, error) in [
        (piece(0, 16, 20, &[[0.1, f32::NAN, 0.0]]), nan(Field::Points)),
        (piece(0, 16, 20, &[[0.1, 1001.0, 0.0]]), out(Field::Points)),
        (piece(0, 16, 20, &[[0.1, 0.1, 0.1]]), DeviceError::Dimension),
        (single(f32::NAN, [0.0; 3]), nan(Field::Radius)),
        (single(0.0, [0.0; 3]), out(Field::Radius)),
        (single(101.0, [0.0; 3]), out(Field::Radius)),
        (piece(0, 0, SCAN_MAX as u16 + 1, &[[0.0; 3]]), out(Field::Points)),
        (piece(0, u16::MAX, u16::MAX, &[[0.0; 3]]), out(Field::Points)),
    ] {
        assert_eq!(host.refused(bad.clone()), error, "{bad:?}");
    }
    assert!(sees_nothing(&mut host));
    host.ok(good[1].clone());
    assert!(sees_a_wall(&mut host));
}

#[test]
fn a_scan_in_space_has_three_dimensions() {
    let mut host = Host::greeted();
    host.upload(&linear(3));
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    send(&mut host, &pieces(0, &[[0.0, 0.0, 0.2]; 20]));
    let answer = host.state([0.0, 0.0, 0.3]);
    assert!(matches!(answer, Some(ToHost::Command { gamma, .. }) if (gamma - 25.0).abs() < 1e-3), "{answer:?}");
}

#[test]
fn a_scan_of_space_does_not_end_up_in_the_plane() {
    let mut host = Host::greeted();
    host.upload(&linear(3));
    let pieces = pieces(0, &[[[0.0, 0.0, 0.2]; 16], [[0.1, 0.1, 0.0]; 16]].concat());
    host.ok(pieces[0].clone());
    host.upload(&linear(2));
    assert_eq!(host.refused(pieces[1].clone()), DeviceError::Dimension);
    assert_eq!(host.refused(pieces[1].clone()), gap(0), "it has to begin anew");
    host.ok(ToDevice::Arm { tick: TickMode::Stepped });
    assert!(sees_nothing(&mut host));
}
