//! Random scenes and positions for comparisons, from a seed.
//!
//! The scenes are made to be hard on the method: obstacles stand in groups whose soft layers overlap, reference
//! points lie off the centre, margins differ from axis to axis and sometimes swallow a soft layer. Every number
//! except a quaternion is one that `f32` holds, so that both precisions are asked the same question.

mod body;
mod motion;
mod points;
mod random;

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::scene::{OracleLimits, OracleMethod, OracleScene, OracleSteering, OracleTick};
pub use points::{PointKind, SamplePoint, sample};
use random::{chance, power_of_ten, rounded, uniform};

/// A scene, a tick and positions worth asking about.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomScene {
    /// The scene.
    pub scene: OracleScene,
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
}

impl Recipe {
    /// 1 to 10 obstacles with p = 1 to 3, of all kinds.
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
        }
    }

    /// A scene after this recipe.
    pub fn scene(&self, rng: &mut impl Rng) -> OracleScene {
        let motion = motion::motion(rng, self);
        let steering = if chance(rng, self.fixed) {
            OracleSteering::Fixed { angle: uniform(rng, -PI, PI) }
        } else {
            let beta = if chance(rng, 0.5) { 1.0 } else { uniform(rng, 0.2, 2.0) };
            OracleSteering::WithFlow { beta }
        };
        OracleScene {
            dimension: self.dimension,
            motion,
            obstacles: body::obstacles(rng, self),
            method: if chance(rng, self.original) { OracleMethod::Original } else { OracleMethod::Deformable },
            steering,
            gain: rounded(power_of_ten(rng, -2.5, -0.5)),
            limits: OracleLimits {
                speed: uniform(rng, 0.2, 2.0),
                acceleration: if chance(rng, 0.5) { Some(uniform(rng, 0.5, 10.0)) } else { None },
            },
        }
    }

    /// A tick after this recipe.
    pub fn tick(&self, rng: &mut impl Rng) -> OracleTick {
        OracleTick {
            previous: (0..self.dimension).map(|_| uniform(rng, -0.5, 0.5)).collect(),
            dt: rounded(power_of_ten(rng, -3.0, -1.0)),
        }
    }
}

/// The scene of a seed with `each` positions of every kind; even seeds are in the plane, odd ones in space.
pub fn generate(seed: u64, each: usize) -> RandomScene {
    let dimension = if seed.is_multiple_of(2) { 2 } else { 3 };
    generate_from(&Recipe::new(dimension), seed, each)
}

/// The scene of a recipe and a seed with `each` positions of every kind that it has.
pub fn generate_from(recipe: &Recipe, seed: u64, each: usize) -> RandomScene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let scene = recipe.scene(&mut rng);
    let tick = recipe.tick(&mut rng);
    let points = PointKind::ALL.iter().flat_map(|kind| sample(&mut rng, &scene, *kind, each)).collect();
    RandomScene { scene, tick, points }
}

#[cfg(test)]
mod tests;
