//! The guard and polygons: what is farther than a sample may use up changes nothing, and past corners, cuts and notches the command is continuous.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::shape::{MAX_VERTICES, Polygon};
use pliant_core::{
    Controller, Guard, Limits, Motion, Obstacle, ObstacleSpec, RobotState, Settings, Shape, Status, Vector, rotation,
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
        let usable = Polygon::new(&corners).is_some_and(|p| {
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
