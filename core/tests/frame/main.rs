//! The frame does not matter: a world that is turned and moved as a whole has the same velocities, turned.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

#[path = "../world/mod.rs"]
mod world;

mod driven;
mod frames;

use frames::{Frame, farthest, parts};
use pliant_core::scalar::Fixed;
use pliant_core::{Controller, Matrix, Obstacle, RobotState, Scalar, Vector};
use world::scene::{PLACES, place};
use world::{is_long, numbers, random, share, turn, vector, within};

/// How far x is from the line across g through the reference point, m.
fn across<const D: usize>(o: &Obstacle<f64, D>, x: &Vector<f64, D>) -> f64 {
    let g = o.gradient(x);
    (g.dot(&(x - o.reference())) / g.norm()).abs()
}

/// How many neighbouring worlds the conditioning is taken from.
const NEIGHBOURS: usize = 3;
/// What is done to a number on its way is no worse than this many units of rounding of what it is made from.
const UNITS: f64 = 64.0;

/// Both frames are made from the same numbers, rounded once to `S`, so what the two differ by is rounding, magnified by how fast the velocity
/// changes from world to world. That is measured, in f64: by how much it changes where every number of the world is changed at random by one
/// unit of rounding of `S`. `UNITS` of those are allowed (a position goes through some ten operations before it is a velocity, and three random
/// neighbours see at least a part of the steepest direction), and as many of the velocity itself.
fn frame<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let (mut compared, mut pushed, mut flipped, mut worst) = (0u64, 0u64, 0u64, 0.0f64);
    let (mut worlds, mut elsewhere, mut refused) = (0u64, 0u64, 0u64);
    let eps = S::EPSILON.to_f64();
    while compared < share(2) {
        let q = turn::<f64, D>(r);
        let t: Vector<f64, D> = vector(&within(r, 0.8));
        let mut parts = parts::<D>(r);
        let (one, none) = (Matrix::identity(), Vector::zeros());
        // What is too small for the number type is no obstacle in it.
        parts.obstacles.retain(|o| Frame { q: one, t: none, jitter: 0.0, random: r }.obstacle::<S>(o).is_some());
        let here: Controller<S, D, 16> = Frame { q: one, t: none, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let there: Controller<S, D, 16> = Frame { q, t, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let exact: Controller<f64, D, 16> =
            Frame { q: one, t: none, jitter: 0.0, random: r }.controller(&parts).unwrap();
        let near: Option<Vec<Controller<f64, D, 16>>> =
            (0..NEIGHBOURS).map(|_| Frame { q: one, t: none, jitter: eps, random: r }.controller(&parts)).collect();
        // A polygon with corners so close that a change of so little makes it none has no neighbours to compare with.
        worlds += 1;
        let Some(near) = near else {
            refused += 1;
            continue;
        };
        let obstacles: Vec<_> = exact.table().iter().map(|e| e.obstacle().clone()).collect();
        // Whatever the common point of a cluster is that its search ends at, it will do; but which it is depends on comparisons on the way, and so it
        // magnifies rounding more than any bound that three neighbours show. Where it did, the flows are two, each as good: nothing to compare.
        let apart = farthest(&here, &there, |x| q * x + t);
        // The conditioning is that of the world in f64, so the references must be its own.
        let apart = apart.max(farthest(&here, &exact, |x| *x));
        let near_apart = near.iter().map(|c| farthest(&exact, c, |x| *x)).fold(0.0, f64::max);
        if apart.max(near_apart) > UNITS * eps {
            elsewhere += 1;
            continue;
        }
        // How far the references moved is known. Where that is much more than in the neighbours, the flow changes by as much more, and in their few
        // random directions the neighbours see at least an eighth of the steepest.
        let units = UNITS.max(8.0 * apart / near_apart.max(0.25 * eps));
        for _ in 0..PLACES {
            let x = numbers(&place(r, &obstacles).map(S::from_f64));
            let at = |x: Vector<f64, D>| RobotState::new(x.map(S::from_f64)).unwrap();
            let (a, b) = (here.evaluate(&at(x)), there.evaluate(&at(q * x + t)));
            let truth = exact.evaluate(&RobotState::new(x).unwrap());
            // At a surface the velocity jumps into the core: rounding must not decide on which side x is.
            let sides = |c: &Controller<S, D, 16>, x: Vector<f64, D>| {
                let x = x.map(S::from_f64);
                c.table().iter().map(|e| e.obstacle().gamma(&x) <= S::one()).collect::<Vec<_>>()
            };
            let true_sides: Vec<bool> = obstacles.iter().map(|o| o.gamma(&x) <= 1.0).collect();
            if sides(&here, x) != true_sides || sides(&there, q * x + t) != true_sides {
                flipped += 1;
                continue;
            }
            // In a core r may lie across g: the flow has a pole there, and where the reference may have moved across it rounding says on which side x is.
            let moved = apart + UNITS * eps;
            if obstacles.iter().zip(&true_sides).any(|(o, inside)| *inside && across(o, &x) <= 8.0 * moved) {
                flipped += 1;
                continue;
            }
            let sensitivity =
                near.iter().map(|c| (c.evaluate(&RobotState::new(x).unwrap()).adapted - truth.adapted).norm());
            let sensitivity = sensitivity.fold(0.0, f64::max);
            let error = (q * numbers(&a.adapted) - numbers(&b.adapted)).norm();
            // Where numbers have a fixed point what is small has few digits: Gamma below one, and on the way to a normal the radius of an edge, which
            // is 0.15 of a side that is 0.3 of the longest.
            let digits = eps + S::rounding(S::zero()).to_f64() / (0.045 * truth.gamma.min(1.0));
            let bound = units * sensitivity + UNITS * digits * (1.0 + truth.adapted.norm());
            worst = worst.max(error / bound);
            assert!(
                error <= bound,
                "{error:e} over {bound:e}, references {apart:e} and {near_apart:e} apart: {a:?} {b:?} {truth:?} at {x} of {here:?}"
            );
            compared += 1;
            pushed += u64::from(a.adapted != a.modulated);
        }
    }
    println!(
        "{D}-D: {compared}, {pushed} with a push, {flipped} flipped, {elsewhere} and {refused} of {worlds} worlds, worst {worst}"
    );
    assert!(
        !is_long()
            || 40 * pushed > compared && 50 * flipped < compared && 2 * elsewhere < worlds && 20 * refused < worlds
    );
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { frame::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    frame_2d_f64: f64, 2, 31;
    frame_3d_f64: f64, 3, 32;
    frame_2d_f32: f32, 2, 33;
    frame_3d_f32: f32, 3, 34;
    frame_2d_fixed: Fixed, 2, 35;
    frame_3d_fixed: Fixed, 3, 36;
}
