//! Whatever finite input, a finite output within the limits: at centres, on boundaries, far away, with f = 0, with twins.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::{
    Controller, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, SteeringPolicy, Vector, rotation,
};
use proptest::prelude::*;

/// Lengths from the smallest to the largest there are.
fn length() -> impl Strategy<Value = f64> {
    (-4.0..3.0f64).prop_map(|e| 10f64.powf(e))
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), -1.0..1.0f64, -1000.0..1000.0f64, (-30.0..3.0f64).prop_map(|e| 10f64.powf(e))]
}

#[derive(Clone, Debug)]
struct Body {
    center: [f64; 3],
    angle: f64,
    axes: [f64; 3],
    soft: [f64; 3],
    curvature: u8,
    reference: [f64; 3],
    velocity: [f64; 3],
}

fn body() -> impl Strategy<Value = Body> {
    (
        prop::array::uniform3(coordinate()),
        -4.0..4.0f64,
        prop::array::uniform3(length()),
        prop::array::uniform3(prop_oneof![Just(1.0), 1.0..3.0f64, Just(100.0)]),
        1..9u8,
        prop::array::uniform3(-0.5..0.5f64),
        prop::array::uniform3(prop_oneof![Just(0.0), -2.0..2.0f64, -100.0..100.0f64]),
    )
        .prop_map(|(center, angle, axes, soft, curvature, reference, velocity)| Body {
            center,
            angle,
            axes,
            soft,
            curvature,
            reference,
            velocity,
        })
}

fn vector<S: Scalar, const D: usize>(v: [f64; 3]) -> Vector<S, D> {
    Vector::from_fn(|i, _| S::from_f64(v[i]))
}

/// Where to stand: somewhere, or at a telling place of the first obstacle.
fn position<S: Scalar, const D: usize>(place: u8, anywhere: [f64; 3], o: &Obstacle<S, D>) -> Vector<S, D> {
    let mut tip = Vector::<S, D>::zeros();
    tip[0] = o.spec().axes[0];
    let on_axis = o.spec().rotation * tip;
    match place {
        0 => o.spec().center,
        1 => o.reference(),
        2 => o.spec().center + on_axis,
        3 => o.spec().center + on_axis * S::from_f64(1.000_001),
        4 => o.spec().center + on_axis * o.spec().soft_ratio[0],
        _ => vector(anywhere),
    }
}

fn check<S: Scalar, const D: usize>(
    bodies: &[Body],
    place: u8,
    anywhere: [f64; 3],
    goal: Option<[f64; 3]>,
    fixed: Option<f64>,
    turn: impl Fn(f64) -> pliant_core::Matrix<S, D>,
) -> Result<(), TestCaseError> {
    let obstacles: Vec<Obstacle<S, D>> = bodies
        .iter()
        .filter_map(|b| {
            let axes: Vector<S, D> = vector(b.axes);
            Obstacle::new(ObstacleSpec {
                center: vector(b.center),
                rotation: turn(b.angle),
                soft_ratio: vector(b.soft),
                curvature: b.curvature,
                reference: vector::<S, D>(b.reference).component_mul(&axes),
                velocity: vector(b.velocity),
                axes,
                ..ObstacleSpec::default()
            })
            .ok()
        })
        .collect();
    let Some(first) = obstacles.first() else { return Ok(()) };
    let x = position(place, anywhere, first);
    let Some(state) = RobotState::new(x) else { return Ok(()) };
    let attractor = goal.map_or(x, vector);
    let steering = match fixed {
        Some(angle) => SteeringPolicy::fixed(S::from_f64(angle)),
        None => SteeringPolicy::WithFlow { beta: S::one() },
    };
    let settings = Settings { steering, ..Settings::default() };
    let motion = Motion::linear(attractor, S::one()).unwrap();
    let mut controller: Controller<S, D, 8> = Controller::new(motion, settings);
    for (id, o) in obstacles.into_iter().enumerate() {
        controller.upsert(id as u16, o, S::zero()).unwrap();
    }
    let command = controller.tick(&state, S::from_f64(0.001));
    let speed = command.velocity.dot(&command.velocity).sqrt();
    prop_assert!(speed.is_finite() && speed <= S::from_f64(0.500_01), "{command:?}");
    prop_assert!(command.gamma.is_finite(), "{command:?}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn every_output_is_finite_and_within_the_limits(
        mut bodies in prop::collection::vec(body(), 1..7),
        twin in any::<bool>(),
        place in 0..8u8,
        anywhere in prop::array::uniform3(coordinate()),
        goal in prop::option::of(prop::array::uniform3(coordinate())),
        fixed in prop::option::of(-4.0..4.0f64),
    ) {
        if twin {
            bodies.push(bodies[0].clone());
        }
        check::<f32, 2>(&bodies, place, anywhere, goal, fixed, |a| rotation::planar(a as f32))?;
        check::<f64, 2>(&bodies, place, anywhere, goal, fixed, rotation::planar)?;
        let about_x = |a: f64| [(a / 2.0).cos(), (a / 2.0).sin(), 0.0, 0.0];
        check::<f32, 3>(&bodies, place, anywhere, goal, fixed, |a| rotation::spatial(about_x(a).map(|x| x as f32)).unwrap())?;
        check::<f64, 3>(&bodies, place, anywhere, goal, fixed, |a| rotation::spatial(about_x(a)).unwrap())?;
    }
}
