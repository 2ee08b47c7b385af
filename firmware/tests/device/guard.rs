//! The guard, on and off.

use pliant_core::Status;
use pliant_protocol::ToDevice;
use pliant_protocol::message::{Obstacle, Settings, TickMode};

use crate::host::Host;

/// Within the core of an obstacle at (0.2, 0), by a tenth of a millimetre.
const WITHIN: [f32; 3] = [0.2499, 0.0, 0.0];
/// Deep in it.
const DEEP: [f32; 3] = [0.21, 0.0, 0.0];

fn beside_an_obstacle(guard: Option<f32>) -> Host {
    let mut host = Host::armed(TickMode::Stepped);
    host.ok(ToDevice::Configure(Settings { guard, ..Settings::default() }));
    let obstacle = Obstacle { center: [0.2, 0.0, 0.0], ..Obstacle::default() };
    host.ok(ToDevice::Upsert { id: 1, stamp: 0, obstacle });
    host
}

#[test]
fn guarded_the_next_sample_is_outside_of_what_it_can_leave() {
    assert!(Settings::default().guard.is_some(), "on, if nobody says otherwise");
    let mut host = beside_an_obstacle(Settings::default().guard);
    let status = host.status(WITHIN);
    assert!(status.contains(Status::GUARDED) && !status.contains(Status::INFEASIBLE), "{status:?}");
    let [x, ..] = host.velocity(WITHIN);
    assert!(WITHIN[0] + x * 1e-3 >= 0.25, "{x}");
    let status = host.status(DEEP);
    assert!(status.contains(Status::GUARDED | Status::INFEASIBLE), "{status:?}");
    // Far away it changes nothing.
    assert!(host.status([0.5, 0.1, 0.0]).is_empty());
}

#[test]
fn unguarded_nothing_changes_what_the_modulation_says() {
    let mut host = beside_an_obstacle(None);
    for position in [WITHIN, DEEP] {
        let status = host.status(position);
        assert!(!status.intersects(Status::GUARDED | Status::INFEASIBLE), "{status:?}");
        let [x, ..] = host.velocity(position);
        assert!(position[0] + x * 1e-3 < 0.25, "{x}");
    }
    // And on again, while it runs.
    host.ok(ToDevice::Configure(Settings { guard: Some(1.0), ..Settings::default() }));
    assert!(host.status(WITHIN).contains(Status::GUARDED));
}
