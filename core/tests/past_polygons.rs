//! The guard and polygons: what is farther than a sample may use up changes nothing, and past corners, cuts and notches the command is continuous.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::shape::{MAX_VERTICES, Polygon};
use pliant_core::{
    Ageing, Controller, Guard, Limits, Motion, Obstacle, ObstacleSpec, RobotState, Settings, Shape, Status, Vector,
    rotation,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

mod world;

type V = Vector<f64, 2>;

const DT: f64 = 0.001;
const SPEED: f64 = 0.3;
const APPROACH: f64 = 0.05;

/// Corners of a polygon about the origin, none nearer than 3 cm, and each edge seen from there; of some the corners lie on few rings, for right and flat
/// angles.
fn corners(r: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    loop {
        let n = r.random_range(3..=MAX_VERTICES);
        let mut angles: Vec<f64> = (0..n).map(|_| r.random_range(0.0..std::f64::consts::TAU)).collect();
        angles.sort_by(f64::total_cmp);
        let rough = r.random_bool(0.5);
        let corners: Vec<[f64; 2]> = angles
            .iter()
            .map(|a| {
                let far: f64 = if rough { r.random_range(0.05..0.3) } else { 0.2 };
                [far * a.cos(), far * a.sin()]
            })
            .collect();
        let usable = Polygon::new(&corners).is_ok_and(|p| {
            let spec = ObstacleSpec { shape: Shape::Polygon(p), ..ObstacleSpec::<f64, 2>::default() };
            Obstacle::new(spec).is_ok()
        });
        if usable {
            return corners;
        }
    }
}

/// How far a point is from a polygon's edges, m.
fn away(corners: &[[f64; 2]], x: &V) -> f64 {
    (0..corners.len())
        .map(|i| {
            let (v, w) = (V::from(corners[i]), V::from(corners[(i + 1) % corners.len()]));
            let along = ((x - v).dot(&(w - v)) / (w - v).norm_squared()).clamp(0.0, 1.0);
            (x - (v + (w - v) * along)).norm()
        })
        .fold(f64::MAX, f64::min)
}

fn controller(corners: &[[f64; 2]], wall: bool, goal: V) -> Controller<f64, 2, 4> {
    let limits = Limits { speed: SPEED, ..Limits::default() };
    let settings = Settings { limits, guard: Some(Guard { approach: APPROACH }), ..Settings::default() };
    let mut c = Controller::new(Motion::linear(goal, 10.0).unwrap(), settings);
    let shape = Shape::Polygon(Polygon::new(corners).unwrap());
    let spec = ObstacleSpec { shape, wall, ..ObstacleSpec::default() };
    c.upsert(0, Obstacle::new(spec).unwrap(), 0.0).unwrap();
    c
}

#[test]
fn a_polygon_farther_than_a_sample_may_use_up_changes_nothing() {
    let r = &mut ChaCha8Rng::seed_from_u64(1);
    let clear = SPEED * DT / APPROACH + 4e-5;
    let (mut tried, mut changed) = (0, Vec::new());
    let all = world::share(5);
    while tried < all {
        let corners = corners(r);
        let wall = r.random_bool(0.3);
        for _ in 0..100 {
            let x = V::new(r.random_range(-0.4..0.4), r.random_range(-0.4..0.4));
            let goal = x + rotation::planar(r.random_range(-3.2..3.2)) * V::new(1.0, 0.0);
            let mut c = controller(&corners, wall, goal);
            let far = away(&corners, &x);
            let gamma = c.table().iter().next().unwrap().obstacle().gamma(&x);
            if gamma <= 1.0 || !(clear..3.0 * clear).contains(&far) {
                continue;
            }
            tried += 1;
            let command = c.tick(&RobotState::new(x).unwrap(), DT);
            if command.status.contains(Status::GUARDED) {
                changed.push(format!("{corners:?} wall {wall} {x:?} {far} {goal:?}: {command:?}"));
            }
        }
    }
    println!("{} of {tried}: {:#?}", changed.len(), &changed[..changed.len().min(3)]);
    assert!(changed.is_empty());
}

/// The edges of one of its pieces are gone on from to both sides of its only notch, which is the nearest corner of that outline.
#[test]
fn from_inside_a_polygon_with_one_notch_it_is_driven_out() {
    let corners = [
        [0.1038267954459597, 0.027176393779581615],
        [0.11717786528662774, 0.26505905264198115],
        [-0.14188584463844633, 0.11326728325009451],
        [-0.17000507558166095, -0.05553093404160905],
        [-0.00956105115008004, -0.22963731917823982],
        [0.18715178734161436, -0.13291567371352855],
        [0.1251337626247358, -0.000753389448882238],
    ];
    let x = V::new(-0.00803637994309836, -0.0012765686117041097);
    let command = controller(&corners, false, x).tick(&RobotState::new(x).unwrap(), DT);
    assert!(command.velocity.norm() > 0.9 * SPEED, "{command:?}");
}

#[test]
fn from_inside_a_polygon_it_is_driven_out() {
    let r = &mut ChaCha8Rng::seed_from_u64(2);
    let (mut tried, mut left) = (0, Vec::new());
    let all = world::share(50);
    while tried < all {
        let corners = corners(r);
        for _ in 0..100 {
            let x = V::new(r.random_range(-0.3..0.3), r.random_range(-0.3..0.3));
            // There already, so that it wants nothing.
            let mut c = controller(&corners, false, x);
            if c.table().iter().next().unwrap().obstacle().gamma(&x) > 0.999 {
                continue;
            }
            tried += 1;
            let command = c.tick(&RobotState::new(x).unwrap(), DT);
            if !command.status.contains(Status::GUARDED) || command.velocity.norm() < 1e-3 {
                left.push(format!("{corners:?} {x:?}: {command:?}"));
            }
        }
    }
    println!("{} of {tried}: {:#?}", left.len(), &left[..left.len().min(3)]);
    assert!(left.is_empty());
}

/// Past the star and the bracket of `scenes/polygon-star.toml` to its attractor, which draws at 1/s: the least speed, as a share of what the attractor and
/// the limit ask for, and the largest change of the velocity in two samples, m/s: round a corner it turns within that, and when the first falls is chance.
fn past_the_star(start: V) -> (f64, f64) {
    const MOST: f64 = 0.4;
    let goal = V::new(0.42, 0.0);
    let ageing = Ageing { time_to_live: 3600.0, growth: 0.02, hold: 3600.0 };
    let limits = Limits { speed: MOST, ..Limits::default() };
    let settings = Settings { limits, ageing, ..Settings::default() };
    let mut c: Controller<f64, 2, 4> = Controller::new(Motion::linear(goal, 1.0).unwrap(), settings);
    let star: &[[f64; 2]] = &[
        [0.140, 0.000],
        [0.053, 0.038],
        [0.043, 0.133],
        [-0.020, 0.062],
        [-0.113, 0.082],
        [-0.065, 0.000],
        [-0.113, -0.082],
        [-0.020, -0.062],
        [0.043, -0.133],
        [0.053, -0.038],
    ];
    let bracket: &[[f64; 2]] =
        &[[0.11, -0.03], [0.11, 0.03], [0.03, 0.03], [0.03, 0.11], [-0.03, 0.11], [-0.03, -0.03]];
    for (id, corners, center, angle) in [(0, star, V::new(-0.08, 0.03), 0.3), (1, bracket, V::new(0.20, -0.12), 1.5)] {
        let shape = Shape::Polygon(Polygon::new(corners).unwrap());
        let soft_ratio = V::repeat(1.0 + 1.35_f64.ln());
        let spec =
            ObstacleSpec { shape, center, rotation: rotation::planar(angle), soft_ratio, ..ObstacleSpec::default() };
        c.upsert(id, Obstacle::new(spec).unwrap(), 0.0).unwrap();
    }
    let (mut x, mut before) = (start, [None; 2]);
    let (mut slowest, mut jump, mut guarded) = (f64::MAX, 0.0_f64, 0);
    while (goal - x).norm() > 0.05 {
        let command = c.tick(&RobotState::new(x).unwrap(), DT);
        assert!(command.gamma > 1.0 && !command.status.contains(Status::INFEASIBLE), "{x:?} {command:?}");
        guarded += u32::from(command.status.contains(Status::GUARDED));
        slowest = slowest.min(command.velocity.norm() / (goal - x).norm().min(MOST));
        jump = before[0].map_or(jump, |before: V| jump.max((command.velocity - before).norm()));
        before = [before[1], Some(command.velocity)];
        x += command.velocity * DT;
    }
    assert!(guarded > 20, "the guard has no say: {guarded}");
    (slowest, jump)
}

#[test]
fn past_corners_and_cuts_it_is_neither_slowed_down_nor_let_go_in_a_jump() {
    for start in [V::new(-0.15, -0.30), V::new(-0.42, 0.02)] {
        let (slowest, jump) = past_the_star(start);
        println!("from {start:?}: {slowest} of the speed, {jump} m/s");
        assert!(slowest > 0.55 && jump < 0.3, "from {start:?}: {slowest} of the speed, {jump} m/s");
    }
}
