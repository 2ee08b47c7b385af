//! The figures of merit once more, by their definitions and from plain numbers: what `quality` computes has to be the same.

use crate::learn::evaluate::Motion;
use crate::learn::gmm::Mixture;
use crate::learn::quality::{NEAR, Quality, Recording, measure, warping_distance};
use nalgebra::{SMatrix, SVector};

/// dx/dt = -rate x, with one component that rules everywhere.
fn towards_zero<const D: usize>(rate: f64) -> Motion<D> {
    let one = Mixture::new(vec![1.0], vec![SVector::zeros()], vec![SMatrix::identity()]).expect("a Gaussian");
    Motion { attractor: SVector::zeros(), mixture: one, a: vec![SMatrix::identity() * -rate] }
}

fn recording<const D: usize>(rows: &[(f64, [f64; D], [f64; D])]) -> Recording<D> {
    let vector = |c: &[f64; D]| SVector::<f64, D>::from_column_slice(c);
    Recording {
        t: rows.iter().map(|r| r.0).collect(),
        x: rows.iter().map(|r| vector(&r.1)).collect(),
        v: rows.iter().map(|r| vector(&r.2)).collect(),
    }
}

/// The whole table of alignments, textbook fashion: the least sum of distances of a path of pairs from the first to the last, no pair more than
/// 20 apart.
fn warped<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    let distance = |i: usize, j: usize| -> f64 { (0..D).map(|c| (a[i][c] - b[j][c]).powi(2)).sum::<f64>().sqrt() };
    let mut least = vec![vec![f64::INFINITY; b.len() + 1]; a.len() + 1];
    least[0][0] = 0.0;
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            if i.abs_diff(j) <= 20 {
                let before = least[i - 1][j - 1].min(least[i - 1][j]).min(least[i][j - 1]);
                least[i][j] = before + distance(i - 1, j - 1);
            }
        }
    }
    least[a.len()][b.len()]
}

/// 200 points at equal lengths along a line through places.
fn spread<const D: usize>(places: &[[f64; D]]) -> Vec<[f64; D]> {
    let length = |a: &[f64; D], b: &[f64; D]| (0..D).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt();
    let whole: f64 = places.windows(2).map(|w| length(&w[0], &w[1])).sum();
    (0..200)
        .map(|i| {
            let mut left = whole * f64::from(i) / 199.0;
            for w in places.windows(2) {
                let step = length(&w[0], &w[1]);
                if left <= step {
                    return std::array::from_fn(|c| w[0][c] + (w[1][c] - w[0][c]) * left / step);
                }
                left -= step;
            }
            places[places.len() - 1]
        })
        .collect()
}

#[test]
fn rmse_is_the_mean_over_samples_of_the_root_of_the_mean_over_axes() {
    // The motion moves at -x; the demonstrator is off by (3, 4), (0, 0) and (-6, 8): roots of 25/2, 0 and 100/2.
    let plane = recording(&[
        (0.0, [1.0, 2.0], [-1.0 + 3.0, -2.0 + 4.0]),
        (1.0, [2.0, -1.0], [-2.0, 1.0]),
        (2.0, [0.5, 0.5], [-0.5 - 6.0, -0.5 + 8.0]),
    ]);
    let expected = (12.5f64.sqrt() + 50f64.sqrt()) / 3.0;
    assert!((measure(&towards_zero(1.0), &[plane], 1.0).rmse - expected).abs() < 1e-12);
    // In space over three axes, and over the samples of all demonstrations alike.
    let off = |e: f64| [-1.0 + e, -1.0 + 2.0 * e, -1.0 - 2.0 * e];
    let one = recording(&[(0.0, [1.0; 3], off(1.0)), (1.0, [1.0; 3], off(1.0)), (2.0, [1.0; 3], off(1.0))]);
    let other = recording(&[(0.0, [1.0; 3], off(0.0)), (1.0, [1.0; 3], off(4.0))]);
    let root = |e: f64| (9.0 * e * e / 3.0).sqrt();
    let expected = (3.0 * root(1.0) + root(4.0)) / 5.0;
    assert!((measure(&towards_zero(1.0), &[one, other], 1.0).rmse - expected).abs() < 1e-12);
}

#[test]
fn e_dot_is_the_mean_of_one_less_the_cosine_whatever_the_speeds() {
    // Along, across, against, at 60 degrees; where the demonstrator stands still there is no angle.
    let (c, s) = (0.5, 0.75f64.sqrt());
    let r = recording(&[
        (0.0, [1.0, 0.0], [-7.0, 0.0]),
        (1.0, [2.0, 0.0], [0.0, 0.1]),
        (2.0, [0.5, 0.0], [3.0, 0.0]),
        (3.0, [0.4, 0.0], [-2.0 * c, 2.0 * s]),
        (4.0, [0.3, 0.0], [0.0, 0.0]),
    ]);
    let expected = (0.0 + 1.0 + 2.0 + 0.5) / 4.0;
    assert!((measure(&towards_zero(1.0), &[r], 1.0).e_dot - expected).abs() < 1e-12);
}

#[test]
fn dtwd_is_the_least_sum_of_distances_of_200_points_each() {
    // The motion goes straight to zero from the first sample; by Runge-Kutta each step shortens the way by one factor, to a hundredth of the extent.
    let (extent, rate) = (0.5, 1.3);
    let bent = [[0.3, 0.1], [0.25, 0.3], [-0.1, 0.2], [-0.05, 0.05], [0.0, 0.0]];
    let rows: Vec<_> = bent.iter().enumerate().map(|(i, x)| (0.4 * i as f64, *x, [0.1, 0.0])).collect();
    let found = measure(&towards_zero(rate), &[recording(&rows)], extent);
    let h = rate * 1.6 / 400.0;
    let factor = 1.0 - h + h * h / 2.0 - h.powi(3) / 6.0 + h.powi(4) / 24.0;
    let mut left = 1.0;
    while left * bent[0][0].hypot(bent[0][1]) > NEAR * extent {
        left *= factor;
    }
    let straight = spread(&[bent[0], bent[0].map(|c| c * left)]);
    let expected = warped(&spread(&bent), &straight);
    assert!((found.dtwd - expected).abs() < 1e-9 * expected && expected > 5.0, "{} {expected}", found.dtwd);
    // The mean over demonstrations, not the sum.
    let twice = measure(&towards_zero(rate), &[recording(&rows), recording(&rows)], extent);
    assert!((twice.dtwd - found.dtwd).abs() < 1e-12 && (twice.converged, twice.rollouts) == (2, 2));
}

/// Paths that run ahead of one another by more than the window allows, and less.
#[test]
fn alignments_are_those_of_the_whole_table() {
    let path = |i: i32, warp: f64| {
        let s = f64::from(i) / 199.0;
        let s = s + warp * (std::f64::consts::PI * s).sin().powi(2);
        [0.4 * (5.0 * s).cos(), 0.3 * (7.0 * s).sin(), 0.2 * s]
    };
    for warp in [0.0, 0.05, 0.2, -0.3] {
        let [a, b] = [0.0, warp].map(|w| (0..200).map(|i| path(i, w)).collect::<Vec<[f64; 3]>>());
        let vectors =
            |p: &[[f64; 3]]| p.iter().map(|x| SVector::from_column_slice(x)).collect::<Vec<SVector<f64, 3>>>();
        let (found, expected) = (warping_distance(&vectors(&a), &vectors(&b)).0, warped(&a, &b));
        assert!((found - expected).abs() < 1e-9, "{warp}: {found} {expected}");
    }
}

/// Of a thousand samples every fifth is judged, and rollouts begin at the twentieth.
#[test]
fn a_long_recording_is_judged_at_every_fifth_sample_and_from_the_twentieth_on() {
    let at = |i: usize| {
        let s = 1.0 - i as f64 / 999.0;
        [0.3 * s, 0.1 * s]
    };
    let rows = |poisoned: bool| -> Vec<(f64, [f64; 2], [f64; 2])> {
        let row = |i: usize| {
            let v = if poisoned && !i.is_multiple_of(5) { [1e6, -1e6] } else { at(i).map(|c| -c) };
            (i as f64 * 1e-3, if poisoned && i < 19 { at(i).map(|c| c + 0.004 * (i % 5) as f64) } else { at(i) }, v)
        };
        (0..1000).map(row).collect()
    };
    let of = |poisoned: bool| measure(&towards_zero::<2>(1.0), &[recording(&rows(poisoned))], 0.3);
    let [clean, poisoned]: [Quality; 2] = [false, true].map(of);
    assert!(clean.rmse < 1e-12 && clean.e_dot < 1e-12);
    assert_eq!((poisoned.rmse, poisoned.e_dot, poisoned.dtwd), (clean.rmse, clean.e_dot, clean.dtwd));
}
