//! An uploaded model of any bytes: what is certified moves finitely everywhere.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant_core::Vector;
use pliant_protocol::convert::motion;
use pliant_protocol::model::{MODEL_MAX, Model};

fn drive<const D: usize>(model: &Model) {
    let Ok(motion) = motion::<D>(model) else { return };
    assert!(motion.velocity(motion.attractor()).iter().all(|v| *v == 0.0));
    for x in [0.0, 0.3, -7.0, 1000.0, -1000.0] {
        let velocity = motion.velocity(&Vector::from_element(x));
        assert!(velocity.iter().all(|v| v.is_finite()), "{velocity} at {x}");
    }
}

fuzz_target!(|data: &[u8]| {
    let Ok(model) = Model::from_bytes(data) else { return };
    let mut room = [0; MODEL_MAX];
    let again = model.to_bytes(&mut room).expect("every model fits");
    assert!(again.len() <= data.len());
    let back = Model::from_bytes(again).expect("what was encoded is understood");
    // Not-a-number is not equal to itself, but has the same bytes.
    assert!(back == model || back.to_bytes(&mut [0; MODEL_MAX]) == Ok(again));
    drive::<2>(&model);
    drive::<3>(&model);
});
