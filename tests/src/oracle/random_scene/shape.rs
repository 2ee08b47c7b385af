//! Cores of every shape.

use std::f64::consts::TAU;

use rand::Rng;

use super::super::scene::OracleShape;
use super::Recipe;
use super::random::{chance, rounded, uniform};

/// A core whose semi-extents are about `least` to `most`.
pub(super) fn core(rng: &mut impl Rng, recipe: &Recipe, least: f64, most: f64) -> OracleShape {
    let d = recipe.dimension;
    let size = |rng: &mut _| uniform(rng, least, most);
    if !chance(rng, recipe.shapes) {
        let axes = (0..d).map(|_| size(rng)).collect();
        return OracleShape::Ellipsoid { axes, curvature: rng.random_range(recipe.curvature.clone()) };
    }
    match (d, rng.random_range(0..3)) {
        (2, 0) => OracleShape::Polygon { vertices: star(rng, least, most) },
        (2, _) | (_, 0) => {
            let half: Vec<f64> = (0..d).map(|_| size(rng)).collect();
            let rounding = rounding(rng, half.iter().copied().fold(f64::INFINITY, f64::min));
            OracleShape::Box { half, rounding }
        }
        (_, 1) => {
            let (radius, half_length) = (size(rng), size(rng));
            OracleShape::Cylinder { radius, half_length, rounding: rounding(rng, radius.min(half_length)) }
        }
        _ => OracleShape::Capsule { radius: size(rng), half_length: uniform(rng, 0.2 * least, 0.6 * most) },
    }
}

fn rounding(rng: &mut impl Rng, most: f64) -> f64 {
    if chance(rng, 0.15) { most } else { rounded(rng.random_range(0.05..0.95) * most) }
}

/// Corners at distances of their own, no sector wider than 160 degrees.
fn star(rng: &mut impl Rng, least: f64, most: f64) -> Vec<[f64; 2]> {
    let count = rng.random_range(3..=9);
    let start = rng.random_range(0.0..TAU);
    (0..count)
        .map(|i| {
            let angle = start + TAU / f64::from(count) * (f64::from(i) + rng.random_range(-0.15..0.15));
            // Not so near to the middle that a notch has no width.
            let reach = rng.random_range((0.5 * (least + most)).min(1.5 * least)..most);
            [rounded(reach * angle.cos()), rounded(reach * angle.sin())]
        })
        .collect()
}
