use super::*;
use nalgebra::SVector;
use pliant_core::{Component, Fixed};
use proptest::prelude::*;
use std::cell::Cell;

fn model<S: Scalar, const D: usize>(p: &SMatrix<f64, D, D>, a: &SMatrix<f64, D, D>) -> LpvDs<S, D> {
    let part = Component {
        log_weight: S::zero(),
        mean: SVector::zeros(),
        whitening: SMatrix::identity(),
        a: a.map(S::from_f64),
    };
    LpvDs::new(SVector::zeros(), p.map(S::from_f64), &[part]).expect("within range")
}

/// P = R R', and A of which A'P + PA = -2 L L' + edge I but for rounding: on the edge where L has not full rank. From lists of numbers.
fn on_the_edge<const D: usize>(
    numbers: &[f64],
    flat: f64,
    thin: f64,
    edge: f64,
) -> Option<(SMatrix<f64, D, D>, SMatrix<f64, D, D>)> {
    let mut rest = numbers.iter().copied();
    let mut next = || rest.next().unwrap_or(0.0);
    let mut r = SMatrix::<f64, D, D>::zeros();
    let mut l = SMatrix::<f64, D, D>::zeros();
    let mut skew = SMatrix::<f64, D, D>::zeros();
    for i in 0..D {
        for j in 0..=i {
            r[(i, j)] = if i == j { 0.4 + next().abs() } else { next() };
            l[(i, j)] = 2.0 * next();
            if i != j {
                let s = 5.0 * next();
                (skew[(i, j)], skew[(j, i)]) = (s, -s);
            }
        }
    }
    r[(D - 1, D - 1)] *= flat;
    l[(D - 1, D - 1)] *= thin;
    let p = r * r.transpose();
    let p = (p + p.transpose()) * 0.5;
    let a = p.try_inverse()? * (skew - l * l.transpose() + SMatrix::identity() * (0.5 * edge));
    a.iter().all(|x| x.abs() < 1e3).then_some((p, a))
}

/// What the core accepts is so, and at the rate it says; returns what the core said.
fn core_against_proof<S: Scalar, const D: usize>(p: &SMatrix<f64, D, D>, a: &SMatrix<f64, D, D>) -> bool {
    let model = model::<S, D>(p, a);
    let Ok(certified) = model.clone().certify() else { return false };
    let rate = certified.certificate().rate.to_f64();
    let proof = prove(&model).expect("the core accepts what does not hold");
    assert!(rate <= proof.margin * (1.0 + 1e-6), "the core: {rate}, the proof: {}", proof.margin);
    true
}

fn in_every_precision<const D: usize>(p: &SMatrix<f64, D, D>, a: &SMatrix<f64, D, D>) -> [bool; 3] {
    [core_against_proof::<f32, D>(p, a), core_against_proof::<f64, D>(p, a), core_against_proof::<Fixed, D>(p, a)]
}

/// Around the edge, in the plane and in space, with P and the decrease from round to nearly singular: the core's rounded check never accepts what
/// does not hold. And it is not by refusing everything.
#[test]
fn what_the_core_accepts_is_proved() {
    let accepted: [[Cell<u32>; 3]; 2] = Default::default();
    let count = |d: usize, found: [bool; 3]| {
        for (cell, found) in accepted[d].iter().zip(found) {
            cell.set(cell.get() + u32::from(found));
        }
    };
    let mut runner = proptest::test_runner::TestRunner::new_with_rng(
        ProptestConfig::with_cases(1000),
        proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha),
    );
    let numbers = prop::collection::vec(-1.0..1.0f64, 15);
    let given = (numbers, -4.0..0.0f64, -8.0..0.0f64, -17.0..-1.0f64, prop::bool::ANY);
    runner
        .run(&given, |(numbers, flat, thin, unit, beyond)| {
            let edge = 10f64.powf(unit) * if beyond { 1.0 } else { -1.0 };
            let (flat, thin) = (10f64.powf(flat), 10f64.powf(thin));
            if let Some((p, a)) = on_the_edge::<2>(&numbers, flat, thin, edge) {
                count(0, in_every_precision(&p, &a));
            }
            if let Some((p, a)) = on_the_edge::<3>(&numbers, flat, thin, edge) {
                count(1, in_every_precision(&p, &a));
            }
            Ok(())
        })
        .expect("holds");
    for cell in accepted.iter().flatten() {
        assert!(cell.get() > 20, "{accepted:?}");
    }
}

/// On small whole numbers every verdict can be had from integers alone.
#[test]
fn the_verdict_is_that_of_whole_numbers() {
    let mut seen = [0; 2];
    for code in 0..7_i64.pow(4) {
        let entry = |i: u32| code / 7_i64.pow(i) % 7 - 3;
        let a = [[entry(0), entry(1)], [entry(2), entry(3)]];
        let p = [[2, 1], [1, 3]];
        // -(A'P + PA)
        let m = |r: usize, c: usize| -(0..2).map(|s| a[s][r] * p[s][c] + p[r][s] * a[s][c]).sum::<i64>();
        let holds = m(0, 0) > 0 && m(0, 0) * m(1, 1) > m(0, 1) * m(1, 0);
        let real = |m: [[i64; 2]; 2]| SMatrix::<f64, 2, 2>::from_fn(|r, c| m[r][c] as f64 / 1024.0);
        let found = prove(&model::<f32, 2>(&real(p), &real(a)));
        assert_eq!(found.is_ok(), holds, "{a:?}");
        seen[usize::from(holds)] += 1;
    }
    assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
}

#[test]
fn a_matrix_that_is_singular_by_one_digit_is_told_from_one_that_is_not() {
    // -(A + A') = [[2, 2 - e], [2 - e, 2]]: the determinant is 4 e - e^2.
    let a = |e: f64| SMatrix::<f64, 2, 2>::new(-1.0, e - 1.0, -1.0, -1.0);
    let p = SMatrix::identity();
    assert!(prove(&model::<f64, 2>(&p, &a(f64::EPSILON))).is_ok());
    assert_eq!(prove(&model::<f64, 2>(&p, &a(0.0))), Err(CertificateError::Component(0)));
    assert_eq!(prove(&model::<f64, 2>(&p, &a(-f64::EPSILON))), Err(CertificateError::Component(0)));
    let tilted = SMatrix::<f64, 2, 2>::new(1.0, 0.5, 0.5 + f64::EPSILON, 1.0);
    assert_eq!(prove(&model::<f64, 2>(&tilted, &a(1.0))), Err(CertificateError::Lyapunov));
}

#[test]
fn the_margin_is_the_slowest_component_s() {
    let slow = |rate: f64| SMatrix::<f64, 3, 3>::identity() * -rate;
    let parts = [3.0, 0.25, 1.0].map(|rate| Component {
        log_weight: 0.0,
        mean: SVector::zeros(),
        whitening: SMatrix::identity(),
        a: slow(rate),
    });
    let proof =
        prove(&LpvDs::new(SVector::zeros(), SMatrix::identity(), &parts).expect("within range")).expect("holds");
    assert_eq!(proof.slowest, 1);
    assert!(proof.margin < 0.25 && proof.margin > 0.25 * (1.0 - 2e-6), "{proof:?}");
}

proptest! {
    #[test]
    fn numbers_are_what_they_are(a in -1e6..1e6f64, b in -1e6..1e6f64, m in -1000i64..1000, n in -1000i64..1000) {
        let exact = |x: f64| Dyadic::new(x).expect("finite");
        let same = |a: &Dyadic, b: &Dyadic| (a - b).is_zero();
        let (x, y) = (exact(a), exact(b));
        prop_assert_eq!((&x - &y).is_positive(), a > b);
        prop_assert!(same(&(&(&x + &y) - &y), &x));
        let (small, large) = (m as f64 / 64.0, n as f64 * 8.0);
        prop_assert!(same(&(&exact(small) * &exact(large)), &exact((m * n) as f64 / 8.0)));
    }
}

#[test]
fn the_ends_of_the_range_are_exact() {
    let exact = |x: f64| Dyadic::new(x).expect("finite");
    let least = exact(f64::from_bits(1));
    assert!(least.is_positive() && (&exact(f64::MIN_POSITIVE) - &least).is_positive());
    assert!((&(&exact(f64::MAX) + &least) - &exact(f64::MAX)).is_positive());
    assert!(exact(-0.0).is_zero() && Dyadic::new(f64::NAN).is_none() && Dyadic::new(f64::INFINITY).is_none());
}
