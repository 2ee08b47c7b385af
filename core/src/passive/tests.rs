use super::*;
use crate::{Fixed, rotation};
use nalgebra::{Rotation3, Vector2, Vector3};
use proptest::prelude::*;

/// Uniform numbers from a written seed (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn vector<S: Scalar, const D: usize>(&mut self, size: f64) -> Vector<S, D> {
        Vector::from_fn(|_, _| S::from_f64((self.next() * 2.0 - 1.0) * size))
    }
}

fn passive<S: Scalar>(along: f64, across: f64, share: f64) -> Passive<S> {
    let [lambda_along, lambda_across, share] = [along, across, share].map(S::from_f64);
    Passive::new(PassiveSpec { lambda_along, lambda_across, share, ..PassiveSpec::default() }).unwrap()
}

fn tank<S: Scalar>(energy: f64, capacity: f64) -> Tank<S> {
    Tank::new(S::from_f64(energy), S::from_f64(capacity)).unwrap()
}

/// A sum of products as exact as two doubles are (Knuth's and Dekker's error-free sums and products).
#[derive(Default)]
struct Exact(f64, f64);

impl Exact {
    fn add(&mut self, x: f64) {
        let sum = self.0 + x;
        let part = sum - self.0;
        self.1 += (self.0 - (sum - part)) + (x - part);
        self.0 = sum;
    }
    /// a b dt, with the rounding error of a b.
    fn add_product(&mut self, a: f64, b: f64, dt: f64) {
        self.add_times(a * b, dt);
        self.add(a.mul_add(b, -(a * b)) * dt);
    }
    fn add_times(&mut self, a: f64, b: f64) {
        self.add(a * b);
        self.add(a.mul_add(b, -(a * b)));
    }
    fn value(&self) -> f64 {
        self.0 + self.1
    }
}

proptest! {
    #[test]
    fn damping_has_the_flow_as_eigenvector(
        u in prop::array::uniform3(-1.0..1.0f64), e in -6.0..2.0f64,
        along in 0.01..1000.0f64, across in 0.01..1000.0f64,
    ) {
        let u = Vector3::from(u) * 10f64.powf(e);
        let p = passive::<f64>(along, across, 1.0);
        let d = p.damping(&u);
        prop_assert_eq!(d, d.transpose());
        let phi = u.norm_squared() / (u.norm_squared() + p.spec.blend.powi(2));
        let first = across + (along - across) * phi;
        prop_assert!((d * u - u * first).norm() <= 1e-12 * 1000.0 * u.norm());
        let mut expected = [first, across, across];
        let mut values: [f64; 3] = d.symmetric_eigen().eigenvalues.into();
        expected.sort_by(f64::total_cmp);
        values.sort_by(f64::total_cmp);
        for (value, expected) in values.iter().zip(expected) {
            prop_assert!(*value > 0.0 && (value - expected).abs() < 1e-9, "{value} {expected}");
        }
        let plane = Vector2::new(u[0], u[1]);
        prop_assert!(p.damping(&plane).symmetric_eigen().eigenvalues.iter().all(|x| *x > 0.0));
    }

    #[test]
    fn damping_has_a_bounded_slope_through_zero(
        a in prop::array::uniform3(-1.0..1.0f64), b in prop::array::uniform3(-1.0..1.0f64), e in -4.0..0.5f64,
        along in 0.01..1000.0f64, across in 0.01..1000.0f64,
    ) {
        let p = passive::<f64>(along, across, 1.0);
        let (a, b) = (Vector3::from(a) * 10f64.powf(e), Vector3::from(b) * 10f64.powf(e));
        let bound = core::f64::consts::FRAC_1_SQRT_2 * (along - across).abs() / p.spec.blend;
        // A line from a through zero and on to a little beyond, and one that goes to b.
        for to in [a * -1e-3, b] {
            let mut previous = p.damping(&a);
            for i in 1..=100 {
                let d = p.damping(&(a + (to - a) * (f64::from(i) / 100.0)));
                prop_assert!((d - previous).norm() <= bound * (to - a).norm() / 100.0 * 1.000_001 + 1e-10);
                previous = d;
            }
        }
        prop_assert_eq!(p.damping(&Vector3::zeros()), nalgebra::Matrix3::identity() * across);
    }

    #[test]
    fn the_frame_does_not_matter(
        v in prop::array::uniform3(-1.0..1.0f64), u in prop::array::uniform3(-1.0..1.0f64), e in -5.0..0.0f64,
        turn in prop::array::uniform3(-3.0..3.0f64), full in 0.0..0.001f64,
    ) {
        let p = passive::<f64>(20.0, 60.0, 0.7);
        let (v, u) = (Vector3::from(v), Vector3::from(u) * 10f64.powf(e));
        let q = Rotation3::new(Vector3::from(turn)).into_inner();
        prop_assert!((p.damping(&(q * u)) - q * p.damping(&u) * q.transpose()).norm() < 1e-11);
        let (mut here, mut there) = (tank(full, 0.01), tank(full, 0.01));
        let a = p.step(&mut here, &v, &u, 0.001).unwrap();
        let b = p.step(&mut there, &(q * v), &(q * u), 0.001).unwrap();
        prop_assert!((q * a.wrench - b.wrench).norm() < 1e-9, "{a:?} {b:?}");
        prop_assert!((here.energy() - there.energy()).abs() < 1e-12);

        let (v, u, q) = (Vector2::new(v[0], v[1]), Vector2::new(u[0], u[1]), rotation::planar(turn[0]));
        let (a, b) = (p.wrench(&v, &u).unwrap(), p.wrench(&(q * v), &(q * u)).unwrap());
        prop_assert!((q * a - b).norm() < 1e-11);
    }

    #[test]
    fn whatever_finite_input_a_finite_answer(
        v in prop::array::uniform3(prop_oneof![Just(0.0), -3.0..3.0f64, any::<f64>()]),
        u in prop::array::uniform3(prop_oneof![Just(0.0), -3.0..3.0f64, any::<f64>()]),
        dt in prop_oneof![Just(0.001), 0.0..0.1f64, any::<f64>()],
        fill in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64],
    ) {
        finite::<f64>(v, u, dt, fill)?;
        finite::<f32>(v, u, dt, fill)?;
        finite::<Fixed>(v, u, dt, fill)?;
    }
}

fn finite<S: Scalar>(v: [f64; 3], u: [f64; 3], dt: f64, fill: f64) -> Result<(), TestCaseError> {
    let (v, u) = (Vector::<S, 3>::from(v.map(S::from_f64)), Vector::<S, 3>::from(u.map(S::from_f64)));
    for p in [passive::<S>(20.0, 60.0, 1.0), passive(1000.0, 0.01, 0.5), passive(0.01, 1000.0, 0.0)] {
        let before = tank::<S>(fill, 1.0);
        let mut after = before;
        match p.step(&mut after, &v, &u, S::from_f64(dt)) {
            Err(_) => prop_assert_eq!(before, after),
            Ok(i) => {
                let (low, high) = (S::zero(), S::one());
                prop_assert!(i.wrench.iter().all(|x| x.is_finite()), "{i:?}");
                prop_assert!(i.drive_scale >= low && i.drive_scale <= high, "{i:?}");
                prop_assert!([i.filled, i.drawn, i.rejected].iter().all(|x| *x >= low && x.is_finite()), "{i:?}");
                prop_assert!(after.energy() >= low && after.energy() <= high);
            }
        }
    }
    Ok(())
}

/// A million steps of whatever comes: the energy through the port is at most what left the tank. Sums are taken in
/// twice double precision of the numbers returned, and the tolerance is one rounding of the tank's own reading, not one
/// a step.
fn never_gives_more_than_it_had<S: Scalar, const D: usize>(seed: u64) {
    let mut random = Random(seed);
    let (mut emptied, mut refused) = (0, 0);
    for (along, across, share, capacity, start) in [
        (20.0, 60.0, 1.0, 10.0, 5.0),
        (60.0, 20.0, 1.0, 0.05, 0.05),
        (20.0, 20.0, 0.6, 1.0, 0.5),
        (1000.0, 0.01, 1.0, 3.0, 0.0),
        (0.01, 1000.0, 0.9, 300.0, 300.0),
    ] {
        let p = passive::<S>(along, across, share);
        let mut tank = tank::<S>(start, capacity);
        let dt = S::from_f64(0.001);
        let (mut port, mut books) = (Exact::default(), Exact::default());
        let mut allowed = 0.0;
        let (mut v, mut u) = (Vector::<S, D>::zeros(), Vector::<S, D>::zeros());
        let mut size = 1.0;
        for k in 0..200_000 {
            // Changing scales, directions kept or turned, an adversary that always moves with the drive, one that moves
            // across.
            if k % 1000 == 0 {
                size = 10f64.powf(random.next() * 5.0 - 4.5);
            }
            if random.next() < 0.1 {
                u = random.vector(size);
            }
            v = match k / 5000 % 5 {
                0 => random.vector(size),
                1 => u * S::from_f64(random.next()),
                2 => u * S::from_f64(0.999 + 0.002 * random.next()),
                3 => v * S::from_f64(0.99) + random.vector(size * 0.01),
                _ => u * S::from_f64(0.5) + random.vector(size * 0.3),
            };
            let before = tank.energy();
            // Work that its numbers do not hold fixed point refuses, and no wrench is none.
            let Ok(i) = p.step(&mut tank, &v, &u, dt) else {
                refused += 1;
                continue;
            };
            assert!(tank.energy() >= S::zero() && tank.energy() <= tank.capacity());
            assert!(i.filled >= S::zero() && i.drawn >= S::zero() && i.rejected >= S::zero(), "{i:?}");
            if i.drive_scale < S::one() {
                assert_eq!(tank.energy(), S::zero(), "{i:?}");
                emptied += 1;
            }
            for (f, x) in i.wrench.iter().zip(&v) {
                port.add_product(f.to_f64(), x.to_f64(), dt.to_f64());
            }
            books.add(i.filled.to_f64());
            books.add(-i.drawn.to_f64());
            allowed += 4.0 * S::rounding(i.filled + i.drawn + i.rejected).to_f64();
            let reading = S::rounding(tank.energy()).to_f64();
            let change = tank.energy().to_f64() - start_of(&tank, start);
            assert!(port.value() <= -change + reading, "step {k}: {} J given, tank by {change} J", port.value());
            assert!((books.value() - change).abs() <= reading + allowed, "step {k}: {} {change}", books.value());
            // Nothing is lost either: what came in, less what fits, is there.
            let error = ((tank.energy() - before) - (i.filled - i.drawn)).abs();
            let numbers = tank.energy() + before + i.filled + i.drawn + i.rejected;
            assert!(error <= S::rounding(numbers) * S::from_f64(2.0), "{before} to {}: {i:?}", tank.energy());
        }
    }
    assert!(emptied > 1000, "the tank ran dry in {emptied} steps only");
    assert!(refused < if S::FLOATS { 1 } else { 400_000 }, "{refused} refused");
}

/// What the tank was made with, as its type holds it.
fn start_of<S: Scalar>(_: &Tank<S>, energy: f64) -> f64 {
    S::from_f64(energy).to_f64()
}

#[test]
fn passive_in_f32_and_2d() {
    never_gives_more_than_it_had::<f32, 2>(1);
}

#[test]
fn passive_in_f32_and_3d() {
    never_gives_more_than_it_had::<f32, 3>(2);
}

#[test]
fn passive_in_f64_and_2d() {
    never_gives_more_than_it_had::<f64, 2>(3);
}

#[test]
fn passive_in_f64_and_3d() {
    never_gives_more_than_it_had::<f64, 3>(4);
}

#[test]
fn passive_in_fixed_point_and_2d() {
    never_gives_more_than_it_had::<crate::Fixed, 2>(5);
}

#[test]
fn passive_in_fixed_point_and_3d() {
    never_gives_more_than_it_had::<crate::Fixed, 3>(6);
}

#[test]
fn what_is_too_little_to_see_is_still_counted() {
    // 2e-8 J a step beside 8 J, whose spacing in f32 is 1e-6 J: 1e6 steps take 0.02 J out, not nothing.
    let p = passive::<f32>(20.0, 20.0, 1.0);
    let mut tank = tank::<f32>(8.0, 10.0);
    let (v, u) = (Vector2::new(0.001, 0.0), Vector2::new(0.002, 0.0));
    for _ in 0..1_000_000 {
        p.step(&mut tank, &v, &u, 0.001).unwrap();
    }
    assert!((8.0 - tank.energy() - 0.02).abs() < 0.006, "{}", tank.energy());
}

#[test]
fn following_the_flow_costs_nothing() {
    let p = passive::<f64>(20.0, 60.0, 1.0);
    let mut tank = tank::<f64>(1.0, 2.0);
    let u = Vector3::new(0.3, -0.2, 0.1);
    for _ in 0..1_000_000 {
        let i = p.step(&mut tank, &u, &u, 0.001).unwrap();
        assert!(i.drive_scale == 1.0 && i.wrench.norm() < 1e-14);
    }
    assert!((tank.energy() - 1.0).abs() < 1e-9);
}

#[test]
fn a_full_tank_rejects_and_a_braking_drive_refills() {
    let p = passive::<f64>(20.0, 20.0, 1.0);
    let (v, still) = (Vector2::new(1.0, 0.0), Vector2::zeros());
    let mut full = tank::<f64>(1.0, 1.0);
    let i = p.step(&mut full, &v, &still, 0.001).unwrap();
    assert!((i.rejected - 0.02).abs() < 1e-9 && i.filled < 1e-9 && full.energy() == 1.0, "{i:?}");
    // Half of the damping's 0.02 J, and all of the 0.02 J the drive took.
    let p = passive::<f64>(20.0, 20.0, 0.5);
    let mut half = tank::<f64>(0.5, 1.0);
    let i = p.step(&mut half, &v, &-v, 0.001).unwrap();
    assert!(i.drive_scale == 1.0 && (half.energy() - 0.53).abs() < 1e-9, "{i:?}");
    assert!((i.wrench + v * 40.0).norm() < 1e-12);
}

#[test]
fn an_empty_tank_steers_and_does_not_push() {
    let p = passive::<f64>(20.0, 60.0, 1.0);
    let mut empty = tank::<f64>(0.0, 1.0);
    let u = Vector2::new(0.5, 0.0);
    let rest = p.step(&mut empty, &Vector2::zeros(), &u, 0.001).unwrap();
    assert!(rest.wrench == Vector2::zeros() && rest.drive_scale == 0.0);
    let v = Vector2::new(0.1, 0.1);
    let i = p.step(&mut empty, &v, &u, 0.001).unwrap();
    assert!(i.wrench[0] > 0.0 && i.wrench[1] < 0.0, "{i:?}");
    assert!(i.wrench.dot(&v) <= 0.0 && i.wrench.dot(&v) > -1e-9, "{i:?}");
    assert_eq!(empty.energy(), 0.0);
}

#[test]
fn a_pushed_mass_comes_back_to_the_flow() {
    // A limit cycle of radius 0.2 m: not conservative, so every turn would earn energy without a tank. 2 kg, pushed for
    // 0.3 s.
    let flow = |x: &Vector2<f64>| {
        let radial = (0.04 - x.norm_squared()) * 25.0;
        Vector2::new(radial * x[0] - 1.5 * x[1], radial * x[1] + 1.5 * x[0])
    };
    let (mass, dt, start) = (2.0, 0.001, 2.0);
    let p = passive::<f64>(20.0, 60.0, 1.0);
    let mut tank = tank::<f64>(start, 5.0);
    let (mut x, mut v) = (Vector2::new(0.1, 0.0), Vector2::zeros());
    let (mut pushed, mut held): (f64, f64) = (0.0, 0.0);
    for k in 0..20_000 {
        let push = if (4000..4300).contains(&k) { Vector2::new(-12.0, 9.0) } else { Vector2::zeros() };
        let i = p.step(&mut tank, &v, &flow(&x), dt).unwrap();
        let force = i.wrench + push;
        pushed += push.dot(&v) * dt;
        held += force.norm_squared() * dt * dt / (2.0 * mass);
        v += force * (dt / mass);
        x += v * dt;
        let stored = mass * v.norm_squared() / 2.0 + tank.energy();
        assert!(stored <= start + pushed + held + 1e-9, "step {k}: {stored} J of {pushed} J pushed in");
        if k == 4300 {
            assert!((v - flow(&x)).norm() > 0.2, "the push gave way to nothing");
        }
    }
    assert!((x.norm() - 0.2).abs() < 0.01 && (v - flow(&x)).norm() < 0.03, "{x} {v}");
}

#[test]
fn faults_are_named() {
    let spec = PassiveSpec::<f64>::default();
    let at_fault = |spec| Passive::new(spec).unwrap_err();
    for bad in [0.0, -1.0, 1e9, f64::NAN, f64::INFINITY] {
        assert_eq!(at_fault(PassiveSpec { lambda_along: bad, ..spec }), PassiveError::LambdaAlong);
        assert_eq!(at_fault(PassiveSpec { lambda_across: bad, ..spec }), PassiveError::LambdaAcross);
        assert_eq!(at_fault(PassiveSpec { blend: bad, ..spec }), PassiveError::Blend);
        assert_eq!(Tank::new(0.0, bad).unwrap_err(), PassiveError::Capacity);
    }
    for bad in [-0.1, 1.1, f64::NAN] {
        assert_eq!(at_fault(PassiveSpec { share: bad, ..spec }), PassiveError::Share);
        assert_eq!(Tank::new(bad, 1.0).unwrap_err(), PassiveError::Energy);
    }
    let p = Passive::new(spec).unwrap();
    let mut tank = tank(1.0, 1.0);
    let (good, bad) = (Vector2::new(0.1, 0.2), Vector2::new(0.1, f64::NAN));
    assert_eq!(p.step(&mut tank, &bad, &good, 0.001).unwrap_err(), PassiveError::RobotVelocity);
    assert_eq!(p.step(&mut tank, &good, &bad, 0.001).unwrap_err(), PassiveError::Wanted);
    assert_eq!(p.step(&mut tank, &good, &good, 0.0).unwrap_err(), PassiveError::TimeStep);
    assert_eq!(p.step(&mut tank, &(good * 1000.0), &good, 0.1).unwrap_err(), PassiveError::Work);
    assert_eq!(tank.energy(), 1.0);
}
