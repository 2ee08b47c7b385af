//! Random obstacles beside a path.

use std::f64::consts::PI;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::study::skill::Skill;
use crate::study::world::Body;

/// How much of the way from the core to the end of the layer, along the normal of the path, the path may be from the core.
const THROUGH: (f64, f64) = (0.0, 0.6);

/// So many obstacles whose soft layer the path passes through, each once on its left and once on its right; none with start or goal in its layer.
pub fn pairs(skill: &Skill, count: usize, seed: u64) -> Vec<[Body; 2]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        let place = skill.place(random.random_range(0.15..0.85));
        let axes = [random.random_range(0.02..0.06), random.random_range(0.02..0.06)];
        let (ratio, angle) = (random.random_range(1.2..2.0), random.random_range(-PI..PI));
        let depth = random.random_range(THROUGH.0..THROUGH.1);
        let body = |side: f64| {
            let out = place.left() * side;
            let mut body = Body::new("obstacle", axes, ratio, place.at, angle);
            body.center += out * (body.reach(&out) * (1.0 + (ratio - 1.0) * depth));
            body
        };
        let free = |body: &Body| {
            [skill.start, skill.goal()].iter().all(|p| {
                let away = p - body.center;
                away.norm() > 1.02 * body.ratio * axes[0].max(axes[1])
            })
        };
        let pair = [1.0, -1.0].map(body);
        if pair.iter().all(free) {
            all.push(pair);
        }
    }
    all
}
