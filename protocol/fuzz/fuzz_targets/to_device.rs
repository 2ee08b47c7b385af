//! A host that says anything: what it sends is refused or understood, and what is understood and passes the checks can
//! be driven with.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant_core::{Controller, Motion, RobotState, Settings, Vector};
use pliant_protocol::ToDevice;
use pliant_protocol::convert::{obstacle, scan, settings, state, target};
use pliant_protocol_fuzz::understood;

const ATTRACTOR: f32 = 0.1;
/// Greatest speed there is a setting for, with a little for rounding, in m/s.
const FASTEST: f32 = 100.01;

fn drive<const D: usize>(message: &ToDevice) {
    let attractor = Vector::from_element(ATTRACTOR);
    let motion = Motion::linear(attractor, 1.0).expect("a sound motion");
    let mut controller = Controller::<f32, D, 2>::new(motion, Settings::default());
    let mut positions = vec![attractor, attractor * 2.0];
    match message {
        ToDevice::Upsert { id, obstacle: wire, .. } => {
            let Ok(obstacle) = obstacle::<D>(wire) else { return };
            let spec = obstacle.spec();
            // At the middle, on both surfaces along each axis, and a little off.
            positions.push(spec.center);
            positions.push(obstacle.reference());
            for i in 0..D {
                let axis: Vector<f32, D> = spec.rotation.column(i).into();
                for surface in [obstacle.surface(&axis), obstacle.soft_surface(&-axis)] {
                    positions.extend([0.99, 1.0, 1.5].map(|s| spec.center + (surface - spec.center) * s));
                }
            }
            controller.upsert(*id, obstacle, 0.05).expect("there is room");
        }
        ToDevice::Configure(wire) => {
            let Ok(settings) = settings(wire) else { return };
            controller.set_settings(settings);
        }
        ToDevice::Scan { radius, points, .. } => {
            let Ok(scan) = scan::<D>(points, *radius) else { return };
            for point in scan.points() {
                positions.extend([0.0, *radius, 2.0 * radius].map(|r| point.add_scalar(r)));
            }
            controller.set_scan(scan, 0.05);
        }
        ToDevice::Aim { position, velocity, .. } => {
            let Ok(target) = target::<D>(position, velocity) else { return };
            positions.push(*target.position());
            controller.aim(&target.after(0.05), target.velocity());
        }
        ToDevice::State { position, .. } => {
            let Ok(state) = state::<D>(position) else { return };
            positions = vec![*state.position()];
        }
        _ => return,
    }
    for position in positions {
        let Some(state) = RobotState::new(position) else { continue };
        let command = controller.tick(&state, 1e-3);
        assert!(command.velocity.norm() <= FASTEST, "{} at {}", command.velocity, position);
    }
}

fuzz_target!(|data: &[u8]| {
    if let Some(message) = understood::<ToDevice>(data) {
        drive::<2>(&message);
        drive::<3>(&message);
    }
});
