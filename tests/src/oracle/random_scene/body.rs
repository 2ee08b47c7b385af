//! Obstacles: alone, in groups with overlapping soft layers, and with overlapping cores; and a wall around them.

use std::f64::consts::PI;

use nalgebra::DVector;
use rand::Rng;

use super::super::cluster::{Sharing, pairwise};
use super::super::geometry::unit;
use super::super::obstacle::Body;
use super::super::scene::{OracleMethod, OracleObstacle, OracleRotation, OracleShape, OracleSpin};
use super::points::{layer_reach, on_ray};
use super::random::{chance, direction, rounded_vector, uniform, uniform_vector};
use super::shape::core;
use super::{RandomAgeing, Recipe};

/// Places tried before an obstacle is left out.
const TRIES: usize = 40;

/// Obstacles, how old each is, and how they age.
pub(super) fn obstacles(rng: &mut impl Rng, recipe: &Recipe) -> (Vec<OracleObstacle>, RandomAgeing) {
    let moving = chance(rng, recipe.moving);
    let growing = chance(rng, recipe.growing);
    let clusters = chance(rng, recipe.clusters);
    let mut ageing =
        RandomAgeing { time_to_live: 0.5, rate: f64::from(rng.random_range(0..4)) / 64.0, ages: Vec::new() };
    let wall = chance(rng, recipe.walls);
    let count = rng.random_range(recipe.obstacles.clone());
    let mut placed: Vec<OracleObstacle> = Vec::with_capacity(count);
    while placed.len() < count {
        let first_wall = wall && placed.is_empty();
        let mut obstacle = if first_wall { enclosure(rng, recipe) } else { single(rng, recipe) };
        if moving && chance(rng, 0.7) {
            set_moving(rng, &mut obstacle);
        }
        let age = if growing && chance(rng, 0.7) { set_growing(rng, &mut obstacle, &ageing) } else { 0.0 };
        let together = clusters && chance(rng, 0.5);
        let Some(center) = (0..TRIES).find_map(|_| place(rng, recipe, &placed, &obstacle, together)) else {
            break;
        };
        obstacle.center = center;
        placed.push(obstacle);
        ageing.ages.push(age);
    }
    (placed, ageing)
}

/// An obstacle at rest, somewhere.
fn single(rng: &mut impl Rng, recipe: &Recipe) -> OracleObstacle {
    let d = recipe.dimension;
    let center = uniform_vector(rng, d, 1.5);
    let shape = core(rng, recipe, 0.08, 0.5);
    // The factors of a polygon are equal.
    let even = matches!(shape, OracleShape::Polygon { .. });
    let soft_ratio = match rng.random_range(0..10) {
        0 => vec![1.0; d],
        n if n <= 5 || even => vec![uniform(rng, 1.2, 2.2); d],
        _ => (0..d).map(|_| uniform(rng, 1.1, 2.2)).collect(),
    };
    let margin = match rng.random_range(0..4) {
        0 | 1 => vec![1.0; d],
        _ if even => vec![uniform(rng, 1.0, 1.3); d],
        _ => (0..d).map(|_| uniform(rng, 1.0, 1.3)).collect(),
    };
    // Each coordinate at most 0.35 of its extent: Gamma is below 0.4 there even in an ellipsoid in space. Behind a notch of a
    // star that may be outside, or where not all edges are seen.
    let mut reference: Vec<f64> = shape.semi_extents().iter().map(|e| uniform(rng, -0.35 * e, 0.35 * e)).collect();
    if let OracleShape::Polygon { vertices } = &shape {
        while !sees_all(vertices, &reference) {
            reference.iter_mut().for_each(|r| *r *= 0.5);
        }
    }
    OracleObstacle { rotation: rotation(rng, d), soft_ratio, margin, reference, ..OracleObstacle::of(&center, shape) }
}

/// Whether a point is inside of every edge's line, clearly.
fn sees_all(vertices: &[[f64; 2]], point: &[f64]) -> bool {
    let behind = |v: &[f64; 2], w: &[f64; 2], p: &[f64]| (w[0] - v[0]) * (p[1] - v[1]) - (w[1] - v[1]) * (p[0] - v[0]);
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).all(|(v, w)| behind(v, w, point) > 0.2 * behind(v, w, &[0.0, 0.0]))
}

/// A wall around everything.
fn enclosure(rng: &mut impl Rng, recipe: &Recipe) -> OracleObstacle {
    let d = recipe.dimension;
    let shape = core(rng, recipe, 2.4, 3.4);
    let even = matches!(shape, OracleShape::Polygon { .. });
    let ratios = |rng: &mut _, most| {
        let first = uniform(rng, 1.05, most);
        (0..d).map(|i| if even || i == 0 { first } else { uniform(rng, 1.05, most) }).collect()
    };
    OracleObstacle {
        rotation: rotation(rng, d),
        soft_ratio: ratios(rng, 1.5),
        margin: ratios(rng, 1.1),
        reference: uniform_vector(rng, d, 0.3),
        ..OracleObstacle::of(&uniform_vector(rng, d, 0.1), shape).inside_out()
    }
}

fn rotation(rng: &mut impl Rng, dimension: usize) -> OracleRotation {
    if dimension == 2 {
        return OracleRotation::Angle(uniform(rng, -PI, PI));
    }
    let q = direction(rng, 4);
    OracleRotation::Quaternion([q[0], q[1], q[2], q[3]])
}

fn set_moving(rng: &mut impl Rng, obstacle: &mut OracleObstacle) {
    let d = obstacle.center.len();
    obstacle.velocity = uniform_vector(rng, d, 0.5);
    obstacle.spin = if d == 2 {
        OracleSpin::Planar(uniform(rng, -1.0, 1.0))
    } else {
        OracleSpin::Spatial([uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0)])
    };
}

/// Growth or shrinking since some time ago; how long that is. Whoever is old does not turn, so that where it came from is
/// known without a turn.
fn set_growing(rng: &mut impl Rng, obstacle: &mut OracleObstacle, ageing: &RandomAgeing) -> f64 {
    let least = obstacle.shape.growing_extents().into_iter().fold(f64::INFINITY, f64::min);
    let age = f64::from(rng.random_range(0..=24)) / 16.0;
    obstacle.growth = f64::from(rng.random_range(-20..=20)) / 256.0;
    obstacle.grown = obstacle.growth * age;
    if obstacle.grown < -0.3 * least {
        (obstacle.growth, obstacle.grown) = (0.0, 0.0);
    }
    if age >= ageing.time_to_live {
        obstacle.aged = ageing.rate * (age - ageing.time_to_live);
        obstacle.ageing = ageing.rate;
    }
    if age > 0.0 {
        obstacle.spin = OracleSpin::Planar(0.0);
    }
    age
}

/// A place for an obstacle: its core clearly apart from every other, or clearly overlapping where cores go together.
fn place(
    rng: &mut impl Rng,
    recipe: &Recipe,
    placed: &[OracleObstacle],
    obstacle: &OracleObstacle,
    together: bool,
) -> Option<Vec<f64>> {
    let d = obstacle.center.len();
    let neighbours: Vec<&OracleObstacle> = placed.iter().filter(|other| !other.wall).collect();
    let center = if obstacle.wall {
        obstacle.center.clone()
    } else if together && !placed.is_empty() {
        let n = rng.random_range(0..placed.len());
        onto(rng, &placed[n], obstacle)?
    } else if !neighbours.is_empty() && chance(rng, recipe.crowding) {
        let n = rng.random_range(0..neighbours.len());
        beside(rng, neighbours[n], obstacle)?
    } else {
        uniform_vector(rng, d, 1.5)
    };
    let moved = OracleObstacle { center, ..obstacle.clone() };
    let here = Body::new(&moved, d, OracleMethod::Deformable).ok()?;
    let mut met = false;
    for other in placed {
        match pairwise(&Body::new(other, d, OracleMethod::Deformable).ok()?, &here) {
            Sharing::Apart => {}
            Sharing::Common if together => met = true,
            _ => return None,
        }
    }
    (met || !together || placed.is_empty()).then_some(moved.center)
}

/// A centre that brings a point of the soft layer of `obstacle` onto a point of that of `neighbour`, the cores
/// roughly side by side; nothing if one of them has no layer.
fn beside(rng: &mut impl Rng, neighbour: &OracleObstacle, obstacle: &OracleObstacle) -> Option<Vec<f64>> {
    let d = neighbour.center.len();
    let there = Body::new(neighbour, d, OracleMethod::Deformable).ok()?;
    let here = Body::new(obstacle, d, OracleMethod::Deformable).ok()?;
    let ray = direction(rng, d);
    let meeting = in_layer(rng, &there, &ray)?;
    let normal = unit(&there.gradient(&meeting))?;
    // Roughly from the far side, so that the cores do not lie on each other.
    let back = unit(&(here.rotation.tr_mul(&-normal) + direction(rng, d) * 0.5))?;
    let own = in_layer(rng, &here, &back)?;
    Some(rounded_vector(&(&here.center + meeting - own)))
}

/// A centre that brings a point inside `obstacle` onto one near the surface of `neighbour`, inside of it.
fn onto(rng: &mut impl Rng, neighbour: &OracleObstacle, obstacle: &OracleObstacle) -> Option<Vec<f64>> {
    let d = neighbour.center.len();
    let there = Body::new(neighbour, d, OracleMethod::Deformable).ok()?;
    let here = Body::new(obstacle, d, OracleMethod::Deformable).ok()?;
    let (ray, back) = (direction(rng, d), direction(rng, d));
    let depth = if there.wall { 1.0 } else { rng.random_range(0.3..0.95) };
    let meeting = on_ray(&there, &ray, there.reach(&ray, 1.0, false) * depth);
    let own = on_ray(&here, &back, here.reach(&back, 1.0, false) * rng.random_range(0.3..0.8));
    Some(rounded_vector(&(&here.center + meeting - own)))
}

/// A point in the middle part of the soft layer, on a ray of the obstacle's frame.
fn in_layer(rng: &mut impl Rng, body: &Body, ray: &DVector<f64>) -> Option<DVector<f64>> {
    let (hard, soft) = layer_reach(body, ray)?;
    Some(on_ray(body, ray, hard + rng.random_range(0.2..0.8) * (soft - hard)))
}
