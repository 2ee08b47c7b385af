//! Which obstacles overlap is found piece by piece, and ticks come in between.

use pliant_core::Status;
use pliant_protocol::message::{Obstacle, Shape, TickMode};
use pliant_protocol::{ToDevice, ToHost};

use crate::host::{HERE, Host};
use crate::peers::Table;

/// Balls in a row, each overlapping the next.
fn row() -> impl Iterator<Item = ToDevice> {
    (0..16).map(|id| {
        let center = [0.1 + 0.01 * f32::from(id), 0.05, 0.0];
        let shape = Shape::ellipsoid([0.006; 3]);
        ToDevice::Upsert { id, stamp: 0, obstacle: Obstacle { center, shape, ..Obstacle::default() } }
    })
}

/// What a tick commands.
fn tick(table: &mut Table) -> ([f32; 3], u16) {
    table.control.tick(0);
    match table.control.take_report() {
        Some(ToHost::Command { velocity, status, .. }) => (velocity, status),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_tick_does_not_wait_for_the_search_for_overlaps() {
    let mut table = Table::driven();
    let mut sequences = 6..;
    let mut say = |table: &mut Table, message| table.say(1, sequences.next().unwrap(), message);
    for upsert in row() {
        assert!(matches!(say(&mut table, upsert), Some(ToHost::Ack { .. })));
        // Each has only been put there, and the tick is computed all the same.
        let (velocity, status) = tick(&mut table);
        assert!(velocity[0] < 0.0 && status & Status::CLUSTER.bits() == 0);
        // So that it is no lost link, nor a late state.
        say(&mut table, ToDevice::State { stamp: 0, position: HERE });
    }
    let mut pieces = 0;
    while table.control.settle() {
        pieces += 1;
        if pieces % 16 == 0 {
            say(&mut table, ToDevice::State { stamp: 0, position: HERE });
        }
        tick(&mut table);
    }
    // Two neighbours each, of which one pair is compared for both, and a reference point for each but the root.
    assert!((2 * 15..80).contains(&pieces), "{pieces}");
    let (velocity, status) = tick(&mut table);
    assert_ne!(status & Status::CLUSTER.bits(), 0);
    assert!(!table.control.settle());
    // As if no tick had come in between, for all are still young.
    let mut host = Host::armed(TickMode::Stepped);
    row().for_each(|upsert| host.ok(upsert));
    assert_eq!(velocity, host.velocity(HERE));
    assert!(host.status(HERE).contains(Status::CLUSTER));
}

#[test]
fn a_stepped_run_knows_all_overlaps_of_its_table() {
    let mut table = Table::driven();
    table.say(1, 6, ToDevice::Arm { tick: TickMode::Stepped });
    for (sequence, upsert) in (7..).zip(row()) {
        table.say(1, sequence, upsert);
    }
    let answer = table.say(1, 100, ToDevice::State { stamp: 0, position: HERE });
    assert!(
        matches!(answer, Some(ToHost::Command { status, .. }) if status & Status::CLUSTER.bits() != 0),
        "{answer:?}"
    );
    assert!(!table.control.settle());
}
