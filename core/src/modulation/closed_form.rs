//! The closed form against E D E^-1 as the papers write it, with an explicit basis and its inverse, in f64.

extern crate std;

use super::*;
use crate::scalar::Fixed;
use crate::shape::Polygon;
use crate::{Matrix, Obstacle, ObstacleSpec, Shape, rotation};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::prelude::v1::*;
use std::println;

fn exact<S: Scalar, const D: usize>(v: &Vector<S, D>) -> Vector<f64, D> {
    v.map(Scalar::to_f64)
}

/// E D E^-1 (f - s) + s, of the very numbers that the closed form sees; E = [r/|r|, tangents of g].
fn explicit<const D: usize>(f: &Vector<f64, D>, o: &Sample<f64, D>) -> Vector<f64, D> {
    let n = o.outward.normalize();
    let mut e = Matrix::<f64, D>::identity();
    let first = n.iamax();
    e.swap_columns(0, first);
    e.set_column(0, &n);
    // Gram and Schmidt, twice: the second time takes out what rounding left.
    for i in 1..D {
        let mut t = e.column(i).into_owned();
        for _ in 0..2 {
            for j in 0..i {
                let c = e.column(j).into_owned();
                t -= c * c.dot(&t);
            }
            t = t.normalize();
        }
        e.set_column(i, &t);
    }
    e.set_column(0, &o.arm.normalize());
    let gamma = o.gamma.max(1.0);
    let mut d = Matrix::<f64, D>::identity() * (1.0 + 1.0 / gamma);
    d[(0, 0)] = 1.0 - 1.0 / gamma;
    let mut inverse = e;
    assert!(nalgebra::linalg::try_invert_to(e, &mut inverse));
    e * d * inverse * (f - o.surface_velocity) + o.surface_velocity
}

/// What rounding may do, m/s. With e the unit of rounding, and h what a number that is nothing may be wrong by (a step in fixed point):
///
/// - u = f - s, 1/G and 1 + 1/G are wrong by one rounding each, their product and the sum with s by one more: 4 (e |.| + h) of |s| + 2 |u|;
/// - g.u and g.r are wrong by D (e |g| |u| + h) and D (e |g| |r| + h), so their ratio by that over g.r, the second
///   times |u| |g|/(g.r); |r| 2/G times this is what r is subtracted with, itself rounded: k = |g| |r| / (g.r), the
///   condition of the basis, enters squared.
///
/// The explicit form is as wrong, in f64, with its inverse: k once more.
fn bound<S: Scalar, const D: usize>(f: &Vector<f64, D>, o: &Sample<f64, D>) -> f64 {
    let (e, h) = (S::EPSILON.to_f64().min(1e-6), S::rounding(S::zero()).to_f64());
    // In fixed point e is no relative error: sizes below one are as good as one.
    let e = if h > 0.0 { h } else { e };
    let (u, s) = ((f - o.surface_velocity).norm(), o.surface_velocity.norm());
    let (g, r, along) = (o.outward.norm(), o.arm.norm(), o.outward.dot(&o.arm));
    let k = g * r / along;
    let d = D as f64;
    let inverse = 1.0 / o.gamma.max(1.0);
    let dots = d * (e * g * u + h) / along + d * (e * g * r + h) / along * (g * u / along);
    let radial = 2.0 * inverse * (dots + 4.0 * (e * g * u / along + h)) + 4.0 * h * (1.0 + g * u / along);
    let double = 64.0 * f64::EPSILON * (s + u) * k * k;
    2.0 * (4.0 * (e * (s + 2.0 * u) + h) + r * radial + e * 2.0 * inverse * k * u) + double
}

fn spec<S: Scalar, const D: usize>(r: &mut ChaCha8Rng) -> ObstacleSpec<S, D> {
    let s = S::from_f64;
    let within = |r: &mut ChaCha8Rng, most: f64| Vector::<S, D>::from_fn(|_, _| s(r.random_range(-most..most)));
    let sides = Vector::<S, D>::from_fn(|_, _| s(r.random_range(0.03..0.2)));
    let least = sides.iter().fold(S::one(), |m, x| m.min(*x));
    let round = s(least.to_f64() * r.random_range(0.1..0.9));
    let shape = match r.random_range(0..5u8) {
        0 => Shape::Box { half: sides, rounding: round },
        1 if D == 3 => Shape::Cylinder { radius: sides[0], half_length: sides[1], rounding: round },
        2 if D == 3 => Shape::Capsule { radius: sides[0], half_length: sides[1] },
        1 | 2 => {
            let corner = |i: u32, radius: f64| {
                let (sin, cos) = libm::sincos(f64::from(i) * core::f64::consts::TAU / 7.0);
                [s(radius * cos), s(radius * sin)]
            };
            let corners: Vec<[S; 2]> = (0..7).map(|i| corner(i, r.random_range(0.05..0.15))).collect();
            Shape::Polygon(Polygon::new(&corners).unwrap())
        }
        _ => Shape::Ellipsoid { axes: sides, curvature: r.random_range(1..=8) },
    };
    let turn = if D == 2 {
        let (sin, cos) = libm::sincos(r.random_range(-3.0..3.0));
        [cos, 0.0, 0.0, sin]
    } else {
        let q = [(); 4].map(|()| r.random_range(-1.0..1.0f64));
        let length = libm::sqrt(q.iter().map(|x| x * x).sum::<f64>()).max(0.1);
        q.map(|x| x / length)
    };
    let turn = rotation::spatial(turn).unwrap_or_else(nalgebra::Matrix3::identity);
    // Anywhere in the core that is star-shaped about its centre: polygons keep theirs.
    let place = if matches!(shape, Shape::Polygon(_)) { 0.0 } else { 0.5 };
    let extent = shape.extent();
    let reference = within(r, 1.0).zip_map(&extent, |x, a| x * a * s(place));
    ObstacleSpec {
        center: within(r, 0.5),
        rotation: Matrix::from_fn(|i, j| s(turn[(i, j)])),
        shape,
        wall: r.random_bool(0.2),
        reference,
        velocity: within(r, 1.0),
        growth: s(r.random_range(-0.1..0.1)),
        ..ObstacleSpec::default()
    }
}

fn campaign<S: Scalar, const D: usize>(seed: u64) {
    let all: u64 = std::env::var("PLIANT_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let r = &mut ChaCha8Rng::seed_from_u64(seed);
    let (mut compared, mut inside, mut slanting, mut worst) = (0u64, 0u64, 0u64, 0.0f64);
    let (mut unusable, mut saturated) = (0u64, 0u64);
    while compared < all / 2 {
        let Ok(obstacle) = Obstacle::new(spec::<S, D>(r)) else { continue };
        for _ in 0..20 {
            let way = Vector::<S, D>::from_fn(|_, _| S::from_f64(r.random_range(-1.0..1.0)));
            // From deep inside over the surface itself to far away.
            let away =
                [1.0, r.random_range(0.1..2.0), 10f64.powf(r.random_range(-4.0..0.5))][r.random_range(0..3usize)];
            let center = obstacle.spec().center;
            let x = center + (obstacle.surface(&way) - center) * S::from_f64(away);
            let f = Vector::<S, D>::from_fn(|_, _| S::from_f64(r.random_range(-1.0..1.0)));
            let o = obstacle.sample(&x);
            let mut modulation: Modulation<S, D, 1> = Modulation::new(&f);
            modulation.push(&o);
            let (velocity, refused) = modulation.finish(o.gamma, None);
            let (outward, arm) = (exact(&o.outward), exact(&o.arm));
            let cos = outward.dot(&arm) / (outward.norm() * arm.norm());
            if refused {
                // Only where the basis is none: within rounding of 1e-6 |g|_1 |r|_1, at most D |g| |r|, or where all of it is rounding.
                let few = 64.0 * S::EPSILON.to_f64() * D as f64;
                assert!(!(cos > 4e-6) || outward.dot(&arm) < few || S::EPSILON.to_f64() > 5e-7 && arm.norm() < few);
                unusable += 1;
                continue;
            }
            let surface_velocity = exact(&o.surface_velocity);
            let o = Sample { gamma: o.gamma.to_f64(), outward, arm, surface_velocity };
            let f = exact(&f);
            // In fixed point (g.u)/(g.r) may not fit: next to a reference point, or where it is seen slantingly.
            let factor = o.outward.dot(&(f - o.surface_velocity)) / o.outward.dot(&o.arm);
            if 2.0 * factor.abs() > S::MAX.to_f64() {
                saturated += 1;
                continue;
            }
            let error = (exact(&velocity) - explicit(&f, &o)).norm();
            let bound = bound::<S, D>(&f, &o);
            worst = worst.max(error / bound);
            assert!(error <= bound, "{error:e} over {bound:e}, {cos} {f:?} {o:?} {:?}", obstacle.spec());
            compared += 1;
            inside += u64::from(o.gamma <= 1.0);
            slanting += u64::from(cos < 0.3);
        }
    }
    println!(
        "{D}-D: {compared}, {inside} inside, {slanting} slanting, {unusable} without a basis, {saturated} too large; of the bound {worst}"
    );
    assert!(unusable * 4 < compared && saturated * 10 < compared);
    assert!(inside * 10 > compared && slanting * 50 > compared);
}

macro_rules! campaigns {
    ($($name:ident: $scalar:ty, $d:literal, $seed:literal;)+) => {
        $(#[test] fn $name() { campaign::<$scalar, $d>($seed); })+
    };
}
campaigns! {
    explicit_2d_f64: f64, 2, 51;
    explicit_3d_f64: f64, 3, 52;
    explicit_2d_f32: f32, 2, 53;
    explicit_3d_f32: f32, 3, 54;
    explicit_2d_fixed: Fixed, 2, 55;
    explicit_3d_fixed: Fixed, 3, 56;
}
