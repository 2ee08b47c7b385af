//! f(x) of a learnt skill has no jump, however far from the data.
//!
//! With a >= |A_k|, w >= |W_k| and m >= |mu_k| and |x*|, the gradient of a weight's exponent is at most w^2 (|x| + m), two of them differ by
//! at most twice that, and so
//!
//! ```text
//! |df/dx| <= a + 2 a (|x| + m) w^2 (|x| + m)
//! ```
//!
//! A step so short that this bound moves f by a hundredth of a(|x| + m) may not move it farther.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::{Component, LpvDs, Matrix, Scalar, Vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const EXTENT: f64 = 0.5;

fn samples() -> usize {
    std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(1_000_000)
}

struct Bounds {
    a: f64,
    w: f64,
    m: f64,
}

fn model<S: Scalar, const D: usize>(rng: &mut ChaCha8Rng) -> (LpvDs<S, D>, Bounds) {
    let mut bounds = Bounds { a: 0.0, w: 0.0, m: 0.0 };
    let parts: Vec<_> = (0..8)
        .map(|_| {
            let mean = Vector::<f64, D>::from_fn(|_, _| (rng.random::<f64>() - 0.5) * EXTENT);
            let whitening = Matrix::<f64, D>::from_fn(|r, c| {
                let x = rng.random::<f64>() - 0.5;
                if r == c {
                    60.0 * (1.0 + x)
                } else if c < r {
                    60.0 * x
                } else {
                    0.0
                }
            });
            let a = Matrix::<f64, D>::from_fn(|r, c| 6.0 * (rng.random::<f64>() - if r == c { 1.5 } else { 0.5 }));
            let log_weight = 4.0 * rng.random::<f64>();
            bounds.a = bounds.a.max(a.norm());
            bounds.w = bounds.w.max(whitening.norm());
            bounds.m = bounds.m.max(mean.norm());
            Component {
                log_weight: S::from_f64(log_weight),
                mean: mean.map(S::from_f64),
                whitening: whitening.map(S::from_f64),
                a: a.map(S::from_f64),
            }
        })
        .collect();
    (LpvDs::new(Vector::zeros(), Matrix::identity(), &parts).expect("within ranges"), bounds)
}

fn no_jump<S: Scalar, const D: usize>(rounding: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (ds, bounds) = model::<S, D>(&mut rng);
    let at = |x: &Vector<f64, D>| ds.velocity(&x.map(S::from_f64)).map(S::to_f64);
    for _ in 0..samples() {
        let direction = Vector::<f64, D>::from_fn(|_, _| rng.random::<f64>() - 0.5);
        // As often a millimetre away as a thousand extents.
        let far = 1e-3 * libm::pow(1000.0 * EXTENT / 1e-3, rng.random::<f64>());
        let x = direction * (far / direction.norm().max(1e-3));
        let reach = x.norm() + bounds.m;
        let slope = bounds.a + 2.0 * bounds.a * reach * bounds.w * bounds.w * reach;
        let size = bounds.a * reach;
        let step = Vector::<f64, D>::from_fn(|_, _| rng.random::<f64>() - 0.5).normalize() * (0.01 * size / slope);
        let (before, after) = (at(&x), at(&(x + step)));
        // Positions are rounded as well: a step may be longer by some units in the last place of x.
        let length = step.norm() + 4.0 * rounding * reach;
        assert!(before.norm() <= size * 1.001, "{x:?}: {before:?}");
        let bound = slope * length + 16.0 * rounding * size;
        assert!((after - before).norm() <= bound, "{x:?} + {step:?}: {before:?}, {after:?}, bound {bound}");
    }
}

#[test]
fn f64_in_the_plane() {
    no_jump::<f64, 2>(f64::EPSILON);
}

#[test]
fn f64_in_space() {
    no_jump::<f64, 3>(f64::EPSILON);
}

#[test]
fn f32_in_the_plane() {
    no_jump::<f32, 2>(f64::from(f32::EPSILON));
}

#[test]
fn f32_in_space() {
    no_jump::<f32, 3>(f64::from(f32::EPSILON));
}
