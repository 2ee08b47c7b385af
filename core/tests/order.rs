//! In which order obstacles came does not matter, but for the rounding of sums.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::table::Entry;
use pliant_core::{Motion, Obstacle, RobotState, Scalar, Stages};
use rand::seq::SliceRandom;
use world::scene::{MOVING, PLACES, named, place, some, with_flow};
use world::{is_long, motion, numbers, random, share};

/// What another order of n sums may change, m/s.
///
/// Each of the sums of section 4 (weights, speed, angles, plain mean) has n terms and is divided by the sum of the weights, of which one is
/// 1: with e the unit of rounding, sums differ by 2 n e of the largest term, and twice that with the rescaling at each new nearest obstacle.
/// Angles are below pi and turn a speed: 4 n e (1 + pi + 1) of the fastest velocity past an obstacle. Where f is slow the share of the plain
/// mean has the slope 1/(0.05 speed) over |f| < 0.05 speed, so it adds as much once more. In fixed point e is a step of 1 m/s at least, and
/// the sums need that the velocities fit.
fn modulated_bound<S: Scalar, const D: usize>(n: usize, fastest: f64) -> f64 {
    4.0 * (n as f64) * S::EPSILON.to_f64() * (3.0 + core::f64::consts::PI) * fastest.max(1.0)
}

/// No velocity past this obstacle is larger, m/s: |s| + (1 + 1/G) |u| + (2/G) |g| |u| |r| / (g.r), growth (0.05 m/s) included.
fn fastest<S: Scalar, const D: usize>(o: &Obstacle<S, D>, x: &RobotState<S, D>, stages: &Stages<S, D>) -> f64 {
    let x = x.position();
    let s = numbers(&o.surface_velocity(x)).norm() + 0.1;
    let u = numbers(&stages.nominal).norm() + s;
    let (g, arm) = (numbers(&o.gradient(x)), numbers(&(x - o.reference())));
    let (along, gamma) = (g.dot(&arm).abs(), o.gamma(x).to_f64().max(1.0));
    let slant = if along > 1e-7 * g.norm() * arm.norm() { g.norm() * arm.norm() / along } else { 0.0 };
    s + u * (1.0 + (1.0 + 2.0 * slant) / gamma)
}

/// A layer's push is t / max(|t|, 0.02 |f|) times |f| at most, and the slow-down takes one for each pair of n layers: 50 times the change of u
/// for each, and for the sum over all its own rounding.
fn adapted_bound<S: Scalar, const D: usize>(n: usize, stages: &Stages<S, D>, modulated: f64) -> f64 {
    let (f, u) = (numbers(&stages.nominal).norm(), numbers(&stages.modulated).norm());
    let pushes = (n * n) as f64;
    modulated * (1.0 + 50.0 * pushes) + 4.0 * pushes * S::EPSILON.to_f64() * (f + u).max(1.0)
}

fn order<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let (mut compared, mut near, mut worst, mut worst_soft) = (0, 0, 0.0f64, 0.0f64);
    while compared < share(2) {
        let mut obstacles: Vec<(u16, Obstacle<S, D>)> = (0..).zip(some::<S, D>(r, &MOVING)).collect();
        let all: Vec<Obstacle<S, D>> = obstacles.iter().map(|(_, o)| o.clone()).collect();
        let motion: Motion<S, D> = motion(r);
        let one = named(motion.clone(), with_flow(), obstacles.clone());
        obstacles.shuffle(r);
        let other = named(motion, with_flow(), obstacles);
        // Shared reference points are found in the order of identifiers: the same to the bit.
        for entry in one.table().iter() {
            let same = other.table().iter().find(|e| e.id() == entry.id()).unwrap();
            assert_eq!(entry.obstacle(), same.obstacle());
        }
        for _ in 0..PLACES {
            let Some(x) = RobotState::new(place(r, &all)) else { continue };
            let (a, b) = (one.evaluate(&x), other.evaluate(&x));
            assert_eq!((a.gamma, a.region, a.status, a.nominal), (b.gamma, b.region, b.status, b.nominal));
            let present = || one.table().iter().map(Entry::obstacle);
            let fastest = present().map(|o| fastest(o, &x, &a)).fold(0.0, f64::max);
            let layers = present().filter(|o| o.gamma_soft(x.position()) <= S::one()).count();
            let bound = modulated_bound::<S, D>(all.len(), fastest);
            let apart = |a, b| (numbers::<S, D>(a) - numbers(b)).norm();
            let (error, soft) = (apart(&a.modulated, &b.modulated), apart(&a.adapted, &b.adapted));
            let bound_soft = adapted_bound(layers, &a, bound);
            (worst, worst_soft) = (worst.max(error / bound), worst_soft.max(soft / bound_soft));
            assert!(error <= bound, "{error:e} over {bound:e}: {a:?} {b:?} at {x:?} {one:?}");
            assert!(soft <= bound_soft, "soft {soft:e} over {bound_soft:e}: {a:?} {b:?} at {x:?} {one:?}");
            compared += 1;
            near += u64::from(a.gamma < S::from_f64(1.05));
        }
    }
    println!("{D}-D: {compared}, {near} near a surface or inside; of the bounds {worst} {worst_soft}");
    assert!(10 * near > compared || !is_long());
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { order::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    order_2d_f64: f64, 2, 2;
    order_3d_f64: f64, 3, 3;
    order_2d_f32: f32, 2, 4;
    order_3d_f32: f32, 3, 5;
    order_2d_fixed: Fixed, 2, 6;
    order_3d_fixed: Fixed, 3, 7;
}
