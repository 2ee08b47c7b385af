//! The core, and `pliant eval`, against the independent evaluation: to 1e-9 in f64, in 2-D and 3-D, 1 to 10 obstacles of every
//! shape, walls, scans, growth, overlapping cores, moving attractors, and the guard.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod clusters;
mod convert;
mod eval;
mod evaluation;
mod guard;

use pliant_tests::oracle::{Evaluation, OracleScene, OracleSteering};

/// Allowed difference, relative to the larger of the velocity and the nominal speed.
const TOLERANCE: f64 = 1e-9;
/// Closer than this to a switch of the method, rounding alone decides; such points say nothing.
const SWITCH: f64 = 1e-9;

/// Is every switch far enough that both sides must take the same branch? At a shell `fixed` jumps; `with-flow` does not.
fn decided(scene: &OracleScene, e: &Evaluation) -> bool {
    let s = &e.switches;
    let soft = matches!(scene.steering, OracleSteering::WithFlow { .. }) || s.soft > SWITCH;
    s.hard > SWITCH && soft && s.far > SWITCH && s.reference > SWITCH && s.sign > SWITCH
}

fn close(ours: &[f64], theirs: &[f64], scale: f64) -> bool {
    let error: f64 = ours.iter().zip(theirs).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    error <= TOLERANCE * size(theirs).max(scale)
}

fn size(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What the errors of a velocity are measured by: the nominal speed, and what is moving.
fn scale(scene: &OracleScene, e: &Evaluation) -> f64 {
    let moving = scene.obstacles.iter().zip(&e.obstacles).map(|(_, o)| size(&o.surface_velocity));
    // Where one stands against a moving surface, its speed is what cancels.
    moving.fold(size(&e.nominal), f64::max)
}
