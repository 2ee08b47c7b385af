//! Obstacles from messages to the method's types and back: what is sound passes unchanged, and each fault is named.

use heapless::Vec;
use pliant_core::obstacle::ObstacleError;
use pliant_core::shape::Polygon;
use pliant_core::{Matrix, ObstacleSpec, Vector, rotation};
use pliant_protocol::convert::{self, padded};
use pliant_protocol::message::{DeviceError, Field, Obstacle, Shape};
use proptest::prelude::*;

use crate::generate;

const NAN: f32 = f32::NAN;

/// A sound obstacle of two dimensions, and so of three.
fn planar() -> Obstacle {
    Obstacle {
        center: [0.2, 0.21, 0.0],
        rotation: [0.8, 0.0, 0.0, 0.6],
        shape: Shape::Ellipsoid { axes: [0.04, 0.05, 0.0], curvature: 2 },
        wall: false,
        soft_ratio: [1.5, 1.25, 0.0],
        margin: [1.1, 1.2, 0.0],
        reference: [0.01, -0.02, 0.0],
        velocity: [-0.1, 0.2, 0.0],
        angular_velocity: [0.0, 0.0, 0.5],
        growth: -0.02,
    }
}

fn spatial() -> Obstacle {
    Obstacle {
        center: [0.2, 0.21, 0.22],
        rotation: [0.5, -0.5, 0.5, -0.5],
        shape: Shape::Ellipsoid { axes: [0.04, 0.05, 0.06], curvature: 2 },
        soft_ratio: [1.5, 1.25, 1.125],
        margin: [1.1, 1.2, 1.3],
        reference: [0.01, -0.02, 0.03],
        velocity: [-0.1, 0.2, -0.3],
        angular_velocity: [0.7, 0.8, 0.9],
        ..planar()
    }
}

/// Not convex, but seen whole from the origin.
const ARROW: [[f32; 2]; 4] = [[0.1, 0.0], [-0.06, 0.08], [-0.02, 0.0], [-0.06, -0.08]];

fn polygon(vertices: &[[f32; 2]]) -> Shape {
    Shape::Polygon { vertices: Vec::from_slice(vertices).unwrap() }
}

/// With another shape, and a reference point that is inside of any.
fn shaped(shape: Shape) -> Obstacle {
    Obstacle { shape, ..Obstacle::default() }
}

#[test]
fn an_obstacle_is_what_the_message_says() {
    let got = convert::obstacle::<2>(&planar()).unwrap();
    let spec = got.spec();
    assert_eq!(padded(&spec.center), [0.2, 0.21, 0.0]);
    let axes = Vector::<f32, 2>::new(0.04, 0.05);
    assert_eq!(spec.shape, pliant_core::Shape::Ellipsoid { axes, curvature: 2 });
    assert_eq!(padded(&spec.soft_ratio), [1.5, 1.25, 0.0]);
    assert_eq!(padded(&spec.margin), [1.1, 1.2, 0.0]);
    assert_eq!(padded(&spec.reference), [0.01, -0.02, 0.0]);
    assert_eq!(padded(&spec.velocity), [-0.1, 0.2, 0.0]);
    assert_eq!((spec.wall, spec.growth), (false, -0.02));
    assert_eq!(spec.spin, rotation::planar_spin(0.5));
    let angle = 2.0 * 0.6_f32.atan2(0.8);
    assert!((spec.rotation - rotation::planar(angle)).amax() < 1e-6, "{}", spec.rotation);

    let got = convert::obstacle::<3>(&Obstacle { wall: true, ..spatial() }).unwrap();
    let spec = got.spec();
    assert!(spec.wall);
    // The quaternion (1 - i + j - k)/2 takes x to -y, y to -z and z to x.
    let expected = Matrix::<f32, 3>::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    assert!((spec.rotation - expected).amax() < 1e-6, "{}", spec.rotation);
    let arm = Vector::<f32, 3>::new(1.0, 2.0, 3.0);
    assert!((spec.spin * arm - Vector::<f32, 3>::new(0.7, 0.8, 0.9).cross(&arm)).amax() < 1e-6);
}

#[test]
fn every_shape_is_what_the_message_says_and_comes_back() {
    use pliant_core::Shape as Core;
    let (radius, half_length, rounding) = (0.04, 0.05, 0.01);
    let half = Vector::<f32, 3>::new(0.04, 0.05, 0.06);
    let spatial = [
        (Shape::ellipsoid([0.04, 0.05, 0.06]), Core::ellipsoid(half)),
        (Shape::Box { half: [0.04, 0.05, 0.06], rounding }, Core::Box { half, rounding }),
        (Shape::Cylinder { radius, half_length, rounding }, Core::Cylinder { radius, half_length, rounding }),
        (Shape::Capsule { radius, half_length }, Core::Capsule { radius, half_length }),
    ];
    let half = Vector::<f32, 2>::new(0.04, 0.05);
    let planar = [
        (Shape::ellipsoid([0.04, 0.05, 0.0]), Core::ellipsoid(half)),
        (Shape::Box { half: [0.04, 0.05, 0.0], rounding }, Core::Box { half, rounding }),
        (polygon(&ARROW), Core::Polygon(Polygon::new(&ARROW).unwrap())),
    ];
    for wall in [false, true] {
        for (shape, expected) in &spatial {
            let message = Obstacle { wall, growth: 0.03, ..shaped(shape.clone()) };
            let core = convert::obstacle::<3>(&message).unwrap();
            assert_eq!(core.spec().shape, *expected);
            assert_eq!(Obstacle::from(core.spec()), message);
        }
        for (shape, expected) in &planar {
            let ones = [1.0, 1.0, 0.0];
            let message = Obstacle { wall, growth: 0.03, soft_ratio: ones, margin: ones, ..shaped(shape.clone()) };
            let core = convert::obstacle::<2>(&message).unwrap();
            assert_eq!(core.spec().shape, *expected);
            assert_eq!(Obstacle::from(core.spec()), message);
        }
    }
}

#[test]
fn each_fault_of_an_obstacle_is_named() {
    let ok = spatial;
    let not_finite = [
        (Obstacle { center: [0.0, 0.0, NAN], ..ok() }, Field::Center),
        (Obstacle { rotation: [1.0, 0.0, f32::INFINITY, 0.0], ..ok() }, Field::Rotation),
        (Obstacle { soft_ratio: [1.0, NAN, 1.0], ..ok() }, Field::SoftRatio),
        (Obstacle { margin: [1.0, 1.0, f32::NEG_INFINITY], ..ok() }, Field::Margin),
        (Obstacle { reference: [NAN; 3], ..ok() }, Field::Reference),
        (Obstacle { velocity: [NAN; 3], ..ok() }, Field::Velocity),
        (Obstacle { angular_velocity: [NAN; 3], ..ok() }, Field::AngularVelocity),
        (Obstacle { growth: NAN, ..ok() }, Field::Growth),
    ];
    for (bad, field) in not_finite {
        assert_eq!(convert::obstacle::<3>(&bad).unwrap_err(), DeviceError::NotFinite(field));
        assert_eq!(convert::obstacle::<2>(&bad).unwrap_err(), DeviceError::NotFinite(field));
    }
    let out_of_range = [
        (Obstacle { center: [0.0, 0.0, 1000.5], ..ok() }, Field::Center),
        (Obstacle { rotation: [0.5, 0.5, 0.5, 0.6], ..ok() }, Field::Rotation),
        (Obstacle { rotation: [0.0; 4], ..ok() }, Field::Rotation),
        (Obstacle { soft_ratio: [1.0, 1.0, 0.99], ..ok() }, Field::SoftRatio),
        (Obstacle { margin: [1.0, 0.99, 1.0], ..ok() }, Field::Margin),
        (Obstacle { reference: [0.05, 0.0, 0.0], ..ok() }, Field::Reference),
        (Obstacle { velocity: [0.0, 101.0, 0.0], ..ok() }, Field::Velocity),
        (Obstacle { angular_velocity: [-101.0, 0.0, 0.0], ..ok() }, Field::AngularVelocity),
        (Obstacle { growth: -101.0, ..ok() }, Field::Growth),
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
fn each_fault_of_a_shape_is_named() {
    let in_space = |shape| convert::obstacle::<3>(&shaped(shape)).unwrap_err();
    let in_plane = |shape| convert::obstacle::<2>(&shaped(shape)).unwrap_err();
    let ellipsoid = |axes, curvature| Shape::Ellipsoid { axes, curvature };
    let rounded = |half, rounding| Shape::Box { half, rounding };
    let cylinder = |radius, half_length, rounding| Shape::Cylinder { radius, half_length, rounding };
    let capsule = |radius, half_length| Shape::Capsule { radius, half_length };
    let (nan, out) = (DeviceError::NotFinite, DeviceError::OutOfRange);
    let of_both = [
        (ellipsoid([NAN, 0.1, 0.1], 1), nan(Field::Axes)),
        (ellipsoid([0.04, 0.0, 0.1], 1), out(Field::Axes)),
        (ellipsoid([0.04, 1000.5, 0.1], 1), out(Field::Axes)),
        (ellipsoid([0.1; 3], 0), out(Field::Curvature)),
        (ellipsoid([0.1; 3], 9), out(Field::Curvature)),
        (rounded([0.1, NAN, 0.1], 0.01), nan(Field::Axes)),
        (rounded([0.1; 3], f32::INFINITY), nan(Field::Rounding)),
        (rounded([0.1, -0.1, 0.1], 0.01), out(Field::Axes)),
        (rounded([0.1; 3], 0.0), out(Field::Rounding)),
        (rounded([0.1, 0.05, 0.1], 0.06), out(Field::Rounding)),
    ];
    for (shape, error) in of_both {
        assert_eq!(in_space(shape.clone()), error, "{shape:?}");
        assert_eq!(in_plane(shape.clone()), error, "{shape:?}");
    }
    // The third is looked at in space only.
    assert_eq!(in_space(ellipsoid([0.04, 0.05, 0.0], 1)), out(Field::Axes));
    assert_eq!(in_space(rounded([0.04, 0.05, 0.0], 0.01)), out(Field::Axes));

    let spatial = [
        (cylinder(NAN, 0.1, 0.01), nan(Field::Axes)),
        (cylinder(0.1, NAN, 0.01), nan(Field::Axes)),
        (cylinder(0.1, 0.1, NAN), nan(Field::Rounding)),
        (cylinder(0.0, 0.1, 0.01), out(Field::Axes)),
        (cylinder(0.1, -0.1, 0.01), out(Field::Axes)),
        (cylinder(0.1, 0.05, 0.06), out(Field::Rounding)),
        (cylinder(0.05, 0.1, 0.06), out(Field::Rounding)),
        (cylinder(0.05, 0.1, 0.0), out(Field::Rounding)),
        (capsule(NAN, 0.1), nan(Field::Axes)),
        (capsule(0.1, f32::INFINITY), nan(Field::Axes)),
        (capsule(0.0, 0.1), out(Field::Axes)),
        (capsule(0.1, -0.1), out(Field::Axes)),
    ];
    for (shape, error) in spatial {
        assert_eq!(in_space(shape.clone()), error, "{shape:?}");
    }
    assert_eq!(in_plane(cylinder(0.1, 0.1, 0.01)), DeviceError::Dimension);
    assert_eq!(in_plane(capsule(0.1, 0.1)), DeviceError::Dimension);

    let clockwise: std::vec::Vec<_> = ARROW.iter().rev().copied().collect();
    let planar = [
        (vec![[0.1, 0.0], [NAN, 0.1], [-0.1, -0.1]], nan(Field::Vertices)),
        (vec![], out(Field::Vertices)),
        (vec![[0.1, 0.0], [-0.1, 0.1]], out(Field::Vertices)),
        (vec![[2e3, 0.0], [-0.1, 0.1], [-0.1, -0.1]], out(Field::Vertices)),
        (clockwise, out(Field::Vertices)),
        // The origin is outside, then on an edge.
        (vec![[0.2, 0.0], [0.1, 0.1], [0.1, -0.1]], out(Field::Vertices)),
        (vec![[0.1, 0.0], [0.0, 0.1], [0.0, -0.1]], out(Field::Vertices)),
        // Twice round.
        (vec![[0.1, 0.0], [-0.05, 0.1], [-0.05, -0.1], [0.1, 0.0], [-0.05, 0.1], [-0.05, -0.1]], out(Field::Vertices)),
    ];
    for (vertices, error) in planar {
        assert_eq!(in_plane(polygon(&vertices)), error, "{vertices:?}");
    }
    for vertices in [&ARROW[..], &[]] {
        assert_eq!(in_space(polygon(vertices)), DeviceError::Dimension);
    }
    // Within the arrow, but one of its notch's edges is not seen from there.
    let hidden = Obstacle { reference: [-0.045, 0.05, 0.0], ..shaped(polygon(&ARROW)) };
    assert_eq!(convert::obstacle::<2>(&hidden).unwrap_err(), out(Field::Reference));
}

proptest! {
    #[test]
    fn what_passes_is_finite_and_comes_back(message in generate::obstacle(), seed in prop::array::uniform3(0.0..1.0f32)) {
        let _ = convert::obstacle::<2>(&message);
        let _ = convert::obstacle::<3>(&message);
        // Hardly any float is a sound one, so the same again from small numbers.
        let small = |v: [f32; 3]| v.map(|x| (x.to_bits() % 2_001) as f32 * 1e-3 - 1.0);
        let [a, b, c] = seed.map(|x| 0.01 + x);
        let [w, i, j] = small(message.center);
        let k = small(seed)[0];
        let length = (w * w + i * i + j * j + k * k).sqrt();
        prop_assume!(length > 0.1);
        let sound = Obstacle {
            center: small(message.center),
            rotation: [w, i, j, k].map(|x| x / length),
            shape: match message.shape {
                Shape::Ellipsoid { curvature, .. } => {
                    Shape::Ellipsoid { axes: [a, b, c], curvature: 1 + curvature % 8 }
                }
                Shape::Box { .. } => Shape::Box { half: [a, b, c], rounding: a.min(b).min(c) },
                Shape::Cylinder { .. } => Shape::Cylinder { radius: a, half_length: b, rounding: a.min(b) },
                Shape::Capsule { .. } | Shape::Polygon { .. } => Shape::Capsule { radius: a, half_length: b },
            },
            wall: message.wall,
            soft_ratio: small(message.soft_ratio).map(|x| 1.0 + x.abs()),
            margin: small(message.margin).map(|x| 1.0 + x.abs()),
            reference: [0.0; 3],
            velocity: small(message.velocity),
            angular_velocity: small(message.angular_velocity),
            growth: small([message.growth; 3])[0],
        };
        let core = convert::obstacle::<3>(&sound).unwrap();
        let back = Obstacle::from(core.spec());
        // A rotation has two quaternions.
        let cosine: f32 = back.rotation.iter().zip(sound.rotation).map(|(a, b)| a * b).sum();
        prop_assert!((cosine.abs() - 1.0).abs() < 1e-6, "{:?}", back.rotation);
        prop_assert!(back.rotation[0] >= 0.0);
        prop_assert_eq!(Obstacle { rotation: sound.rotation, ..back }, sound);
    }

    #[test]
    fn a_polygon_comes_back(radii in prop::collection::vec(0.05..0.5f32, 3..=12)) {
        let turn = core::f32::consts::TAU / radii.len() as f32;
        let corner = |(i, r): (usize, &f32)| [r * (turn * i as f32).cos(), r * (turn * i as f32).sin()];
        let vertices: std::vec::Vec<_> = radii.iter().enumerate().map(corner).collect();
        let ones = [1.0, 1.0, 0.0];
        let message = Obstacle { soft_ratio: ones, margin: ones, ..shaped(polygon(&vertices)) };
        let core = convert::obstacle::<2>(&message).unwrap();
        prop_assert_eq!(Obstacle::from(core.spec()), message);
    }

    #[test]
    fn a_turn_in_the_plane_comes_back(angle in -4.0..4.0f64) {
        let core = ObstacleSpec::<f64, 2> { rotation: rotation::planar(angle), ..ObstacleSpec::default() };
        let back = convert::obstacle::<2>(&Obstacle::from(&core)).unwrap();
        let turned = back.spec().rotation.map(f64::from);
        prop_assert!((turned - core.rotation).amax() < 3e-7, "{}", turned);
    }
}

#[test]
fn errors_of_the_core_keep_their_names() {
    assert_eq!(DeviceError::from(ObstacleError::Spin), DeviceError::OutOfRange(Field::AngularVelocity));
    assert_eq!(DeviceError::from(ObstacleError::Dimension), DeviceError::Dimension);
    assert_eq!(Field::SoftRatio.name(), "soft");
}
