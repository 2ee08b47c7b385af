//! A scan as one obstacle, section 2 of docs/method.md: n = r = nbar/|nbar| and G = min_i Gamma_i/|nbar|, by formulas of their own in f64.

extern crate std;

use super::*;
use crate::Table;
use crate::scalar::Fixed;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::vec::Vec;

/// min_i Gamma_i, and nbar.
fn expected<const D: usize>(points: &[Vector<f64, D>], radius: f64, x: &Vector<f64, D>) -> (f64, Vector<f64, D>) {
    let gammas: Vec<f64> = points.iter().map(|p| (x - p).norm_squared() / (radius * radius)).collect();
    let all: f64 = gammas.iter().map(|g| 1.0 / (g - 1.0)).sum();
    let each = points.iter().zip(&gammas).map(|(p, g)| (x - p).normalize() * (1.0 / (g - 1.0) / all));
    (gammas.iter().fold(f64::MAX, |m, g| m.min(*g)), each.sum())
}

#[test]
fn two_points_by_hand() {
    // At 2 and 3 radii, at right angles: 1/3 and 1/8 of 11/24, so nbar = (8, 3)/11.
    let points = [Vector::<f64, 2>::new(-0.2, 0.0), Vector::<f64, 2>::new(0.0, -0.3)];
    let scan = Scan::new(&points, 0.1).unwrap();
    let (gamma, sample) = scan.sample(&Vector::zeros());
    let sample = sample.unwrap();
    let length = 73f64.sqrt() / 11.0;
    assert!((gamma - 4.0).abs() < 1e-12 && (sample.gamma - 4.0 / length).abs() < 1e-12, "{gamma} {sample:?}");
    let normal = Vector::<f64, 2>::new(8.0, 3.0) / 73f64.sqrt();
    assert!((sample.outward - normal).norm() < 1e-12 && (sample.arm - normal).norm() < 1e-12, "{sample:?}");
    assert_eq!(sample.surface_velocity, Vector::<f64, 2>::zeros());
}

#[test]
fn in_the_middle_of_a_gap_there_is_nothing_to_go_round() {
    let points = [Vector::<f64, 2>::new(-0.2, 0.0), Vector::<f64, 2>::new(0.2, 0.0)];
    let scan = Scan::new(&points, 0.1).unwrap();
    let (gamma, sample) = scan.sample(&Vector::zeros());
    assert!((gamma - 4.0).abs() < 1e-12 && sample.is_none());
    // Off the middle G falls from there: as far as nbar is short.
    let mut last = f64::MAX;
    for off in [1e-6, 1e-4, 1e-2, 0.05, 0.09] {
        let sample = scan.sample(&Vector::<f64, 2>::new(off, 0.0)).1.unwrap();
        assert!(sample.gamma < last && sample.outward == Vector::<f64, 2>::new(-1.0, 0.0), "{off} {sample:?}");
        last = sample.gamma;
    }
}

fn compare<S: Scalar, const D: usize>(seed: u64) {
    let r = &mut ChaCha8Rng::seed_from_u64(seed);
    let vector =
        |r: &mut ChaCha8Rng, most: f64| Vector::<S, D>::from_fn(|_, _| S::from_f64(r.random_range(-most..most)));
    let eps = S::EPSILON.to_f64();
    let (mut bent, mut long) = (0, 0);
    for _ in 0..20_000 {
        let n = if r.random_bool(0.5) { r.random_range(1..=4) } else { r.random_range(1..=MAX_POINTS) };
        let points: Vec<Vector<S, D>> = (0..n).map(|_| vector(r, 0.5)).collect();
        let radius = S::from_f64(r.random_range(0.05..0.1f64));
        let scan = Scan::new(&points, radius).unwrap();
        let x = vector(r, 0.6);
        let exact: Vec<Vector<f64, D>> = points.iter().map(|p| p.map(S::to_f64)).collect();
        let (least, normal) = expected(&exact, radius.to_f64(), &x.map(S::to_f64));
        let (gamma, sample) = scan.sample(&x);
        // Gamma has the rounding of (x - p)/R twice, over R of 5 cm, and of the square.
        let few = 8.0 * eps * (1.0 + 1.0 / 0.05) * least.max(1.0);
        assert!((gamma.to_f64() - least).abs() <= few, "{gamma} is not {least}");
        // Close to a surface a weight is as uncertain as Gamma - 1 is.
        if least < 1.05 {
            continue;
        }
        let share = normal.norm();
        let uncertain = 8.0 * few / (least - 1.0) + 256.0 * eps;
        let Some(sample) = sample else {
            assert!(least / share.max(1e-300) >= 0.9 * S::FAR.to_f64(), "nothing at {least} / {share}");
            continue;
        };
        let off = (sample.outward.map(S::to_f64) - normal / share).norm();
        assert!(off <= 4.0 * uncertain / share, "{off} of {uncertain} / {share}");
        assert_eq!(sample.outward, sample.arm);
        let effective = least / share;
        let off = (sample.gamma.to_f64() / effective - 1.0).abs();
        assert!(off <= 2.0 * (few / least + uncertain / share) + uncertain, "{off} of {effective}");
        long += i32::from(share > 0.99);
        bent += i32::from(share < 0.9);
    }
    assert!(bent > 5000 && long > 500, "{bent} {long}");
}

#[test]
fn it_is_one_obstacle_by_the_length_of_the_mean_normal() {
    compare::<f64, 2>(1);
    compare::<f64, 3>(2);
    compare::<f32, 2>(3);
    compare::<f32, 3>(4);
    compare::<Fixed, 2>(5);
    compare::<Fixed, 3>(6);
}

/// Who knows no age gives the oldest; and what comes out of a table does not age twice.
#[test]
fn an_age_counts_once_and_none_as_the_oldest() {
    let ageing = Ageing { time_to_live: 0.2, growth: 0.02, hold: 1.0 };
    let scan = || Scan::new(&[Vector::<f64, 2>::new(0.2, 0.0)], 0.05).unwrap();
    let mut table: Table<f64, 2, 1> = Table::new();
    for (age, radius) in [(0.0, 0.05), (-1.0, 0.05), (0.7, 0.06), (f64::INFINITY, 0.066), (f64::NAN, 0.066)] {
        table.set_scan(scan(), age, &ageing);
        assert!((table.scan().radius() - radius).abs() < 1e-12, "{age}: {}", table.scan().radius());
        table.set_scan(table.scan().clone(), age, &ageing);
        assert!((table.scan().radius() - radius).abs() < 1e-12, "{age} again: {}", table.scan().radius());
    }
}
