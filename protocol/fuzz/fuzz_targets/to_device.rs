//! A host that says anything: what it sends is refused or understood, and what is understood and passes the checks can
//! be driven with.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant_core::{Controller, Motion, RobotState, Settings, Vector};
use pliant_protocol::ToDevice;
use pliant_protocol::convert::{obstacle, settings, state};
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
            // At the middle, at the end of each semi-axis, and a little off both.
            positions.push(spec.center);
            positions.push(obstacle.reference());
            for i in 0..D {
                let arm = spec.rotation.column(i) * spec.axes[i];
                positions.extend([1.0, spec.margin[i], spec.soft_ratio[i], 1.5].map(|s| spec.center + arm * s));
            }
            controller.upsert(*id, obstacle, 0.05).expect("there is room");
        }
        ToDevice::Configure(wire) => {
            let Ok(settings) = settings(wire) else { return };
            controller.set_settings(settings);
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
