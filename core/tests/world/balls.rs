//! Ellipsoids alone, that close in on the robot: two mirrored about it, a swarm from all sides, or some so large that they are nearly flat.

use super::{Random, World, gamma, motion, numbers, on_grid, pressed, random, settings, turn, vector, within};
use pliant_core::{Controller, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Shape, Vector};
use rand::Rng;

fn direction<const D: usize>(r: &mut Random) -> Vector<f64, D> {
    loop {
        let v: Vector<f64, D> = vector(&within(r, 1.0));
        if v.norm() > 0.1 {
            return v.normalize();
        }
    }
}

/// A ball of this size, m, or an ellipsoid with no axis below 0.4 of it, that comes along -away and whose surface is `gap` (m) from x.
fn closing<S: Scalar, const D: usize>(
    r: &mut Random,
    x: &Vector<f64, D>,
    away: &Vector<f64, D>,
    (size, gap, speed, ball): (f64, f64, f64, bool),
) -> Option<Obstacle<S, D>> {
    let axes = [(); 3].map(|()| size * if ball { 1.0 } else { r.random_range(0.4..1.0) });
    let spec =
        ObstacleSpec::<S, D> { shape: Shape::ellipsoid(vector(&axes)), rotation: turn(r), ..ObstacleSpec::default() };
    let towards = numbers(&Obstacle::new(spec.clone()).ok()?.surface(&(-away).map(S::from_f64)));
    let center = (x - towards * (1.0 + gap / towards.norm())).map(S::from_f64);
    Obstacle::new(ObstacleSpec { center, velocity: (away * -speed).map(S::from_f64), ..spec }).ok()
}

/// A controller among them, and a start outside of all.
pub fn world<S: Scalar, const D: usize>(seed: u64) -> Option<World<S, D>> {
    let r = &mut random(seed);
    let mut controller: Controller<S, D, 40> = Controller::new(motion(r), settings(r));
    controller.set_settings(pressed(r, *controller.settings()));
    let x = Vector::<f64, D>::from_fn(|_, _| 0.0) + vector::<f64, D>(&on_grid(within(r, 0.4)));
    // It often rests at its goal, where there is nothing that it wants.
    if r.random_bool(0.5) {
        controller.set_motion(Motion::linear(x.map(S::from_f64), S::one()).unwrap());
    }
    let obstacles: Vec<Option<Obstacle<S, D>>> = match r.random_range(0..3u8) {
        0 => {
            let size = 10f64.powf(r.random_range(-2.3..-0.8));
            let how = (size, size + r.random_range(0.0..0.02), r.random_range(0.5..2.0), true);
            let away = direction(r);
            [away, -away].iter().map(|away| closing(r, &x, away, how)).collect()
        }
        1 => {
            let (size, when) = (r.random_range(0.003..0.03), r.random_range(0.01..0.05));
            let one = |r: &mut Random| {
                let (away, speed, ball) = (direction(r), r.random_range(0.3..2.0), r.random_bool(0.5));
                let gap = speed * when + size * r.random_range(0.0..2.0);
                closing(r, &x, &away, (size, gap, speed, ball))
            };
            (0..r.random_range(2..40)).map(|_| one(r)).collect()
        }
        _ => {
            let first = direction::<D>(r);
            let one = |r: &mut Random, i: u32| {
                let away = match i {
                    0 => first,
                    1 => (direction::<D>(r) * 10f64.powf(r.random_range(-5.0..-0.5)) - first).normalize(),
                    _ => direction(r),
                };
                // What is much larger is kept off by more than the judge asks for, since rounding of its coordinates is as large.
                let sizes = match (S::FLOATS, S::EPSILON.to_f64() > 1e-9) {
                    (false, _) => -0.7..-0.3,
                    (true, true) => 0.0..0.9,
                    (true, false) => 0.0..1.9,
                };
                let size = 10f64.powf(r.random_range(sizes));
                let (gap, speed) = (r.random_range(5e-6..2e-4), 10f64.powf(r.random_range(-3.5..0.3)));
                let ball = r.random_bool(0.5);
                closing(r, &x, &away, (size, gap, speed, ball))
            };
            (0..r.random_range(2..5)).map(|i| one(r, i)).collect()
        }
    };
    for (id, obstacle) in (0..).zip(obstacles.into_iter().flatten()) {
        controller.upsert(id, obstacle, S::zero()).unwrap();
    }
    let state = RobotState::new(x.map(S::from_f64))?;
    (gamma(&controller, state.position()) >= S::one()).then_some(())?;
    Some(World { start: numbers(state.position()), controller })
}
