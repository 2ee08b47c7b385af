//! Round any polygon at rest the way goes on: no start is stranded before one of its corners.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::shape::Polygon;
use pliant_core::{
    Ageing, Controller, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, SteeringPolicy, Vector,
};
use rand::Rng;
use world::{Random, numbers, random, share, uneven_polygon};

/// Nothing ages, and nothing pushes.
fn settings<S: Scalar>() -> Settings<S> {
    let forever = S::from_f64(1000.0);
    let ageing = Ageing { time_to_live: forever, growth: S::zero(), hold: forever };
    Settings { ageing, steering: SteeringPolicy::WithFlow { beta: S::one() }, ..Settings::default() }
}

/// How long from a start beyond a polygon to the origin before it, s; `None` where it is not reached in half a minute.
fn arrives<S: Scalar>(obstacle: &Obstacle<S, 2>, start: Vector<f64, 2>) -> Option<f64> {
    let dt = 0.004;
    let motion = Motion::linear(Vector::zeros(), S::one()).unwrap();
    let mut controller: Controller<S, 2, 1> = Controller::new(motion, settings());
    controller.upsert(1, obstacle.clone(), S::zero()).unwrap();
    let mut x = start;
    let ticks = (30.0 / dt) as u32;
    (0..ticks).find(|_| {
        let command = controller.tick(&RobotState::new(x.map(S::from_f64)).unwrap(), S::from_f64(dt));
        x += numbers(&command.velocity) * dt;
        x.norm() < 0.01
    })?;
    Some(x.norm())
}

fn obstacle<S: Scalar>(polygon: Polygon<S>, center: [f64; 2], angle: f64) -> Obstacle<S, 2> {
    let (sin, cos) = angle.sin_cos();
    let rotation = [cos, -sin, sin, cos].map(S::from_f64);
    Obstacle::new(ObstacleSpec {
        center: Vector::from(center.map(S::from_f64)),
        rotation: pliant_core::Matrix::from_row_slice(&rotation),
        shape: Shape::Polygon(polygon),
        ..ObstacleSpec::default()
    })
    .unwrap()
}

/// An arrow whose notch is so deep that its edges at the tail turn by more than two thirds of half a turn.
fn arrow<S: Scalar>(notch: f64) -> Polygon<S> {
    let corners = [[0.1, 0.0], [-0.06, 0.08], [notch, 0.0], [-0.06, -0.08]];
    Polygon::new(&corners.map(|v| v.map(S::from_f64))).unwrap()
}

fn from_everywhere<S: Scalar>(seed: u64) {
    let r: &mut Random = &mut random(seed);
    for notch in [-0.05, -0.03, -0.02, -0.01] {
        let arrow = obstacle::<S>(arrow(notch), [0.55, -0.2], 0.0);
        for i in 0..20 {
            let start = Vector::<f64, 2>::new(1.0, -0.59 + 0.04 * f64::from(i));
            assert!(arrives(&arrow, start).is_some(), "a notch at {notch}: stranded from {start}");
        }
    }
    let mut driven = 0;
    while driven < share(2000) {
        let center = [0.4, r.random_range(-0.05..0.05)];
        let body = obstacle(uneven_polygon::<S>(r, 0.15), center, r.random_range(0.0..std::f64::consts::TAU));
        if body.gamma(&Vector::zeros()) <= S::from_f64(1.2) {
            continue;
        }
        for _ in 0..5 {
            let start = Vector::<f64, 2>::new(0.8, r.random_range(-0.25..0.25));
            driven += 1;
            assert!(arrives(&body, start).is_some(), "stranded from {start}: {body:?}");
        }
    }
}

#[test]
fn in_f64() {
    from_everywhere::<f64>(71);
}

#[test]
fn in_f32() {
    from_everywhere::<f32>(72);
}

#[test]
fn in_fixed_point() {
    from_everywhere::<Fixed>(73);
}
