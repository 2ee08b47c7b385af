//! Rooms with little space: walls that are thin along an axis or small all round, that shrink, move and turn, and a few obstacles in them.

use super::{Kind, Random, World, motion, obstacle, pressed, random, settings, turn, uneven_polygon, vector, within};
use super::{gamma, numbers};
use pliant_core::{Controller, Matrix, Obstacle, ObstacleSpec, RobotState, Scalar, Shape, rotation};
use rand::Rng;

/// From millimetres to decimetres; the one axis at least that is thin below 5 cm.
pub fn narrow<S: Scalar, const D: usize>(r: &mut Random) -> Shape<S, D> {
    let s = S::from_f64;
    let least = S::MIN_AXIS.to_f64() * 1.01;
    let log = |r: &mut Random, low: f64, high: f64| 10f64.powf(r.random_range(low..high)).max(least);
    let small = r.random_bool(0.3);
    let mut sides = [(); 3].map(|()| if small { log(r, -3.0, -1.3) } else { log(r, -1.5, -0.3) });
    sides[r.random_range(0..D)] = log(r, -3.0, -1.3);
    let shortest = sides[..D].iter().fold(f64::MAX, |m, x| m.min(*x));
    let rounding = |r: &mut Random, most: f64| s((most * r.random_range(0.05..0.99f64)).max(least).min(most));
    match r.random_range(0..6u8) {
        0 | 1 => Shape::Ellipsoid { axes: vector(&sides), curvature: r.random_range(1..=8) },
        2 if D == 3 => {
            let rounding = rounding(r, sides[0].min(sides[2]));
            Shape::Cylinder { radius: s(sides[0]), half_length: s(sides[2]), rounding }
        }
        3 if D == 3 => Shape::Capsule { radius: s(sides[0]), half_length: s(sides[2]) },
        2 if D == 2 => {
            let size = log(r, -1.3, -0.5);
            Shape::Polygon(uneven_polygon(r, size))
        }
        _ => Shape::Box { half: vector(&sides), rounding: rounding(r, shortest) },
    }
}

/// Up to this fast, m/s, and 2.5 times as many rad/s; its size changes up to as fast.
fn wall<S: Scalar, const D: usize>(r: &mut Random, speed: f64) -> Option<Obstacle<S, D>> {
    let shape = narrow(r);
    let margin = if r.random_bool(0.6) { [1.0; 3] } else { [(); 3].map(|()| r.random_range(1.0..1.4f64)) };
    let margin = if let Shape::Polygon(_) = shape { [margin[0]; 3] } else { margin };
    let of_it = |r: &mut Random| if r.random_bool(0.4) { speed * 10f64.powf(r.random_range(-3.0..0.0)) } else { 0.0 };
    let (fast, turning, growing) = (of_it(r), of_it(r) * 2.5, of_it(r));
    let spin = rotation::spatial_spin(
        &(nalgebra::Vector3::from(if D == 2 { [0.0, 0.0, 1.0] } else { within(r, 0.57) }) * turning),
    );
    Obstacle::new(ObstacleSpec {
        shape,
        wall: true,
        center: vector(&within(r, 0.3)),
        rotation: turn(r),
        margin: vector(&margin),
        soft_ratio: vector(&[if r.random_bool(0.5) { 1.0 } else { r.random_range(1.0..2.5) }; 3]),
        velocity: vector(&within(r, fast / 1.75 + 1e-12)),
        spin: Matrix::from_fn(|i, j| S::from_f64(spin[(i, j)])),
        // Mostly it becomes smaller.
        growth: S::from_f64(if r.random_bool(0.8) { -growing } else { growing }),
        ..ObstacleSpec::default()
    })
    .ok()
}

/// A controller in such a room, and a start in its free space.
pub fn world<S: Scalar, const D: usize>(seed: u64, speed: f64) -> Option<World<S, D>> {
    let r = &mut random(seed);
    let mut controller: Controller<S, D, 40> = Controller::new(motion(r), settings(r));
    controller.set_settings(pressed(r, *controller.settings()));
    let room = wall::<S, D>(r, speed)?;
    let center = room.spec().center;
    // From the middle to the surface itself.
    let place = |r: &mut Random| {
        let far =
            if r.random_bool(0.3) { 1.0 - 10f64.powf(r.random_range(-6.0..-1.0)) } else { r.random_range(0.0..1.0) };
        center + (room.surface(&vector(&within(r, 1.0))) - center) * S::from_f64(far)
    };
    controller.upsert(1000, room.clone(), S::zero()).unwrap();
    let kind = Kind { obstacles: 1, speed, walls: false, scans: false, odd: true, thin: false };
    for id in 0..r.random_range(0..3u16) * u16::from(r.random_bool(0.5)) {
        if let Some(o) = obstacle::<S, D>(r, &kind) {
            let moved = ObstacleSpec { center: place(r), ..o.spec().clone() };
            controller.upsert(id, Obstacle::new(moved).unwrap(), S::zero()).unwrap();
        }
    }
    (0..50).find_map(|_| {
        let state = RobotState::new(place(r))?;
        (gamma(&controller, state.position()) >= S::one()).then_some(())?;
        Some(World { controller: controller.clone(), start: numbers(state.position()) })
    })
}
