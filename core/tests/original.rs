//! The original method, with rigid cores only: it has no push, and it is what soft layers that become thin tend to (k -> 1).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod world;

use pliant_core::scalar::Fixed;
use pliant_core::shape::Shape;
use pliant_core::{Obstacle, ObstacleSpec, RobotState, Scalar, Settings, Vector};
use rand::Rng;
use world::scene::{MOVING, PLACES, controller, place, some, with_flow};
use world::{is_long, motion, numbers, random, share};

/// The same obstacle with a layer this much thicker than itself; the margins would swallow a thin one, so there are none.
fn soft<S: Scalar, const D: usize>(o: &Obstacle<S, D>, ratio: S) -> Obstacle<S, D> {
    let (soft_ratio, margin) = (Vector::repeat(ratio), Vector::repeat(S::one()));
    Obstacle::new(ObstacleSpec { soft_ratio, margin, ..o.spec().clone() }).unwrap()
}

/// p: Gamma is the gauge to the power of 2p.
fn power<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> i32 {
    match o.spec().shape {
        Shape::Ellipsoid { curvature, .. } => i32::from(curvature),
        _ => 1,
    }
}

#[derive(Default, Debug)]
struct Tally {
    tried: u64,
    /// In the soft layer of the thick, and of the thin.
    in_thick: u64,
    in_thin: u64,
    near: u64,
}

fn campaign<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut random(seed);
    let mut tally = Tally::default();
    while tally.tried < share(2) {
        let obstacles = some::<S, D>(r, &MOVING);
        // From as thin as numbers allow: eight steps above one.
        let (least, eps) = (8.0 * S::EPSILON.to_f64(), S::EPSILON.to_f64());
        let thickness = 10f64.powf(r.random_range(least.log10()..-1.0));
        let thin_ratio = S::from_f64(1.0 + thickness);
        let all = |ratio: S| obstacles.iter().map(move |o| soft(o, ratio)).collect::<Vec<_>>();
        let motion = motion(r);
        let settings = with_flow::<S>();
        let rigid = controller(motion.clone(), settings, all(S::one()));
        let thin = controller(motion.clone(), settings, all(thin_ratio));
        let thick = controller(motion.clone(), settings, all(S::from_f64(1.8)));
        let original = controller(motion, Settings { deformable: false, ..settings }, all(S::from_f64(1.8)));
        let thin_obstacles = all(thin_ratio);
        for _ in 0..PLACES {
            let Some(x) = RobotState::new(place(r, &thin_obstacles)) else { continue };
            tally.tried += 1;
            // The original method has no push, however thick the layers; and to the bit it is that of rigid obstacles.
            let of_original = original.evaluate(&x);
            assert_eq!(of_original.adapted, of_original.modulated);
            let of_rigid = rigid.evaluate(&x);
            assert_eq!(of_rigid.adapted, of_rigid.modulated, "{of_rigid:?}");
            assert_eq!(of_rigid, of_original);
            assert_eq!(original.modulated(&x), of_original.adapted);
            tally.in_thick += u64::from(thick.evaluate(&x).region != of_rigid.region);
            // Beyond (1 + thickness) times the core a thin layer changes nothing, not a bit: so wherever x is, it is as good as none once
            // it is thin enough. Gamma has an error of some units for each of its 2p factors.
            let of_thin = thin.evaluate(&x);
            assert_eq!(of_thin.modulated, of_rigid.modulated);
            let beyond = |o: &Obstacle<S, D>| {
                o.gamma(x.position()).to_f64() > (1.0 + thickness + 16.0 * eps / thinnest(o)).powi(2 * power(o))
            };
            if thin.table().iter().all(|e| beyond(e.obstacle())) {
                assert_eq!(of_thin, of_rigid);
                tally.near += u64::from(of_rigid.gamma < S::from_f64(1.1));
            } else if of_thin.adapted != of_rigid.adapted {
                // In the layer, and the push is what it may be at most: |f| for each, and no faster backwards.
                tally.in_thin += 1;
                let speed = |v: &Vector<S, D>| numbers(v).norm();
                let change = speed(&(of_thin.adapted - of_rigid.adapted));
                let most = obstacles.len() as f64 * speed(&of_rigid.nominal) + 0.8 * speed(&of_rigid.modulated);
                assert!(change <= most * (1.0 + 8.0 * eps) + 8.0 * eps, "{of_thin:?} {of_rigid:?}");
            }
        }
    }
    println!("{D}-D: {tally:?}");
    let often = |n: u64, share: u64| assert!(n * share > tally.tried || !is_long(), "{tally:?}");
    often(tally.in_thick, 20);
    often(tally.in_thin, 200);
    often(tally.near, 50);
}

/// The least length of a unit of scaled coordinates, m: what one unit of rounding of a position is measured by.
fn thinnest<S: Scalar, const D: usize>(o: &Obstacle<S, D>) -> f64 {
    o.spec().shape.extent().iter().fold(1.0, |m, x| x.to_f64().min(m))
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { campaign::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    original_2d_f64: f64, 2, 21;
    original_3d_f64: f64, 3, 22;
    original_2d_f32: f32, 2, 23;
    original_3d_f32: f32, 3, 24;
    original_2d_fixed: Fixed, 2, 25;
    original_3d_fixed: Fixed, 3, 26;
}
