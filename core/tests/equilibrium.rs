//! With `WithFlow` the attractor stays an equilibrium, wherever cores and soft layers lie; and where it moves no layer pushes a robot off it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use num_traits::Zero;
use pliant_core::scalar::Fixed;
use pliant_core::{Controller, Region, RobotState, Scalar, Vector};
use rand::Rng;
use world::judge::Asked;
use world::scene::{PLACES, STILL, controller, place, some, with_flow};
use world::{Kind, Random, is_long, motion, numbers, on_grid, random, share, vector, within};

#[derive(Default, Debug)]
struct Tally {
    tried: u64,
    soft: u64,
    intersection: u64,
    hard: u64,
    /// Driven by whole ticks, guard and limits included.
    ticked: u64,
    /// Pushed beside a moving attractor.
    beside: u64,
}

fn attractor_rests<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let mut tally = Tally::default();
    while tally.tried < share(2) {
        let obstacles = some::<S, D>(r, &Kind { obstacles: 15, ..STILL });
        let mut controller = controller(motion(r), with_flow(), obstacles.iter().cloned());
        for _ in 0..PLACES {
            // On the grid the attractor is moved to the bit: x - d(t) is where it was learnt, and f is zero rather than rounding.
            let x = numbers(&place(r, &obstacles));
            let x = vector::<S, D>(&on_grid([0, 1, 2].map(|i| x.get(i).copied().unwrap_or(0.0))));
            assert!(controller.aim(&x, &Vector::zeros()) && controller.motion().attractor() == x);
            let state = RobotState::new(x).unwrap();
            // In a core as well: what bends a flow of zero leaves zero.
            let stages = controller.evaluate(&state);
            assert_eq!(stages.adapted, Vector::<S, D>::zero(), "{stages:?} {controller:?}");
            tally.tried += 1;
            match stages.region {
                Region::Soft => tally.soft += 1,
                Region::Intersection => tally.intersection += 1,
                Region::Hard => tally.hard += 1,
                Region::Free => {}
            }
            // Within the guard's skin it may be pushed out.
            let command = controller.tick(&state, S::from_f64(0.001));
            if Asked::new(&controller, &state, 0.001).undisturbed {
                assert_eq!(command.velocity, Vector::<S, D>::zero(), "{command:?} {controller:?}");
                tally.ticked += 1;
            }
            tally.beside += u64::from(is_left_alone(&mut controller, &x, r));
        }
    }
    println!("{D}-D: {tally:?}");
    let often = |n: u64, share: u64| assert!(n * share > tally.tried || !is_long(), "{tally:?}");
    often(tally.soft, 20);
    often(tally.intersection, 400);
    often(tally.hard, 20);
    often(tally.ticked, 2);
    often(tally.beside, 50);
}

/// An attractor that moves is kept up with, f = v there, and bent as v is; but what soft layers do is measured by the motion relative to it: at the
/// attractor nothing, and beside it each of n layers pushes by beta |f0| at most, and each ordered pair of them slows down by as much. Was there a push?
fn is_left_alone<S: Scalar, const D: usize>(c: &mut Controller<S, D, 16>, x: &Vector<S, D>, r: &mut Random) -> bool {
    let v: Vector<S, D> = vector(&within(r, 1.0));
    assert!(c.aim(x, &v));
    let stages = c.evaluate(&RobotState::new(*x).unwrap());
    assert_eq!(stages.nominal, v);
    assert_eq!(stages.adapted, stages.modulated, "{stages:?} {c:?}");
    let far = |c: &Controller<S, D, 16>| c.table().iter().all(|e| !(e.obstacle().gamma(x) < S::FAR));
    assert!(!far(c) || stages.adapted == v);
    let near = 10f64.powf(r.random_range(-4.0..-1.0));
    let beside = x + vector::<S, D>(&within(r, near));
    let stages = c.evaluate(&RobotState::new(beside).unwrap());
    let relative = numbers(&c.motion().relative(&beside)).norm();
    let layers = c.table().iter().filter(|e| e.obstacle().gamma_soft(&beside) <= S::one()).count() as f64;
    let push = numbers(&(stages.adapted - stages.modulated)).norm();
    let rounding = 64.0 * S::EPSILON.to_f64() * (1.0 + numbers(&stages.modulated).norm());
    let most = layers * layers * relative * (1.0 + rounding) + rounding;
    assert!(push <= most, "{push} over {most}, of {layers}: {stages:?} {c:?}");
    push > rounding
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { attractor_rests::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    equilibrium_2d_f64: f64, 2, 9;
    equilibrium_3d_f64: f64, 3, 10;
    equilibrium_2d_f32: f32, 2, 11;
    equilibrium_3d_f32: f32, 3, 12;
    equilibrium_2d_fixed: Fixed, 2, 13;
    equilibrium_3d_fixed: Fixed, 3, 14;
}
