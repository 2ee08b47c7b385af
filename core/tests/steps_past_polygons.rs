//! No step ends in a polygon, or beyond one that is a wall, however short its edges are: judged in f64, from the corners alone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::{
    Ageing, Controller, Guard, Limits, Motion, Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Shape, Status,
    Vector,
};
use rand::Rng;
use world::{Random, is_long, numbers, random, share, uneven_polygon};

type Point = Vector<f64, 2>;

/// Steps past one polygon.
const STEPS: u64 = 100;

/// The corners of one edge after the other.
fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    corners.iter().copied().zip(corners.iter().skip(1).chain(corners.first()).copied())
}

/// By the parity of the edges that a ray crosses.
fn is_inside(corners: &[Point], x: &Point) -> bool {
    let crosses =
        |(a, b): &(Point, Point)| (a.y > x.y) != (b.y > x.y) && x.x < a.x + (b.x - a.x) * (x.y - a.y) / (b.y - a.y);
    edges(corners).filter(crosses).count() % 2 == 1
}

fn distance(corners: &[Point], x: &Point) -> f64 {
    let from = |(a, b): (Point, Point)| {
        let along = b - a;
        (x - a - along * ((x - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)).norm()
    };
    edges(corners).map(from).fold(f64::MAX, f64::min)
}

/// A place near a corner or an edge.
fn near(r: &mut Random, corners: &[Point]) -> Point {
    let (a, b) = edges(corners).nth(r.random_range(0..corners.len())).unwrap();
    let along = if r.random_bool(0.5) { 0.0 } else { r.random_range(0.0..1.0) };
    let off = Point::new(r.random_range(-1.0..1.0), r.random_range(-1.0..1.0));
    a + (b - a) * along + off * 10f64.powf(r.random_range(-6.0..-0.5))
}

fn campaign<S: Scalar>(seed: u64) {
    let r = &mut random(seed);
    let (dt, forever) = (S::from_f64(0.001), S::from_f64(1000.0));
    let ageing = Ageing { time_to_live: forever, growth: S::zero(), hold: forever };
    let (mut tried, mut infeasible, mut short) = (0, 0, 0);
    while tried < share(1) {
        let polygon = uneven_polygon::<S>(r, 0.3);
        let corners: Vec<Point> = polygon.vertices().iter().map(|v| numbers(&Vector::from(*v))).collect();
        let wall = r.random_bool(0.4);
        let spec = ObstacleSpec { shape: Shape::Polygon(polygon), wall, ..ObstacleSpec::<S, 2>::default() };
        let obstacle = Obstacle::new(spec).unwrap();
        let shortest = edges(&corners).map(|(a, b)| (b - a).norm()).fold(f64::MAX, f64::min);
        for _ in 0..STEPS {
            let start = near(r, &corners).map(S::from_f64);
            let x = numbers(&start);
            // What is nearer than this is on the surface, as far as these numbers can tell.
            if is_inside(&corners, &x) != wall || distance(&corners, &x) < 4e-6 {
                continue;
            }
            let speed = 10f64.powf(r.random_range(-1.0..2.0));
            let way = r.random_range(-3.2..3.2f64);
            let goal = (x + Point::new(way.cos(), way.sin())).map(S::from_f64);
            let guard = Some(Guard { approach: S::from_f64(if r.random_bool(0.5) { 1.0 } else { 0.05 }) });
            let limits = Limits { speed: S::from_f64(speed), acceleration: None, ..Limits::default() };
            let free = Settings { limits, guard, ageing, ..Settings::default() };
            let mut controller: Controller<S, 2, 1> =
                Controller::new(Motion::linear(goal, S::from_f64(speed)).unwrap(), free);
            let state = RobotState::new(start).unwrap();
            // First without the polygon, so that the limit on the acceleration makes it go on straight at it.
            controller.tick(&state, dt);
            let limits = Limits { acceleration: Some(S::from_f64(0.001)), ..limits };
            controller.set_settings(Settings { limits, ..free });
            controller.upsert(0, obstacle.clone(), S::zero()).unwrap();
            let command = controller.tick(&state, dt);
            tried += 1;
            short += u64::from(shortest < 1e-3);
            if command.status.contains(Status::INFEASIBLE) {
                infeasible += 1;
                continue;
            }
            let end = x + numbers(&command.velocity) * 0.001;
            assert_eq!(
                is_inside(&corners, &end),
                wall,
                "{corners:?} (wall: {wall}) entered from {x} to {end}: {command:?}"
            );
        }
    }
    println!("{tried} steps, {short} of them by edges below 1 mm, {infeasible} infeasible");
    assert!(!is_long() || short * 20 > tried, "no short edges were tried");
    assert!(infeasible * 1000 <= tried, "{infeasible} of {tried} steps infeasible by a polygon at rest");
}

#[test]
fn in_f64() {
    campaign::<f64>(1);
}

#[test]
fn in_f32() {
    campaign::<f32>(2);
}

#[test]
fn in_fixed_point() {
    campaign::<Fixed>(3);
}
