//! Obstacles, alone and in groups with overlapping soft layers.

use std::f64::consts::PI;

use nalgebra::DVector;
use rand::Rng;

use super::super::geometry::unit;
use super::super::obstacle::Body;
use super::super::scene::{OracleMethod, OracleObstacle, OracleRotation, OracleSpin};
use super::Recipe;
use super::points::{layer_reach, on_ray};
use super::random::{chance, direction, rounded_vector, uniform, uniform_vector};

/// Places tried beside another obstacle before one is taken anywhere.
const TRIES: usize = 40;

pub(super) fn obstacles(rng: &mut impl Rng, recipe: &Recipe) -> Vec<OracleObstacle> {
    let moving = chance(rng, recipe.moving);
    let count = rng.random_range(recipe.obstacles.clone());
    let mut placed: Vec<OracleObstacle> = Vec::with_capacity(count);
    for _ in 0..count {
        let mut obstacle = shape(rng, recipe);
        if moving && chance(rng, 0.7) {
            set_moving(rng, &mut obstacle);
        }
        if !placed.is_empty() && chance(rng, recipe.crowding) {
            let neighbour = placed[rng.random_range(0..placed.len())].clone();
            if let Some(center) = beside(rng, &neighbour, &obstacle) {
                obstacle.center = center;
            }
        }
        placed.push(obstacle);
    }
    placed
}

/// An obstacle at rest, somewhere.
fn shape(rng: &mut impl Rng, recipe: &Recipe) -> OracleObstacle {
    let d = recipe.dimension;
    let center = uniform_vector(rng, d, 1.5);
    let axes: Vec<f64> = (0..d).map(|_| uniform(rng, 0.08, 0.5)).collect();
    let soft_ratio = match rng.random_range(0..10) {
        0 => vec![1.0; d],
        1..=5 => vec![uniform(rng, 1.2, 2.2); d],
        _ => (0..d).map(|_| uniform(rng, 1.1, 2.2)).collect(),
    };
    let margin = if chance(rng, 0.5) { vec![1.0; d] } else { (0..d).map(|_| uniform(rng, 1.0, 1.3)).collect() };
    // Each coordinate at most 0.35 of its axis: Gamma is below 0.4 there even in space.
    let reference = axes.iter().map(|a| uniform(rng, -0.35 * a, 0.35 * a)).collect();
    OracleObstacle {
        rotation: rotation(rng, d),
        soft_ratio,
        curvature: rng.random_range(recipe.curvature.clone()),
        margin,
        reference,
        ..OracleObstacle::still(&center, &axes)
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

/// A centre that brings a point of the soft layer of `obstacle` onto a point of that of `neighbour`, the cores
/// side by side; nothing if one of them has no layer or no such place is found.
fn beside(rng: &mut impl Rng, neighbour: &OracleObstacle, obstacle: &OracleObstacle) -> Option<Vec<f64>> {
    let d = neighbour.center.len();
    for _ in 0..TRIES {
        let there = Body::new(neighbour, d, OracleMethod::Deformable).ok()?;
        let here = Body::new(obstacle, d, OracleMethod::Deformable).ok()?;
        let ray = direction(rng, d);
        let Some(meeting) = in_layer(rng, &there, &ray) else {
            continue;
        };
        let normal = unit(&there.gradient(&meeting))?;
        // Roughly from the far side, so that the cores do not lie on each other.
        let back = unit(&(here.rotation.tr_mul(&-normal) + direction(rng, d) * 0.5))?;
        let Some(own) = in_layer(rng, &here, &back) else {
            continue;
        };
        let center = rounded_vector(&(&here.center + meeting - own));
        let moved = OracleObstacle { center, ..obstacle.clone() };
        let here = Body::new(&moved, d, OracleMethod::Deformable).ok()?;
        if cores_apart(rng, &there, &here) && cores_apart(rng, &here, &there) {
            return Some(moved.center);
        }
    }
    None
}

/// A point in the middle part of the soft layer, on a ray of the obstacle's frame.
fn in_layer(rng: &mut impl Rng, body: &Body, ray: &DVector<f64>) -> Option<DVector<f64>> {
    let (hard, soft) = layer_reach(body, ray)?;
    Some(on_ray(body, ray, hard + rng.random_range(0.2..0.8) * (soft - hard)))
}

/// Whether no point of the surface of `b` that was looked at is in the core of `a`.
fn cores_apart(rng: &mut impl Rng, a: &Body, b: &Body) -> bool {
    let d = a.center.len();
    a.gamma(&b.center) > 1.0
        && (0..100).all(|_| {
            let ray = direction(rng, d);
            let surface = b.gamma(&b.world(&ray)).powf(-1.0 / b.exponent);
            a.gamma(&on_ray(b, &ray, surface)) > 1.0
        })
}
