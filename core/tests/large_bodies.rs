//! Bodies far larger than the robot's way are kept out of, and walls inside of, as exactly as small ones: judged in f64, from the specification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::scalar::Fixed;
use pliant_core::{
    Ageing, Controller, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, Status, Vector,
};

type Point = Vector<f64, 2>;

/// Drives straight at a round body's surface, from 2 cm or twice the skin if that is more; the least distance from it, m, negative inside.
fn least_distance<S: Scalar>(radius: f64, wall: bool, rounded_box: bool, angle: f64) -> f64 {
    let out = Point::new(angle.cos(), angle.sin());
    let center = (out * -radius).map(S::from_f64);
    let length = S::from_f64(radius);
    let half = Vector::<S, 2>::repeat(length);
    let shape = if rounded_box { Shape::Box { half, rounding: length } } else { Shape::ellipsoid(half) };
    let spec = ObstacleSpec { shape, center, wall, ..ObstacleSpec::default() };
    let (center, radius) = (center.map(S::to_f64), length.to_f64());
    let towards = if wall { out } else { -out };
    let forever = S::from_f64(1000.0);
    let ageing = Ageing { time_to_live: forever, growth: S::zero(), hold: forever };
    let mut settings = Settings { ageing, ..Settings::default() };
    let motion = Motion::linear((towards * 5.0).map(S::from_f64), S::one()).unwrap();
    let mut controller: Controller<S, 2, 1> = Controller::new(motion, settings);
    let dt = S::from_f64(0.001);
    let skin = S::EPSILON.to_f64() * 8.0 * radius * radius.max(2.0);
    let mut x = (towards * -(2.0 * skin).max(0.02)).map(S::from_f64);
    // First alone, so that the limit on the acceleration makes it go on straight ahead.
    controller.tick(&RobotState::new(x).unwrap(), dt);
    settings.limits.acceleration = Some(S::from_f64(0.001));
    controller.set_settings(settings);
    controller.upsert(1, Obstacle::new(spec).unwrap(), S::zero()).unwrap();
    let mut least = f64::MAX;
    for _ in 0..2000 {
        let command = controller.tick(&RobotState::new(x).unwrap(), dt);
        assert!(!command.status.contains(Status::INFEASIBLE), "infeasible at {x} by a body at rest");
        x += command.velocity * dt;
        let beyond = (x.map(S::to_f64) - center).norm() - radius;
        least = least.min(if wall { -beyond } else { beyond });
    }
    least
}

fn check<S: Scalar>() {
    for radius in [0.5, 3.1, 7.3, 13.7, 50.3, 121.7, 487.3] {
        for wall in [false, true] {
            for rounded_box in [false, true] {
                let all = (0..40).map(|k| least_distance::<S>(radius, wall, rounded_box, f64::from(k) * 0.157));
                let least = all.fold(f64::MAX, f64::min);
                println!("radius {radius} m, wall {wall}, box {rounded_box}: {least:.2e} m");
                assert!(least > 0.0, "radius {radius} m, wall {wall}, box {rounded_box}: {least:e} m");
            }
        }
    }
}

#[test]
fn in_f64() {
    check::<f64>();
}

#[test]
fn in_f32() {
    check::<f32>();
}

#[test]
fn in_fixed_point() {
    check::<Fixed>();
}
