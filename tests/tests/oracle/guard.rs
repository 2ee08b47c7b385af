//! The guard's command against brute force over the half-spaces of the page, and where its steps end.

use pliant_core::{RobotState, Status};
use pliant_tests::oracle::random_scene::{PointKind, RandomAgeing, RandomScene, Recipe, generate_from};
use pliant_tests::oracle::{Guarded, OracleShape, carried, evaluate, guarded, half_spaces, violations};

use super::convert::{as_used, controller, vector};
use super::{decided, size};

/// Allowed difference of the command, in m/s: where boundaries meet at a flat angle, the corner is less certain than they are.
const ALLOWED: f64 = 1e-7;

#[derive(Debug, Default)]
struct Compared {
    free: usize,
    changed: usize,
    /// Of these, where the command is at the bound of a polygon's half-space.
    polygons: usize,
    infeasible: usize,
    /// Where the half-spaces leave nothing, and yet a way out was found.
    others: usize,
    /// Where the page leaves a half-space open or rounding decides which it is, so that only the end of the step was looked at.
    ends: usize,
}

impl Compared {
    fn check(&self) {
        assert!(self.free > 2000 && self.changed > 500 && self.polygons > 150 && self.infeasible > 20, "{self:?}");
        assert!(self.ends < (self.free + self.changed) / 5, "{self:?}");
    }
}

fn compare<const D: usize>(seed: u64, random: &RandomScene, dt: f64, compared: &mut Compared) {
    let start = controller::<D>(&random.scene, &random.ageing);
    let scene = as_used(&random.scene, &start);
    let (speed, alpha) = (scene.limits.speed, scene.guard.unwrap());
    let mut next = carried(&scene, dt).unwrap();
    let RandomAgeing { time_to_live, rate, ages } = &random.ageing;
    for (obstacle, age) in next.obstacles.iter_mut().zip(ages) {
        // One may come of age within the step.
        obstacle.aged = rate * (age + dt - time_to_live).max(0.0);
        obstacle.ageing = if age + dt >= *time_to_live { *rate } else { 0.0 };
    }
    let is_polygon = |i: &usize| matches!(scene.obstacles[*i].shape, OracleShape::Polygon { .. });
    let polygons: Vec<usize> = (0..scene.obstacles.len()).filter(is_polygon).collect();
    for point in &random.points {
        let wanted = evaluate(&scene, &point.x, None).unwrap();
        let spaces = half_spaces(&next, &point.x, &wanted.limited, dt).unwrap();
        if !decided(&scene, &wanted) || point.kind == PointKind::Far {
            continue;
        }
        let mut controller = controller::<D>(&random.scene, &random.ageing);
        let command = controller.tick(&RobotState::new(vector(&point.x)).unwrap(), dt);
        let u: Vec<f64> = command.velocity.iter().copied().collect();
        let place = || format!("seed {seed}, {:?} at {:?}: {command:?}, wanted {wanted:?}", point.kind, point.x);
        assert!(size(&u) <= speed * (1.0 + 1e-12), "{}", place());
        if !(spaces.complete && spaces.determined) {
            let ends = violations(&next, &point.x, &u, dt).unwrap();
            let inside = ends.iter().find(|violation| violation.gamma < 1.0 - 1e-6);
            assert!(inside.is_none() || command.status.contains(Status::INFEASIBLE), "{}: {inside:?}", place());
            compared.ends += 1;
            continue;
        }
        let theirs = guarded(&spaces, &point.x, &wanted.limited, speed, alpha, dt);
        let Some(best) = theirs.velocity else {
            if !command.status.contains(Status::INFEASIBLE) {
                // Another way out was found.
                let ends = violations(&next, &point.x, &u, dt).unwrap();
                assert!(ends.iter().all(|violation| violation.gamma > 1.0 - 1e-6), "{}: {ends:?}", place());
                compared.others += 1;
                continue;
            }
            let missed = Guarded::missed(&spaces, &point.x, &u, alpha, dt);
            assert!((missed - theirs.violation).abs() < ALLOWED * (1.0 + missed), "{} {missed} {theirs:?}", place());
            compared.infeasible += 1;
            continue;
        };
        let off: Vec<f64> = u.iter().zip(&best).map(|(a, b)| a - b).collect();
        assert!(size(&off) < ALLOWED * speed.max(1.0), "{}\n{best:?}", place());
        let change: Vec<f64> = wanted.limited.iter().zip(&best).map(|(a, b)| a - b).collect();
        if size(&change) > 1e-6 {
            assert!(command.status.contains(Status::GUARDED), "{}", place());
            compared.changed += 1;
            let mut of_polygons = spaces.clone();
            of_polygons.all.retain(|space| polygons.contains(&space.obstacle));
            if Guarded::missed(&of_polygons, &point.x, &best, alpha, dt) > -ALLOWED {
                compared.polygons += 1;
            }
        } else {
            compared.free += 1;
        }
        for violation in violations(&next, &point.x, &u, dt).unwrap() {
            // What is allowed in the command is allowed where it ends.
            assert!(violation.gamma > 1.0 - 1e-6, "{}: {violation:?}", place());
        }
    }
}

fn compare_all(recipe: impl Fn(usize) -> Recipe, seeds: impl IntoIterator<Item = u64>, steps: [f64; 2]) -> Compared {
    let mut compared = Compared::default();
    for seed in seeds {
        let dimension = if seed % 2 == 0 { 2 } else { 3 };
        let mut random = generate_from(&recipe(dimension), seed, 4);
        let scene = &mut random.scene;
        scene.guard = Some(scene.guard.unwrap_or(0.02));
        // The first command comes from rest; here it may jump.
        scene.limits.acceleration = None;
        for dt in steps {
            match dimension {
                2 => compare::<2>(seed, &random, dt, &mut compared),
                _ => compare::<3>(seed, &random, dt, &mut compared),
            }
        }
    }
    println!("{compared:?}");
    compared
}

#[test]
fn the_guard_is_the_nearest_velocity_among_things_at_rest() {
    let still = |d| Recipe { moving: 0.0, growing: 0.0, drifting: 0.0, ..Recipe::new(d) };
    // The last is beyond the corner of a wall.
    compare_all(still, (0..300).chain([3502]), [0.01, 0.1]).check();
}

#[test]
fn the_guard_looks_one_sample_ahead_among_moving_things() {
    let moving = |d| Recipe { moving: 1.0, growing: 0.5, ..Recipe::new(d) };
    compare_all(moving, 1000..1300, [0.002, 0.01]).check();
}
