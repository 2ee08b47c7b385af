//! Every scene that is shipped, from many places: all trajectories end at the goal, no core is touched; and fixed point agrees with f64.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::path::PathBuf;

use pliant::scene::Scene;
use pliant_core::shape::Polygon;
use pliant_core::{Controller, Fixed, Obstacle, ObstacleSpec, RobotState, Scalar, Shape, Vector};
use pliant_tests::programs;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Starts on one side of the grid.
const GRID: usize = 40;
/// s between two sights of an obstacle.
const SIGHTING: f64 = 1.0 / 30.0;

fn scenes() -> Vec<(String, Scene)> {
    let folder = programs::root().join("scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    assert!(files.len() >= 17);
    files.iter().map(|f| (f.file_stem().unwrap().to_string_lossy().into_owned(), Scene::load(f).unwrap())).collect()
}

/// Everything of the scene, and some room around it.
fn extent<const D: usize>(scene: &Scene) -> (Vector<f64, D>, Vector<f64, D>) {
    let goal = scene.attractor();
    let mut all = vec![goal];
    all.extend(scene.starts());
    all.extend(scene.obstacles_at(0.0).filter(|o| !o.obstacle.is_wall()).map(|o| o.pose.center));
    let low = Vector::from_fn(|i, _| all.iter().map(|p| p[i]).fold(f64::MAX, f64::min) - 0.06);
    let high = Vector::from_fn(|i, _| all.iter().map(|p| p[i]).fold(f64::MIN, f64::max) + 0.06);
    (low, high)
}

fn gamma<S: Scalar, const D: usize>(controller: &Controller<S, D, 16>, x: &Vector<S, D>) -> f64 {
    let table = controller.table();
    let all = table.iter().map(|e| e.obstacle().gamma(x).to_f64());
    all.fold(table.scan().gamma(x).to_f64(), f64::min)
}

/// Brings what a camera would see at time `t` into the table.
fn see<S: Scalar, const D: usize>(scene: &Scene, controller: &mut Controller<S, D, 16>, t: f64) {
    for (id, obstacle) in scene.core_obstacles::<S, D>(t).unwrap() {
        controller.upsert(id, obstacle, S::zero()).unwrap();
    }
    if let Some(scan) = scene.core_scan().unwrap() {
        controller.set_scan(scan, S::zero());
    }
    if scene.attractor_moves() {
        let (position, velocity) = scene.attractor_at(t);
        let cut = |v: &nalgebra::Vector3<f64>| Vector::from_fn(|i, _| S::from_f64(v[i]));
        assert!(controller.aim(&cut(&position), &cut(&velocity)));
    }
}

struct Ended {
    arrived: bool,
    at: String,
    touched: bool,
}

fn drive<const D: usize>(scene: &Scene, mut x: Vector<f64, D>) -> Option<Ended> {
    const DT: f64 = 0.002;
    let mut controller: Controller<f64, D, 16> = scene.controller(0.0).unwrap();
    if gamma(&controller, &x) <= 1.0 {
        return None;
    }
    let (mut t, mut seen, mut touched) = (0.0, 0.0, false);
    while t < 60.0 {
        if t - seen >= SIGHTING {
            see(scene, &mut controller, t);
            seen = t;
        }
        let command = controller.tick(&RobotState::new(x).unwrap(), DT);
        touched |= command.gamma < 1.0;
        x += command.velocity * DT;
        t += DT;
        let goal = controller.motion().attractor();
        if (x - goal).norm() < 0.01 {
            return Some(Ended { arrived: true, at: format!("{x:?}"), touched });
        }
    }
    Some(Ended { arrived: false, at: format!("{x:?}"), touched })
}

fn grid<const D: usize>(name: &str, scene: &Scene) -> Option<String> {
    let (low, high) = extent::<D>(scene);
    let mut lost = Vec::new();
    let (mut tried, mut touched) = (0, 0);
    for i in 0..GRID * GRID {
        let share = |k: usize| (k as f64 + 0.5) / GRID as f64;
        let (u, v) = (share(i % GRID), share(i / GRID));
        // In space a slanted sheet through the box.
        let at = [u, v, 0.5 * (u + v)];
        let start = Vector::from_fn(|d, _| low[d] + (high[d] - low[d]) * at[d]);
        let Some(ended) = drive::<D>(scene, start) else { continue };
        tried += 1;
        touched += usize::from(ended.touched);
        if !ended.arrived {
            lost.push(format!("{start:?} -> {}", ended.at));
        }
    }
    println!("{name}: {tried} starts, {} did not arrive, {touched} were touched", lost.len());
    lost.iter().take(5).for_each(|l| println!("    {l}"));
    let missed = !lost.is_empty() || touched > 0;
    missed.then(|| format!("{name}: {} lost, {touched} touched", lost.len()))
}

#[test]
fn from_a_grid_of_starts_every_trajectory_arrives() {
    let wrong: Vec<String> = scenes()
        .iter()
        .filter_map(|(name, scene)| match scene.dimension() {
            2 => grid::<2>(name, scene),
            _ => grid::<3>(name, scene),
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The obstacle as fixed point holds it, to the last digit, in double precision.
fn held<const D: usize>(o: &Obstacle<Fixed, D>) -> Obstacle<f64, D> {
    let (n, v) = (|x: Fixed| x.to_f64(), |x: &Vector<Fixed, D>| x.map(|x| x.to_f64()));
    let spec = o.spec();
    let shape = match &spec.shape {
        Shape::Ellipsoid { axes, curvature } => Shape::Ellipsoid { axes: v(axes), curvature: *curvature },
        Shape::Box { half, rounding } => Shape::Box { half: v(half), rounding: n(*rounding) },
        Shape::Cylinder { radius, half_length, rounding } => {
            Shape::Cylinder { radius: n(*radius), half_length: n(*half_length), rounding: n(*rounding) }
        }
        Shape::Capsule { radius, half_length } => Shape::Capsule { radius: n(*radius), half_length: n(*half_length) },
        Shape::Polygon(polygon) => {
            let corners: Vec<[f64; 2]> = polygon.vertices().iter().map(|c| c.map(n)).collect();
            Shape::Polygon(Polygon::new(&corners).unwrap())
        }
    };
    let spec = ObstacleSpec {
        center: v(&spec.center),
        rotation: spec.rotation.map(n),
        shape,
        wall: spec.wall,
        soft_ratio: v(&spec.soft_ratio),
        margin: v(&spec.margin),
        reference: v(&spec.reference),
        velocity: v(&spec.velocity),
        spin: spec.spin.map(n),
        growth: n(spec.growth),
    };
    Obstacle::new(spec).unwrap()
}

/// Brings what a camera would see at time `t`, as fixed point holds it, into both tables.
fn see_alike<const D: usize>(
    scene: &Scene,
    double: &mut Controller<f64, D, 16>,
    fixed: &mut Controller<Fixed, D, 16>,
    t: f64,
) {
    see(scene, fixed, t);
    see(scene, double, t);
    for entry in fixed.table().iter() {
        double.upsert(entry.id(), held(entry.obstacle()), 0.0).unwrap();
    }
}

/// The largest error of fixed point against what is allowed, over some ticks.
fn compare<const D: usize>(name: &str, scene: &Scene, ticks: u32, r: &mut ChaCha8Rng) -> Option<String> {
    let (low, high) = extent::<D>(scene);
    let (mut worst, mut compared, mut beyond) = (0.0f64, 0, 0u32);
    while compared < ticks {
        let mut x: Vector<f64, D> = Vector::from_fn(|d, _| r.random_range(low[d]..high[d]));
        let mut t = r.random_range(0.0..2.0);
        let mut double: Controller<f64, D, 16> = scene.controller(t).unwrap();
        let mut fixed: Controller<Fixed, D, 16> = scene.controller(t).unwrap();
        see_alike(scene, &mut double, &mut fixed, t);
        if gamma(&double, &x) <= 1.01 {
            continue;
        }
        for n in 1..=1000 {
            // In the skin (15 um) the guard's push changes with the last digits.
            if gamma(&double, &x) <= 1.002 {
                break;
            }
            let state = x.map(Fixed::from_f64);
            // What both see, here and of the obstacles, is the same to the last digit of the coarser.
            let y = state.map(|x| x.to_f64());
            let one = double.tick(&RobotState::new(y).unwrap(), 0.001).velocity;
            let other =
                fixed.tick(&RobotState::new(state).unwrap(), Fixed::from_f64(0.001)).velocity.map(|v| v.to_f64());
            let share = (one - other).norm() / (1e-3 + 0.005 * one.norm());
            beyond += u32::from(share > 1.0);
            if share > worst {
                worst = share;
                if share > 1.0 {
                    println!("{name}: {share:.3} at {y:?}, t = {t}, Gamma {}: {one:?} {other:?}", gamma(&double, &y));
                }
            }
            compared += 1;
            x += one * 0.001;
            t += 0.001;
            if n % 33 == 0 {
                see_alike(scene, &mut double, &mut fixed, t);
            }
        }
    }
    println!("{name}: at worst {worst:.3} of what is allowed, in {compared} ticks, {beyond} beyond it");
    (beyond > 0).then(|| format!("{name}: {worst}, {beyond} beyond"))
}

#[test]
fn fixed_point_agrees_with_double_precision() {
    let scenes = scenes();
    let wanted: u32 = std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let each = wanted.div_ceil(scenes.len() as u32);
    let r = &mut ChaCha8Rng::seed_from_u64(1);
    let wrong: Vec<String> = scenes
        .iter()
        .filter_map(|(name, scene)| match scene.dimension() {
            2 => compare::<2>(name, scene, each, r),
            _ => compare::<3>(name, scene, each, r),
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
