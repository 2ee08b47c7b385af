//! A few obstacles round a point, for what is evaluated without time passing.

use super::{Kind, Random, obstacle, vector, within};
use pliant_core::{Controller, Motion, Obstacle, Scalar, Settings, Vector};
use rand::Rng;

pub const MOVING: Kind = Kind { obstacles: 8, speed: 0.5, walls: false, scans: false, odd: true, thin: false };
pub const STILL: Kind = Kind { speed: 0.0, ..MOVING };

/// Places in one world: making a world costs as much as many looks at it.
pub const PLACES: u64 = 40;

pub fn controller<S: Scalar, const D: usize>(
    motion: Motion<S, D>,
    settings: Settings<S>,
    obstacles: impl IntoIterator<Item = Obstacle<S, D>>,
) -> Controller<S, D, 16> {
    named(motion, settings, (0..).zip(obstacles))
}

pub fn named<S: Scalar, const D: usize>(
    motion: Motion<S, D>,
    settings: Settings<S>,
    obstacles: impl IntoIterator<Item = (u16, Obstacle<S, D>)>,
) -> Controller<S, D, 16> {
    let mut controller = Controller::new(motion, settings);
    for (id, o) in obstacles {
        controller.upsert(id, o, S::zero()).unwrap();
    }
    controller
}

pub fn some<S: Scalar, const D: usize>(r: &mut Random, kind: &Kind) -> Vec<Obstacle<S, D>> {
    (0..r.random_range(1..kind.obstacles)).filter_map(|_| obstacle(r, kind)).collect()
}

/// Steered with the flow, pushed at most 0.1 m/s.
pub fn with_flow<S: Scalar>() -> Settings<S> {
    Settings { gain: S::from_f64(0.1), ..Settings::default() }
}

/// Anywhere near, or along a random ray from an obstacle's centre at this many times its surface's or its soft layer's distance.
pub fn place<S: Scalar, const D: usize>(r: &mut Random, obstacles: &[Obstacle<S, D>]) -> Vector<S, D> {
    if obstacles.is_empty() || r.random_bool(0.5) {
        return vector(&within(r, 0.8));
    }
    let o = &obstacles[r.random_range(0..obstacles.len())];
    let way = vector(&within(r, 1.0));
    let surface = if r.random_bool(0.5) { o.surface(&way) } else { o.soft_surface(&way) };
    let from_there = 10f64.powf(r.random_range(-5.0..0.0)) * if r.random_bool(0.3) { -1.0 } else { 1.0 };
    let center = o.spec().center;
    center + (surface - center) * S::from_f64(1.0 + from_there)
}
