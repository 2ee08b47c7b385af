//! Settings, skills, scans and attractors from messages to the method's types and back: what is sound passes unchanged,
//! and each fault is named.

use pliant_core::{Component, LpvDs, Matrix, Motion, SteeringPolicy, Vector};
use pliant_protocol::convert::{self, padded};
use pliant_protocol::message::{DeviceError, Field, SCAN_MAX, Settings, Steering};
use pliant_protocol::model::{self, Model};
use proptest::prelude::*;

use crate::generate;

const NAN: f32 = f32::NAN;

#[test]
fn each_fault_of_settings_is_named() {
    let ok = Settings { acceleration: Some(2.0), ..Settings::default() };
    assert!(convert::settings(&ok).is_ok());
    type Set = fn(&mut Settings, f32);
    let fields: [(Set, f32, Field); 11] = [
        (|s, x| s.gain = x, -0.1, Field::Gain),
        (|s, x| s.steering = Steering::WithFlow { beta: x }, -0.1, Field::Steering),
        (|s, x| s.speed = x, 0.0, Field::Speed),
        (|s, x| s.acceleration = Some(x), 0.0, Field::Acceleration),
        (|s, x| s.deceleration = x, 0.0, Field::Deceleration),
        (|s, x| s.time_to_live = x, -0.1, Field::Ageing),
        (|s, x| s.growth = x, -0.1, Field::Ageing),
        (|s, x| s.hold = x, 0.1, Field::Ageing), // less than the time to live
        (|s, x| s.hold = x, 3601.0, Field::Ageing),
        (|s, x| s.guard = Some(x), 0.0, Field::Guard),
        (|s, x| s.guard = Some(x), 1.01, Field::Guard),
    ];
    for (set, beyond, field) in fields {
        for (x, error) in [
            (NAN, DeviceError::NotFinite(field)),
            (f32::INFINITY, DeviceError::NotFinite(field)),
            (beyond, DeviceError::OutOfRange(field)),
        ] {
            let mut bad = ok;
            set(&mut bad, x);
            assert_eq!(convert::settings(&bad), Err(error));
        }
    }
    let spun = Settings { steering: Steering::Fixed { angle: NAN }, ..ok };
    assert_eq!(convert::settings(&spun), Err(DeviceError::NotFinite(Field::Steering)));
}

#[test]
fn settings_are_what_the_message_says() {
    let wire = Settings {
        deformable: false,
        steering: Steering::Fixed { angle: 0.785 },
        gain: 0.01,
        speed: 0.02,
        acceleration: Some(0.03),
        deceleration: 0.04,
        time_to_live: 0.05,
        growth: 0.06,
        hold: 0.07,
        guard: Some(0.08),
    };
    let core = convert::settings(&wire).unwrap();
    assert!(!core.deformable);
    assert_eq!(core.steering, SteeringPolicy::fixed(0.785));
    assert_eq!((core.gain, core.limits.speed, core.limits.acceleration), (0.01, 0.02, Some(0.03)));
    assert_eq!(core.limits.deceleration, 0.04);
    assert_eq!((core.ageing.time_to_live, core.ageing.growth, core.ageing.hold), (0.05, 0.06, 0.07));
    assert_eq!(core.guard.map(|guard| guard.approach), Some(0.08));
    let unguarded = Settings { guard: None, ..wire };
    assert_eq!(convert::settings(&unguarded).unwrap().guard, None);
    assert_eq!(Settings::from(&convert::settings(&unguarded).unwrap()).guard, None);
    let back = Settings::from(&core);
    assert_eq!(Settings { steering: wire.steering, ..back }, wire);
    assert!(matches!(back.steering, Steering::Fixed { angle } if (angle - 0.785).abs() < 1e-6));
}

fn stable() -> LpvDs<f32, 3> {
    let component = |weight, x: f32| Component {
        log_weight: weight,
        mean: Vector::<f32, 3>::new(x, 0.2, 0.3),
        whitening: Matrix::<f32, 3>::new(1.0, 0.0, 0.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0),
        a: Matrix::<f32, 3>::new(-1.0, 0.5, 0.1, -0.5, -1.5, 0.2, -0.1, -0.2, -2.0),
    };
    let p = Matrix::<f32, 3>::new(1.0, 0.01, 0.02, 0.01, 1.1, 0.03, 0.02, 0.03, 1.2);
    LpvDs::new(Vector::<f32, 3>::new(0.5, 0.25, 0.125), p, &[component(-1.5, 0.1), component(-0.5, 0.4)]).unwrap()
}

fn flat_model() -> Model {
    let component = model::Component {
        log_weight: -1.0,
        mean: [0.1, 0.2, 0.0],
        whitening: [2.0, 0.5, 3.0, 0.0, 0.0, 0.0],
        a: [-1.0, 0.5, 0.0, -0.25, -1.5, 0.0, 0.0, 0.0, 0.0],
    };
    let motion = model::Motion::Lpv {
        attractor: [0.5, 0.25, 0.0],
        lyapunov: [1.0, 0.1, 0.0, 1.2, 0.0, 0.0],
        components: heapless::Vec::from_slice(&[component; 2]).unwrap(),
    };
    Model { dimension: 2, motion }
}

#[test]
fn a_learnt_skill_comes_back_bit_for_bit() {
    let lpv = stable();
    let model = Model::from(&lpv);
    assert_eq!(model.dimension, 3);
    let back = convert::motion::<3>(&model).unwrap();
    assert_eq!(back, Motion::Lpv(lpv.certify().unwrap()));

    let planar = convert::motion::<2>(&flat_model()).unwrap();
    let Motion::Lpv(lpv) = &planar else { panic!("{planar:?}") };
    assert_eq!(lpv.components()[1].a, Matrix::<f32, 2>::new(-1.0, 0.5, -0.25, -1.5));
    assert_eq!(lpv.components()[1].whitening, Matrix::<f32, 2>::new(2.0, 0.0, 0.5, 3.0));
    assert_eq!(*lpv.lyapunov(), Matrix::<f32, 2>::new(1.0, 0.1, 0.1, 1.2));
    assert_eq!(Model::from(&**lpv), flat_model());
    assert_eq!(convert::motion::<3>(&flat_model()), Err(DeviceError::Dimension));
}

#[test]
fn each_fault_of_a_skill_is_named() {
    type Parts<'a> = (&'a mut [f32; 3], &'a mut [f32; 6], &'a mut model::Component);
    let with = |change: &dyn Fn(Parts)| {
        let mut model = flat_model();
        if let model::Motion::Lpv { attractor, lyapunov, components } = &mut model.motion {
            change((attractor, lyapunov, &mut components[1]));
        }
        convert::motion::<2>(&model).unwrap_err()
    };
    use DeviceError::{Certificate, Dimension, NotFinite, OutOfRange};
    assert_eq!(with(&|(x, _, _)| x[1] = NAN), NotFinite(Field::Attractor));
    assert_eq!(with(&|(x, _, _)| x[1] = 1e4), OutOfRange(Field::Attractor));
    assert_eq!(with(&|(_, p, _)| p[0] = NAN), NotFinite(Field::Lyapunov));
    assert_eq!(with(&|(_, p, _)| p[0] = 1e7), OutOfRange(Field::Lyapunov));
    assert_eq!(with(&|(_, _, c)| c.log_weight = NAN), NotFinite(Field::Prior));
    assert_eq!(with(&|(_, _, c)| c.log_weight = 1e7), OutOfRange(Field::Prior));
    assert_eq!(with(&|(_, _, c)| c.mean[0] = NAN), NotFinite(Field::Mean));
    assert_eq!(with(&|(_, _, c)| c.mean[0] = -1e4), OutOfRange(Field::Mean));
    assert_eq!(with(&|(_, _, c)| c.whitening[5] = NAN), NotFinite(Field::Whitening));
    assert_eq!(with(&|(_, _, c)| c.whitening[0] = 1e7), OutOfRange(Field::Whitening));
    assert_eq!(with(&|(_, _, c)| c.a[8] = f32::INFINITY), NotFinite(Field::Matrix));
    assert_eq!(with(&|(_, _, c)| c.a[0] = 1e5), OutOfRange(Field::Matrix));

    assert_eq!(with(&|(x, _, _)| x[2] = 0.1), Dimension);
    for i in [2, 4, 5] {
        assert_eq!(with(&|(_, p, _)| p[i] = 0.1), Dimension);
    }
    assert_eq!(with(&|(_, _, c)| c.mean[2] = 0.1), Dimension);
    for i in [3, 4, 5] {
        assert_eq!(with(&|(_, _, c)| c.whitening[i] = 0.1), Dimension);
    }
    for i in [2, 5, 6, 7, 8] {
        assert_eq!(with(&|(_, _, c)| c.a[i] = 0.1), Dimension);
    }
    assert_eq!(with(&|(_, p, _)| p[3] = -1.0), Certificate { component: None });
    assert_eq!(with(&|(_, _, c)| c.a[4] = 0.5), Certificate { component: Some(1) });

    let empty = model::Motion::Lpv { attractor: [0.0; 3], lyapunov: [1.0; 6], components: heapless::Vec::new() };
    assert_eq!(convert::motion::<3>(&Model { dimension: 3, motion: empty }), Err(OutOfRange(Field::Components)));
    let linear = |attractor, gain| {
        convert::motion::<3>(&Model { dimension: 3, motion: model::Motion::Linear { attractor, gain } }).unwrap_err()
    };
    assert_eq!(linear([NAN; 3], 1.0), NotFinite(Field::Attractor));
    assert_eq!(linear([1e4; 3], 1.0), OutOfRange(Field::Attractor));
    assert_eq!(linear([0.0; 3], NAN), NotFinite(Field::LinearGain));
    assert_eq!(linear([0.0; 3], 1001.0), OutOfRange(Field::LinearGain));
}

#[test]
fn a_scan_is_what_the_message_says_and_each_fault_is_named() {
    let points = [[0.1, 0.2, 0.3], [-0.4, -0.5, -0.6]];
    let scan = convert::scan::<3>(&points, 0.05).unwrap();
    assert_eq!(scan.points().iter().map(padded).collect::<Vec<_>>(), points);
    assert_eq!(scan.radius(), 0.05);
    assert_eq!(convert::scan::<2>(&points, 0.05), Err(DeviceError::Dimension));
    assert_eq!(convert::scan::<2>(&[[0.1, 0.2, 0.0]], 0.05).unwrap().points().len(), 1);
    assert!(convert::scan::<3>(&[points[0]; SCAN_MAX], 0.05).is_ok());
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    assert_eq!(convert::scan::<3>(&[points[0]; SCAN_MAX + 1], 0.05), Err(out(Field::Points)));
    assert_eq!(convert::scan::<3>(&[points[0], [0.0, 0.0, NAN]], 0.05), Err(nan(Field::Points)));
    assert_eq!(convert::scan::<3>(&[points[0], [0.0, 0.0, 1000.5]], 0.05), Err(out(Field::Points)));
    assert_eq!(convert::scan::<3>(&points, f32::INFINITY), Err(nan(Field::Radius)));
    for radius in [0.0, -0.05, 101.0] {
        assert_eq!(convert::scan::<3>(&points, radius), Err(out(Field::Radius)));
    }
}

#[test]
fn an_attractor_is_what_the_message_says_and_each_fault_is_named() {
    let (position, velocity) = ([0.5, 0.25, 0.125], [1.0, -2.0, 4.0]);
    let target = convert::target::<3>(&position, &velocity).unwrap();
    assert_eq!((padded(target.position()), padded(target.velocity())), (position, velocity));
    assert_eq!(padded(&target.after(0.25)), [0.75, -0.25, 1.125]);
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    assert_eq!(convert::target::<3>(&[NAN; 3], &velocity), Err(nan(Field::Attractor)));
    assert_eq!(convert::target::<3>(&position, &[0.0, f32::INFINITY, 0.0]), Err(nan(Field::AttractorVelocity)));
    assert_eq!(convert::target::<3>(&[0.0, 1000.5, 0.0], &velocity), Err(out(Field::Attractor)));
    assert_eq!(convert::target::<3>(&position, &[0.0, 0.0, -101.0]), Err(out(Field::AttractorVelocity)));
    assert_eq!(convert::target::<2>(&position, &[0.0; 3]), Err(DeviceError::Dimension));
    assert_eq!(convert::target::<2>(&[0.0; 3], &velocity), Err(DeviceError::Dimension));
}

proptest! {
    #[test]
    fn any_settings_are_answered(message in generate::settings()) {
        if let Ok(core) = convert::settings(&message) {
            prop_assert_eq!(core.check(), Ok(()));
        }
    }

    #[test]
    fn any_model_is_answered(message in generate::model()) {
        let _ = convert::motion::<2>(&Model { dimension: 2, ..message.clone() });
        let _ = convert::motion::<3>(&Model { dimension: 3, ..message });
    }
}
