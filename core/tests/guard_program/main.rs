//! The half-space programme against an enumeration of everything that could be active, for every shape of input.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

mod brute;
mod sample;

use pliant_core::guard::{HalfSpace, Solution, nearest};
use pliant_core::scalar::Fixed;
use pliant_core::{Scalar, Vector};
use proptest::prelude::*;
use sample::{Problem, Random};

fn solve<S: Scalar, const D: usize>(p: &Problem<S, D>) -> Solution<S, D> {
    nearest(&p.wanted, &mut p.sides.clone(), p.speed)
}

fn exact<S: Scalar, const D: usize>(v: &Vector<S, D>) -> Vector<f64, D> {
    v.map(Scalar::to_f64)
}

/// Of numbers of the size of the speed, over that: in fixed point all are equally coarse.
fn rounding<S: Scalar>(speed: f64) -> f64 {
    S::EPSILON.to_f64() / if S::FLOATS { 1.0 } else { speed }
}

/// Every promise of one answer, for the problem scaled to a speed of one.
fn check<S: Scalar, const D: usize>(p: &Problem<S, D>) {
    let found = solve(p);
    let speed = p.speed.to_f64();
    let (wanted, u) = (exact(&p.wanted) / speed, exact(&found.velocity) / speed);
    let sides: Vec<brute::Side<D>> = p.sides.iter().map(|h| (exact(&h.normal), h.offset.to_f64() / speed)).collect();
    let eps = rounding::<S>(speed);
    let violation = found.violation.to_f64() / speed;
    let margin = 68.0 * eps * (1.0 + violation) + 1e-11;
    let worst = brute::worst(&sides, &u);
    let distance = (u - wanted).norm();

    assert!(u.norm() <= 1.0 + 17.0 * eps, "too fast by {:e}: {found:?} {p:?}", u.norm() - 1.0);
    assert_eq!(found.changed, found.velocity != p.wanted);
    assert!(found.feasible || !p.room, "there is room: {found:?} {p:?}");
    assert_eq!(found.feasible, found.violation == S::zero());
    assert!((worst - violation).abs() <= margin, "violates {worst:e}: {found:?} {p:?}");

    let allowed = brute::nearest(&wanted, &sides);
    let least = if allowed.is_some() { 0.0 } else { brute::least_violation(&sides) };
    assert!(worst <= least + margin, "violates {worst:e} over {least:e}: {found:?} {p:?}");
    let best = |lower: f64| {
        let moved: Vec<brute::Side<D>> = sides.iter().map(|(n, b)| (*n, b - lower)).collect();
        brute::nearest(&wanted, &moved).map(|(d, _)| d)
    };
    let (best, by) = if least > margin {
        // What is left is as good as a point, which rounding moves by its root, and farther along planes nearly parallel.
        (if p.blunt { best(least) } else { None }, 1e-4)
    } else if allowed.is_some_and(|(d, _)| distance <= d + margin) {
        return;
    } else {
        // As good as for offsets higher by what rounding may do, if anything is left then.
        (best(-margin), margin)
    };
    assert!(best.is_none_or(|d| distance <= d + by), "{distance:e} and not {best:?}: {found:?} {p:?}");
}

/// The same half-spaces in another order give the same answer, as far as rounding goes.
fn check_orders<S: Scalar, const D: usize>(p: &Problem<S, D>, random: &mut Random) {
    let one = solve(p);
    let mut sides = p.sides.clone();
    random.shuffle(&mut sides);
    let other = solve(&Problem { sides, ..p.clone() });
    let unit = p.speed.to_f64();
    let margin = 68.0 * rounding::<S>(unit) * (1.0 + one.violation.to_f64() / unit) + 1e-11;
    let difference = (one.violation - other.violation).to_f64().abs() / unit;
    assert!(difference <= margin, "{one:?} {other:?} {p:?}");
    if p.blunt {
        let apart = (exact(&one.velocity) - exact(&other.velocity)).norm() / unit;
        assert!(apart <= 4.0 * margin.sqrt(), "{apart:e} apart: {one:?} {other:?} {p:?}");
    }
}

fn campaign<S: Scalar, const D: usize>(seed: u64, samples: usize, most: usize) {
    let mut random = Random(seed);
    for _ in 0..samples {
        let problem = random.problem::<S, D>(most);
        check(&problem);
        check_orders(&problem, &mut random);
    }
}

#[test]
fn few_in_the_plane() {
    campaign::<f64, 2>(1, 100_000, 6);
    campaign::<f32, 2>(2, 100_000, 6);
}

#[test]
fn few_in_space() {
    campaign::<f64, 3>(3, 100_000, 5);
    campaign::<f32, 3>(4, 100_000, 5);
}

#[test]
fn few_in_fixed_point() {
    campaign::<Fixed, 2>(10, 100_000, 6);
    campaign::<Fixed, 3>(11, 100_000, 5);
}

#[test]
fn many_in_the_plane() {
    campaign::<f64, 2>(5, 3000, 30);
    campaign::<f32, 2>(6, 3000, 30);
}

#[test]
fn many_in_space() {
    campaign::<f64, 3>(7, 250, 30);
    campaign::<f32, 3>(8, 250, 30);
}

#[test]
fn any_order_of_very_many() {
    let mut random = Random(9);
    for _ in 0..2000 {
        check_orders(&random.problem::<f32, 2>(200), &mut random);
        check_orders(&random.problem::<f32, 3>(200), &mut random);
        check_orders(&random.problem::<f64, 3>(200), &mut random);
    }
}

fn side<const D: usize>(normal: [f64; D], offset: f64) -> HalfSpace<f64, D> {
    HalfSpace { normal: normal.into(), offset }
}

fn close<const D: usize>(found: &Solution<f64, D>, velocity: [f64; D], violation: f64) {
    assert!((found.velocity - Vector::from(velocity)).norm() < 1e-7, "{found:?}");
    assert!((found.violation - violation).abs() < 1e-12 && found.feasible == (violation == 0.0), "{found:?}");
}

#[test]
fn what_is_allowed_stays_to_the_bit() {
    let wanted = Vector::<f64, 3>::new(0.1, -0.2, 0.3);
    let mut sides = [side([1.0, 0.0, 0.0], 0.1), side([0.0, 0.0, -1.0], -0.4)];
    let found = nearest(&wanted, &mut sides, 0.5);
    assert_eq!(found, Solution { velocity: wanted, changed: false, violation: 0.0, feasible: true });
    let limited = wanted * (0.3 / wanted.norm());
    assert!(!nearest(&limited, &mut [], 0.3).changed);
    assert!((nearest(&wanted, &mut [], 0.3).velocity - limited).norm() < 1e-16);
}

#[test]
fn squeezed_between_two_walls_the_rest_stays_wanted() {
    // Both ask for 0.1 m/s their way: neither gets it, and along the walls nothing changes.
    let wanted = Vector::<f64, 3>::new(0.05, 0.2, -0.1);
    let mut walls = [side([1.0, 0.0, 0.0], 0.1), side([-1.0, 0.0, 0.0], 0.1)];
    close(&nearest(&wanted, &mut walls, 0.5), [0.0, 0.2, -0.1], 0.1);
    // One for 0.1, the other for 0.3.
    let mut walls = [side([1.0, 0.0, 0.0], 0.1), side([-1.0, 0.0, 0.0], 0.3)];
    close(&nearest(&wanted, &mut walls, 0.5), [-0.1, 0.2, -0.1], 0.2);
    // Walls that leave just one speed.
    let mut walls = [side([1.0, 0.0, 0.0], 0.1), side([-1.0, 0.0, 0.0], -0.1), side([1.0, 0.0, 0.0], 0.1)];
    close(&nearest(&wanted, &mut walls, 0.5), [0.1, 0.2, -0.1], 0.0);
}

#[test]
fn asked_for_more_than_the_robot_can() {
    let wanted = Vector::<f64, 2>::new(-0.1, 0.2);
    close(&nearest(&wanted, &mut [side([0.6, 0.8], 0.5)], 0.5), [0.3, 0.4], 0.0);
    close(&nearest(&wanted, &mut [side([0.6, 0.8], 1.5)], 0.5), [0.3, 0.4], 1.0);
    close(&nearest(&wanted, &mut [side([0.6, 0.8], 0.5)], 0.0), [0.0, 0.0], 0.5);
    close(&nearest(&wanted, &mut [side([0.6, 0.8], 0.5)], f64::NAN), [0.0, 0.0], 0.5);
}

#[test]
fn what_has_no_side_is_ignored() {
    let wanted = Vector::<f64, 2>::new(0.0, 0.2);
    let none = [side([0.0, 0.0], 1.0), side([f64::NAN, 0.0], 1.0), side([0.0, 1.0], f64::NAN)];
    for place in 0..4 {
        let mut sides = none.to_vec();
        sides.insert(place, side([0.0, -1.0], 0.1));
        close(&nearest(&wanted, &mut sides, 0.5), [0.0, -0.1], 0.0);
    }
    close(&nearest(&wanted, &mut none.clone(), 0.5), [0.0, 0.2], 0.0);
}

fn hostile() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        Just(1.0),
        Just(-1.0),
        -1.0..1.0f64,
        (-40.0..38.0f64).prop_map(|e| 10f64.powf(e)),
        (-40.0..38.0f64).prop_map(|e| -10f64.powf(e)),
    ]
}

fn check_hostile<S: Scalar, const D: usize>(wanted: [f64; 3], sides: &[([f64; 3], f64)], speed: f64, unit: bool) {
    let vector = |v: [f64; 3]| Vector::<S, D>::from_fn(|i, _| S::from_f64(v[i]));
    let mut sides: Vec<HalfSpace<S, D>> = sides
        .iter()
        .map(|(n, b)| {
            let normal: Vector<S, D> = vector(*n);
            // Over its largest entry first, so that its square fits.
            let largest = normal.iter().fold(S::zero(), |m, n| m.max(n.abs()));
            let normal = if unit && largest > S::zero() {
                let normal = normal / largest;
                normal / normal.dot(&normal).sqrt()
            } else {
                normal
            };
            HalfSpace { normal, offset: S::from_f64(*b) }
        })
        .collect();
    let speed = S::from_f64(speed);
    let found = nearest(&vector(wanted), &mut sides, speed);
    assert!(found.velocity.iter().all(|x| x.is_finite()) && found.violation >= S::zero(), "{found:?}");
    let length = exact(&found.velocity).norm();
    // Squares of less than 1e-22 m/s vanish in f32.
    let eps = S::EPSILON.to_f64();
    let limit = speed.max(S::zero()).to_f64() * (1.0 + 20.0 * eps) + if S::FLOATS { 1e-20 } else { 20.0 * eps };
    assert!(length <= limit, "{length} {found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn finite_whatever_comes(
        wanted in prop::array::uniform3(hostile()),
        sides in prop::collection::vec((prop::array::uniform3(hostile()), hostile()), 0..8),
        speed in prop_oneof![0.0..1.0f64, (-20.0..3.0f64).prop_map(|e| 10f64.powf(e)), Just(-1.0)],
        unit in any::<bool>(),
    ) {
        check_hostile::<f32, 2>(wanted, &sides, speed, unit);
        check_hostile::<f64, 2>(wanted, &sides, speed, unit);
        check_hostile::<f32, 3>(wanted, &sides, speed, unit);
        check_hostile::<f64, 3>(wanted, &sides, speed, unit);
        // In fixed point a normal's square does not fit, or has no digits, unless it is about one.
        check_hostile::<Fixed, 2>(wanted, &sides, speed, true);
        check_hostile::<Fixed, 3>(wanted, &sides, speed, true);
    }
}
