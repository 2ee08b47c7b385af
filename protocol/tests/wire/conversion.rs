//! From messages to the method's types and back: what is sound passes unchanged, and each fault is named.

use pliant_core::obstacle::ObstacleError;
use pliant_core::{Component, LpvDs, Matrix, Motion, ObstacleSpec, SteeringPolicy, Vector, rotation};
use pliant_protocol::convert::{self, padded};
use pliant_protocol::message::{DeviceError, Field, Obstacle, Settings, Steering};
use pliant_protocol::model::{self, Model};
use proptest::prelude::*;

use crate::generate;

const NAN: f32 = f32::NAN;

/// A sound obstacle of two dimensions, and so of three.
fn planar() -> Obstacle {
    Obstacle {
        center: [0.2, 0.21, 0.0],
        rotation: [0.8, 0.0, 0.0, 0.6],
        axes: [0.04, 0.05, 0.0],
        soft_ratio: [1.5, 1.25, 0.0],
        margin: [1.1, 1.2, 0.0],
        curvature: 2,
        reference: [0.01, -0.02, 0.0],
        velocity: [-0.1, 0.2, 0.0],
        angular_velocity: [0.0, 0.0, 0.5],
    }
}

fn spatial() -> Obstacle {
    Obstacle {
        center: [0.2, 0.21, 0.22],
        rotation: [0.5, -0.5, 0.5, -0.5],
        axes: [0.04, 0.05, 0.06],
        soft_ratio: [1.5, 1.25, 1.125],
        margin: [1.1, 1.2, 1.3],
        reference: [0.01, -0.02, 0.03],
        velocity: [-0.1, 0.2, -0.3],
        angular_velocity: [0.7, 0.8, 0.9],
        ..planar()
    }
}

#[test]
fn an_obstacle_is_what_the_message_says() {
    let got = convert::obstacle::<2>(&planar()).unwrap();
    let spec = got.spec();
    assert_eq!(padded(&spec.center), [0.2, 0.21, 0.0]);
    assert_eq!(padded(&spec.axes), [0.04, 0.05, 0.0]);
    assert_eq!(padded(&spec.soft_ratio), [1.5, 1.25, 0.0]);
    assert_eq!(padded(&spec.margin), [1.1, 1.2, 0.0]);
    assert_eq!(padded(&spec.reference), [0.01, -0.02, 0.0]);
    assert_eq!(padded(&spec.velocity), [-0.1, 0.2, 0.0]);
    assert_eq!(spec.curvature, 2);
    assert_eq!(spec.spin, rotation::planar_spin(0.5));
    let angle = 2.0 * 0.6_f32.atan2(0.8);
    assert!((spec.rotation - rotation::planar(angle)).amax() < 1e-6, "{}", spec.rotation);

    let got = convert::obstacle::<3>(&spatial()).unwrap();
    let spec = got.spec();
    // The quaternion (1 - i + j - k)/2 takes x to -y, y to -z and z to x.
    let expected = Matrix::<f32, 3>::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    assert!((spec.rotation - expected).amax() < 1e-6, "{}", spec.rotation);
    let arm = Vector::<f32, 3>::new(1.0, 2.0, 3.0);
    assert!((spec.spin * arm - Vector::<f32, 3>::new(0.7, 0.8, 0.9).cross(&arm)).amax() < 1e-6);
}

#[test]
fn each_fault_of_an_obstacle_is_named() {
    let ok = spatial();
    let not_finite = [
        (Obstacle { center: [0.0, 0.0, NAN], ..ok }, Field::Center),
        (Obstacle { rotation: [1.0, 0.0, f32::INFINITY, 0.0], ..ok }, Field::Rotation),
        (Obstacle { axes: [NAN, 0.1, 0.1], ..ok }, Field::Axes),
        (Obstacle { soft_ratio: [1.0, NAN, 1.0], ..ok }, Field::SoftRatio),
        (Obstacle { margin: [1.0, 1.0, f32::NEG_INFINITY], ..ok }, Field::Margin),
        (Obstacle { reference: [NAN; 3], ..ok }, Field::Reference),
        (Obstacle { velocity: [NAN; 3], ..ok }, Field::Velocity),
        (Obstacle { angular_velocity: [NAN; 3], ..ok }, Field::AngularVelocity),
    ];
    for (bad, field) in not_finite {
        assert_eq!(convert::obstacle::<3>(&bad).unwrap_err(), DeviceError::NotFinite(field));
        assert_eq!(convert::obstacle::<2>(&bad).unwrap_err(), DeviceError::NotFinite(field));
    }
    let out_of_range = [
        (Obstacle { center: [0.0, 0.0, 1000.5], ..ok }, Field::Center),
        (Obstacle { rotation: [0.5, 0.5, 0.5, 0.6], ..ok }, Field::Rotation),
        (Obstacle { rotation: [0.0; 4], ..ok }, Field::Rotation),
        (Obstacle { axes: [0.04, 0.05, 0.0], ..ok }, Field::Axes),
        (Obstacle { soft_ratio: [1.0, 1.0, 0.99], ..ok }, Field::SoftRatio),
        (Obstacle { margin: [1.0, 0.99, 1.0], ..ok }, Field::Margin),
        (Obstacle { curvature: 0, ..ok }, Field::Curvature),
        (Obstacle { curvature: 9, ..ok }, Field::Curvature),
        (Obstacle { reference: [0.05, 0.0, 0.0], ..ok }, Field::Reference),
        (Obstacle { velocity: [0.0, 101.0, 0.0], ..ok }, Field::Velocity),
        (Obstacle { angular_velocity: [-101.0, 0.0, 0.0], ..ok }, Field::AngularVelocity),
    ];
    for (bad, field) in out_of_range {
        assert_eq!(convert::obstacle::<3>(&bad).unwrap_err(), DeviceError::OutOfRange(field));
    }
    let not_planar = [
        Obstacle { center: [0.0, 0.0, 0.1], ..planar() },
        Obstacle { rotation: [0.8, 0.6, 0.0, 0.0], ..planar() },
        Obstacle { rotation: [0.8, 0.0, 0.6, 0.0], ..planar() },
        Obstacle { reference: [0.0, 0.0, 0.01], ..planar() },
        Obstacle { velocity: [0.0, 0.0, 0.1], ..planar() },
        Obstacle { angular_velocity: [0.1, 0.0, 0.0], ..planar() },
        Obstacle { angular_velocity: [0.0, 0.1, 0.0], ..planar() },
    ];
    for bad in not_planar {
        assert_eq!(convert::obstacle::<2>(&bad).unwrap_err(), DeviceError::Dimension, "{bad:?}");
    }
}

#[test]
fn each_fault_of_settings_is_named() {
    let ok = Settings { acceleration: Some(2.0), ..Settings::default() };
    assert!(convert::settings(&ok).is_ok());
    type Set = fn(&mut Settings, f32);
    let fields: [(Set, f32, Field); 9] = [
        (|s, x| s.gain = x, -0.1, Field::Gain),
        (|s, x| s.steering = Steering::WithFlow { beta: x }, -0.1, Field::Steering),
        (|s, x| s.speed = x, 0.0, Field::Speed),
        (|s, x| s.acceleration = Some(x), 0.0, Field::Acceleration),
        (|s, x| s.deceleration = x, 0.0, Field::Deceleration),
        (|s, x| s.time_to_live = x, -0.1, Field::Ageing),
        (|s, x| s.growth = x, -0.1, Field::Ageing),
        (|s, x| s.hold = x, 0.1, Field::Ageing), // less than the time to live
        (|s, x| s.hold = x, 3601.0, Field::Ageing),
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
    };
    let core = convert::settings(&wire).unwrap();
    assert!(!core.deformable);
    assert_eq!(core.steering, SteeringPolicy::fixed(0.785));
    assert_eq!((core.gain, core.limits.speed, core.limits.acceleration), (0.01, 0.02, Some(0.03)));
    assert_eq!(core.limits.deceleration, 0.04);
    assert_eq!((core.ageing.time_to_live, core.ageing.growth, core.ageing.hold), (0.05, 0.06, 0.07));
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

proptest! {
    #[test]
    fn what_passes_is_finite_and_comes_back(message in generate::obstacle()) {
        let _ = convert::obstacle::<2>(&message);
        let _ = convert::obstacle::<3>(&message);
        // Hardly any float is a sound one, so the same again from small numbers.
        let small = |v: [f32; 3]| v.map(|x| (x.to_bits() % 2_001) as f32 * 1e-3 - 1.0);
        let [w, i, j] = small(message.center);
        let k = small(message.axes)[0];
        let length = (w * w + i * i + j * j + k * k).sqrt();
        prop_assume!(length > 0.1);
        let sound = Obstacle {
            center: small(message.center),
            rotation: [w, i, j, k].map(|x| x / length),
            axes: small(message.axes).map(|x| 0.01 + x.abs()),
            soft_ratio: small(message.soft_ratio).map(|x| 1.0 + x.abs()),
            margin: small(message.margin).map(|x| 1.0 + x.abs()),
            curvature: 1 + message.curvature % 8,
            reference: [0.0; 3],
            velocity: small(message.velocity),
            angular_velocity: small(message.angular_velocity),
        };
        let core = convert::obstacle::<3>(&sound).unwrap();
        let back = Obstacle::from(core.spec());
        prop_assert_eq!(Obstacle { rotation: sound.rotation, ..back }, sound);
        // A rotation has two quaternions.
        let cosine: f32 = back.rotation.iter().zip(sound.rotation).map(|(a, b)| a * b).sum();
        prop_assert!((cosine.abs() - 1.0).abs() < 1e-6, "{:?}", back.rotation);
        prop_assert!(back.rotation[0] >= 0.0);
    }

    #[test]
    fn a_turn_in_the_plane_comes_back(angle in -4.0..4.0f64) {
        let core = ObstacleSpec::<f64, 2> { rotation: rotation::planar(angle), ..ObstacleSpec::default() };
        let back = convert::obstacle::<2>(&Obstacle::from(&core)).unwrap();
        let turned = back.spec().rotation.map(f64::from);
        prop_assert!((turned - core.rotation).amax() < 3e-7, "{}", turned);
    }

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

#[test]
fn errors_of_the_core_keep_their_names() {
    assert_eq!(Field::from(ObstacleError::Spin), Field::AngularVelocity);
    assert_eq!(Field::from(ObstacleError::SoftRatio).name(), "soft");
}
