//! Random scenes and positions for comparisons, from a seed.
//!
//! The scenes are made to be hard on the method: obstacles of every shape stand in groups whose soft layers overlap, or whose
//! cores do, and within walls; reference points lie off the centre, margins differ from axis to axis and sometimes swallow a
//! soft layer; things move, grow, shrink and age. Cores overlap clearly or not at all. Every number except a quaternion and
//! what has aged is one that `f32` holds, so that both precisions are asked the same question.

mod body;
mod motion;
mod points;
mod random;
mod shape;

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::scene::{OracleDrift, OracleLimits, OracleMethod, OracleScan, OracleScene, OracleSteering, OracleTick};
pub use points::{PointKind, SamplePoint, sample};
use random::{chance, power_of_ten, rounded, uniform, uniform_vector};

/// alpha of the guard unless set.
const APPROACH: f64 = 0.02;

/// How obstacles have come to be as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomAgeing {
    /// Every obstacle older than this ages, s.
    pub time_to_live: f64,
    /// At this rate, m/s.
    pub rate: f64,
    /// How old each is, s. One older than 0 does not turn; it has moved, grown and aged for as long.
    pub ages: Vec<f64>,
}

/// A scene, a tick and positions worth asking about.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomScene {
    /// The scene.
    pub scene: OracleScene,
    /// How old its obstacles are.
    pub ageing: RandomAgeing,
    /// A previous velocity and a time step, for the acceleration limit.
    pub tick: OracleTick,
    /// Positions of every kind that the scene has.
    pub points: Vec<SamplePoint>,
}

/// What random scenes are made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// 2 or 3.
    pub dimension: usize,
    /// How many obstacles.
    pub obstacles: RangeInclusive<usize>,
    /// Values of p.
    pub curvature: RangeInclusive<u8>,
    /// Probability that a scene has moving obstacles at all.
    pub moving: f64,
    /// Probability of an LPV motion; linear otherwise.
    pub lpv: f64,
    /// Probability of the `original` method.
    pub original: f64,
    /// Probability of `fixed` steering.
    pub fixed: f64,
    /// Probability that an obstacle joins one that is there, soft layer in soft layer.
    pub crowding: f64,
    /// Probability that an obstacle is no ellipsoid.
    pub shapes: f64,
    /// Probability of a wall around everything.
    pub walls: f64,
    /// Probability that a scene has obstacles that grow, shrink and age.
    pub growing: f64,
    /// Probability of a scan.
    pub scans: f64,
    /// Probability that cores overlap.
    pub clusters: f64,
    /// Probability of a moving attractor.
    pub drifting: f64,
}

impl Recipe {
    /// 1 to 10 obstacles of all kinds, ellipsoids with p = 1 to 3.
    pub fn new(dimension: usize) -> Self {
        Self {
            dimension,
            obstacles: 1..=10,
            curvature: 1..=3,
            moving: 0.5,
            lpv: 0.5,
            original: 0.15,
            fixed: 0.4,
            crowding: 0.75,
            shapes: 0.5,
            walls: 0.2,
            growing: 0.3,
            scans: 0.3,
            clusters: 0.3,
            drifting: 0.3,
        }
    }

    /// Ellipsoids at rest or moving, as they are given, apart from each other, and nothing else.
    pub fn plain(dimension: usize) -> Self {
        let none = 0.0;
        Self {
            shapes: none,
            walls: none,
            growing: none,
            scans: none,
            clusters: none,
            drifting: none,
            ..Self::new(dimension)
        }
    }

    /// A scene after this recipe.
    pub fn scene(&self, rng: &mut impl Rng) -> (OracleScene, RandomAgeing) {
        let motion = motion::motion(rng, self);
        let steering = if chance(rng, self.fixed) {
            OracleSteering::Fixed { angle: uniform(rng, -PI, PI) }
        } else {
            let beta = if chance(rng, 0.5) { 1.0 } else { uniform(rng, 0.2, 2.0) };
            OracleSteering::WithFlow { beta }
        };
        let (obstacles, ageing) = body::obstacles(rng, self);
        let d = self.dimension;
        let scene = OracleScene {
            dimension: d,
            motion,
            obstacles,
            method: if chance(rng, self.original) { OracleMethod::Original } else { OracleMethod::Deformable },
            steering,
            gain: rounded(power_of_ten(rng, -2.5, -0.5)),
            limits: OracleLimits {
                speed: uniform(rng, 0.2, 2.0),
                acceleration: if chance(rng, 0.5) { Some(uniform(rng, 0.5, 10.0)) } else { None },
            },
            scan: chance(rng, self.scans).then(|| scan(rng, d)),
            drift: chance(rng, self.drifting).then(|| OracleDrift {
                displacement: uniform_vector(rng, d, 0.5),
                velocity: uniform_vector(rng, d, 0.3),
            }),
            guard: (!chance(rng, 0.1)).then(|| if chance(rng, 0.5) { APPROACH } else { uniform(rng, 0.01, 0.9) }),
        };
        (scene, ageing)
    }

    /// A tick after this recipe.
    pub fn tick(&self, rng: &mut impl Rng) -> OracleTick {
        OracleTick {
            previous: (0..self.dimension).map(|_| uniform(rng, -0.5, 0.5)).collect(),
            dt: rounded(power_of_ten(rng, -3.0, -1.0)),
        }
    }
}

/// Points along a line and points anywhere.
fn scan(rng: &mut impl Rng, d: usize) -> OracleScan {
    let start = uniform_vector(rng, d, 1.5);
    let step = uniform_vector(rng, d, 0.15);
    let points = (0..rng.random_range(1..=24))
        .map(|i| {
            if chance(rng, 0.2) {
                return uniform_vector(rng, d, 1.8);
            }
            start.iter().zip(&step).map(|(from, step)| rounded(from + step * f64::from(i))).collect()
        })
        .collect();
    OracleScan { points, radius: uniform(rng, 0.03, 0.2) }
}

/// The scene of a seed with `each` positions of every kind; even seeds are in the plane, odd ones in space.
pub fn generate(seed: u64, each: usize) -> RandomScene {
    let dimension = if seed.is_multiple_of(2) { 2 } else { 3 };
    generate_from(&Recipe::new(dimension), seed, each)
}

/// The scene of a recipe and a seed with `each` positions of every kind that it has.
pub fn generate_from(recipe: &Recipe, seed: u64, each: usize) -> RandomScene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (scene, ageing) = recipe.scene(&mut rng);
    let tick = recipe.tick(&mut rng);
    let points = PointKind::ALL.iter().flat_map(|kind| sample(&mut rng, &scene, *kind, each)).collect();
    RandomScene { scene, ageing, tick, points }
}

#[cfg(test)]
mod tests;
