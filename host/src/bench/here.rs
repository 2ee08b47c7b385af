//! One modulated velocity on this machine, by number of obstacles.

use std::hint::black_box;
use std::time::Instant;

use pliant_bench::Number;
use pliant_bench::field::{COUNTS, Field};
use serde::Serialize;

/// Calls timed together, for what is shorter than the clock's step,
const BATCH: usize = 64;
/// so many times,
const BATCHES: usize = 2_000;
/// and calls timed each by itself, for what seldom happens.
const SINGLE: usize = 100_000;

/// What a velocity among ellipsoids (p = 1, at rest, a linear motion) took, ns.
#[derive(Clone, Debug, Serialize)]
pub struct Velocity {
    /// Obstacles.
    pub obstacles: u16,
    /// Of the workspace.
    pub dimension: usize,
    /// `f64` or `f32`.
    pub scalar: &'static str,
    /// Half of the batches took no more a call.
    pub median: f64,
    /// 99.9 % of single calls took no more, what reading the clock takes left out.
    pub p999: f64,
    /// The longest single call: mostly what else the machine does.
    pub worst: f64,
}

/// Measures both number types in both dimensions.
pub fn velocities() -> Vec<Velocity> {
    let mut all = Vec::new();
    series::<f64, 2>(&mut all);
    series::<f32, 2>(&mut all);
    series::<f64, 3>(&mut all);
    series::<f32, 3>(&mut all);
    all
}

fn series<S: Number, const D: usize>(all: &mut Vec<Velocity>) {
    for obstacles in COUNTS {
        let field = Field::<S, D>::new(obstacles);
        let mut states = field.states.iter().cycle();
        let mut velocity = || {
            if let Some(state) = states.next() {
                black_box(field.velocity(black_box(state)));
            }
        };
        // The first ones find cold caches.
        (0..BATCH).for_each(|_| velocity());
        let batches = sorted(BATCHES, || (0..BATCH).for_each(|_| velocity()));
        let reading = at(&sorted(SINGLE, || ()), 0.5);
        let single = sorted(SINGLE, velocity);
        all.push(Velocity {
            obstacles,
            dimension: D,
            scalar: S::NAME,
            median: at(&batches, 0.5) / BATCH as f64,
            p999: (at(&single, 0.999) - reading).max(0.0),
            worst: (at(&single, 1.0) - reading).max(0.0),
        });
    }
}

/// How long each of so many calls takes, ns, in order of length.
fn sorted(calls: usize, mut call: impl FnMut()) -> Vec<u64> {
    let mut times: Vec<u64> = (0..calls)
        .map(|_| {
            let start = Instant::now();
            call();
            u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
        })
        .collect();
    times.sort_unstable();
    times
}

/// The value that this share of them does not exceed.
fn at(sorted: &[u64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64) as usize).map_or(0.0, |t| *t as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles() {
        let times: Vec<u64> = (0..=1000).collect();
        assert_eq!((at(&times, 0.5), at(&times, 0.999), at(&times, 1.0)), (500.0, 999.0, 1000.0));
        assert_eq!(at(&[], 0.5), 0.0);
    }
}
