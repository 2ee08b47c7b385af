//! Fixed point against exact integers and `f64`: on corners, at random and in sweeps. Run with overflow checks: nothing may panic.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use num_traits::Zero;
use pliant_core::{Fixed, Matrix, Scalar, Vector};

const ONE: i32 = 1 << 20;
const STEP: f64 = 1.0 / ONE as f64;

/// Numbers that repeat, by Knuth's generator.
struct Random(u64);
impl Random {
    fn next(&mut self) -> i32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as i32
    }
    /// Of any order of magnitude.
    fn any(&mut self) -> i32 {
        let shift = self.next() & 31;
        self.next() >> shift
    }
}

fn corners() -> Vec<i32> {
    let powers = (0..32).flat_map(|n| {
        let power = (1_i64 << n) as i32;
        [
            power,
            power.wrapping_sub(1),
            power.wrapping_add(1),
            power.wrapping_neg(),
            power.wrapping_neg().wrapping_sub(1),
        ]
    });
    powers.chain([0, 3_294_199, -3_294_199, 1_647_099, 349_525, 1000 * ONE]).collect()
}

fn pairs() -> impl Iterator<Item = (i32, i32)> {
    let corners = corners();
    let mut random = Random(1);
    let mut more = Random(2);
    corners
        .clone()
        .into_iter()
        .flat_map(move |a| corners.clone().into_iter().map(move |b| (a, b)))
        .chain((0..1_000_000).map(move |_| (random.next(), random.next())))
        .chain((0..2_000_000).map(move |_| (more.any(), more.any())))
}

fn bits(x: i32) -> Fixed {
    Fixed::from_bits(x)
}

fn saturated(x: i128) -> i32 {
    x.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

#[test]
fn arithmetic_is_exact_then_rounded_then_saturated() {
    for (a, b) in pairs() {
        let (x, y) = (i128::from(a), i128::from(b));
        assert_eq!((bits(a) + bits(b)).to_bits(), saturated(x + y), "{a} + {b}");
        assert_eq!((bits(a) - bits(b)).to_bits(), saturated(x - y), "{a} - {b}");
        assert_eq!((bits(a) * bits(b)).to_bits(), saturated((x * y + (1 << 19)) >> 20), "{a} * {b}");
        let quotient = match (x << 20, y) {
            (0, 0) => 0,
            (n, 0) => n.signum() << 40,
            // Away from zero at ties: |n/d| + 1/2 rounded down.
            (n, d) => (2 * n.abs() + d.abs()) / (2 * d.abs()) * n.signum() * d.signum(),
        };
        assert_eq!((bits(a) / bits(b)).to_bits(), saturated(quotient), "{a} / {b}");
        assert_eq!((-bits(a)).to_bits(), saturated(-x));
        assert_eq!(Scalar::abs(bits(a)).to_bits(), saturated(x.abs()));
        assert_eq!(bits(a) < bits(b), a < b);
        let (mut sum, mut difference, mut product, mut ratio) = (bits(a), bits(a), bits(a), bits(a));
        sum += bits(b);
        difference -= bits(b);
        product *= bits(b);
        ratio /= bits(b);
        assert_eq!(sum, bits(a) + bits(b));
        assert_eq!(difference, bits(a) - bits(b));
        assert_eq!(product, bits(a) * bits(b));
        assert_eq!(ratio, bits(a) / bits(b));
    }
}

#[test]
fn conversion_goes_to_the_nearest() {
    let mut random = Random(3);
    for _ in 0..1_000_000 {
        let a = random.any();
        let (x, part) = (f64::from(a) * STEP, f64::from(random.next() & 0xffff) / 65536.0);
        assert_eq!(bits(a).to_f64(), x);
        assert_eq!(Fixed::from_f64(x).to_bits(), a);
        let near = Fixed::from_f64((f64::from(a) + part) * STEP).to_f64();
        assert!((near - (f64::from(a) + part) * STEP).abs() <= STEP / 2.0 || a == i32::MAX);
    }
    let cases = [
        (f64::NAN, 0),
        (f64::INFINITY, i32::MAX),
        (f64::NEG_INFINITY, i32::MIN),
        (2048.0, i32::MAX),
        (2048.0 - 0.4 * STEP, i32::MAX),
        (-2048.0, i32::MIN),
        (-2048.0 - 0.6 * STEP, i32::MIN),
        (0.5 * STEP, 1),
        (-0.5 * STEP, -1),
        (0.499_999_999_999_999_94 * STEP, 0),
        (-0.0, 0),
        (f64::MIN_POSITIVE, 0),
    ];
    for (x, expected) in cases {
        assert_eq!(Fixed::from_f64(x).to_bits(), expected, "{x}");
    }
    assert_eq!(format!("{} {:?}", Fixed::from_f64(-1.5), Fixed::from_f64(0.25)), "-1.5 0.25");
    assert!(Fixed::default().is_zero());
}

#[test]
fn square_roots_are_the_nearest_and_rise() {
    let mut last = 0;
    let check = |a: i32| {
        let root = bits(a).sqrt().to_bits();
        let exact = (f64::from(a.max(0)) * f64::from(ONE)).sqrt();
        assert!((f64::from(root) - exact).abs() <= 0.5, "{a}: {root} {exact}");
        root
    };
    for a in (0..300_000).chain((300_000..i32::MAX).step_by(701)) {
        let root = check(a);
        assert!(root >= last);
        last = root;
    }
    for a in corners() {
        check(a);
    }
}

#[test]
fn legs_of_triangles_are_the_nearest_whatever_their_size() {
    for (a, b) in pairs() {
        let (hypotenuse, leg) = (i64::from(a).abs() / 2, i64::from(b).abs() / 2);
        let found = Fixed::other_leg(bits(hypotenuse as i32), bits(leg as i32)).to_bits() as i64;
        let square = (hypotenuse * hypotenuse - leg * leg).max(0) as i128 * 4;
        let (low, high) = ((2 * found - 1).max(0) as i128, (2 * found + 1) as i128);
        assert!(low * low <= square && square <= high * high, "{hypotenuse} {leg}: {found}");
    }
}

#[test]
fn lengths_are_the_nearest_whatever_their_size() {
    for (a, b) in pairs() {
        for c in [0, a ^ b] {
            let components = [bits(a), bits(b), bits(c)];
            let square: u128 = [a, b, c].iter().map(|x| u128::from(x.unsigned_abs()).pow(2)).sum();
            let length = Scalar::norm(&components).to_bits() as u128;
            if square >= (1 << 62) - (1 << 31) {
                assert_eq!(length, i32::MAX as u128);
            } else {
                assert!(4 * square < (2 * length + 1).pow(2), "{a} {b} {c}");
                assert!(length == 0 || 4 * square > (2 * length - 1).pow(2), "{a} {b} {c}");
            }
            if c == 0 {
                assert_eq!(Scalar::norm(&components[..2]), Scalar::norm(&components));
            }
        }
    }
    let whole = [bits(i32::MIN); 16];
    assert_eq!(Fixed::norm(&whole), Fixed::MAX);
    assert_eq!(Fixed::norm(&[]), Fixed::zero());
}

#[test]
fn a_dot_product_rounds_once() {
    let mut random = Random(5);
    for (a, b) in pairs() {
        let (c, d) = (random.any(), random.any());
        let exact = i128::from(a) * i128::from(b) + i128::from(c) * i128::from(d) + i128::from(b) * i128::from(c);
        let dot = Fixed::dot(&[bits(a), bits(c), bits(b)], &[bits(b), bits(d), bits(c)]);
        assert_eq!(dot.to_bits(), saturated((exact + (1 << 19)) >> 20), "{a} {b} {c} {d}");
    }
    let least = [bits(i32::MIN); 3];
    assert_eq!(Fixed::dot(&least, &least), Fixed::MAX);
    assert_eq!(Fixed::dot(&least, &[bits(i32::MAX); 3]), bits(i32::MIN));
    assert_eq!(Fixed::dot(&[], &[]), Fixed::zero());
}

#[test]
fn the_exponential_is_right_to_a_step_and_rises() {
    let (mut last, mut worst_step, mut worst_relative) = (0, 0.0_f64, 0.0_f64);
    for a in (-20 * ONE..9 * ONE).step_by(7).chain([i32::MAX]) {
        let y = bits(a).exp();
        assert!(y.to_bits() >= last, "{a}");
        last = y.to_bits();
        let exact = (f64::from(a) * STEP).exp();
        if exact >= 2048.0 - STEP {
            assert!(y >= Fixed::from_f64(2047.99), "{a}: {y}");
        } else if exact < 4.0 {
            worst_step = worst_step.max((y.to_f64() - exact).abs() / STEP);
        } else {
            worst_relative = worst_relative.max((y.to_f64() / exact - 1.0).abs());
        }
    }
    println!("exp: {worst_step} steps below 4, {worst_relative} of the result above");
    assert!(worst_step <= 1.0 && worst_relative <= 2.5e-7);
    assert_eq!(Fixed::zero().exp().to_bits(), ONE);
    assert_eq!(bits(i32::MIN).exp(), Fixed::zero());
    for a in corners() {
        bits(a).exp();
    }
}

#[test]
fn sine_and_cosine_to_a_millionth() {
    let (mut worst, mut worst_far) = (0.0_f64, 0.0_f64);
    let near = (-8 * ONE..8 * ONE).step_by(5);
    let far = (i32::MIN..=i32::MAX).step_by(997).chain(corners());
    for a in near.chain(far) {
        let (sin, cos) = bits(a).sin_cos();
        let x = f64::from(a) * STEP;
        let error = (sin.to_f64() - x.sin()).abs().max((cos.to_f64() - x.cos()).abs());
        if x.abs() < 8.0 {
            worst = worst.max(error);
        } else {
            worst_far = worst_far.max(error - 4e-10 * x.abs());
        }
        assert_eq!((bits(a).sin(), bits(a).cos()), (sin, cos));
    }
    println!("sin, cos: {worst} up to 8, {worst_far} + 4e-10 |x| beyond");
    assert!(worst <= 7e-7 && worst_far <= 7e-7);
    assert_eq!((Fixed::zero().sin().to_bits(), Fixed::zero().cos().to_bits()), (0, ONE));
}

#[test]
fn angles_of_points_of_every_size() {
    let mut worst = 0.0_f64;
    let small = (-30..=30).flat_map(|a| (-30..=30).map(move |b| (a, b)));
    for (a, b) in pairs().chain(small) {
        let angle = bits(a).atan2(bits(b)).to_f64();
        worst = worst.max((angle - f64::from(a).atan2(f64::from(b))).abs());
        assert!(a == 0 || angle == 0.0 || (a > 0) == (angle > 0.0), "{a} {b}: {angle}");
    }
    println!("atan2: {worst}");
    assert!(worst <= 1.5e-6);
    let at = |y: f64, x: f64| Fixed::from_f64(y).atan2(Fixed::from_f64(x));
    let pi = core::f64::consts::PI;
    assert_eq!(at(0.0, 0.0), Fixed::zero());
    assert_eq!(at(0.0, 1.0), Fixed::zero());
    assert_eq!(at(0.0, -1.0), Fixed::from_f64(pi));
    assert_eq!(at(1.0, 0.0), Fixed::from_f64(pi / 2.0));
    assert_eq!(at(-1.0, 0.0), Fixed::from_f64(-pi / 2.0));
    assert_eq!(at(1.0, 1.0), Fixed::from_f64(pi / 4.0));
    assert_eq!(at(-1.0, -1.0), Fixed::from_f64(-0.75 * pi));
}

#[test]
fn a_product_is_within_its_rounding_bound() {
    // The terms are wrong by half a step each, as measured values are.
    let mut random = Random(7);
    for _ in 0..100_000 {
        let exact = [random.next(), random.next()].map(|x| f64::from(x) / f64::from(1 << 27));
        let [a, b] = exact.map(Fixed::from_f64);
        let size = a.abs().max(b.abs());
        let error = ((a * b).to_f64() - exact[0] * exact[1]).abs();
        assert!(error <= Fixed::rounding(size).to_f64(), "{a} {b}");
    }
    assert_eq!(Fixed::rounding(Fixed::zero()), Fixed::EPSILON);
    assert_eq!(Fixed::rounding(Fixed::MAX).to_bits(), 2048);
}

#[test]
fn vectors_and_matrices_work() {
    let number = |x: f64| Fixed::from_f64(x);
    let m = Matrix::<Fixed, 3>::from_fn(|i, j| number(i as f64 - 0.5 * j as f64));
    let v = Vector::<Fixed, 3>::from_fn(|i, _| number(0.25 * (i as f64 + 1.0)));
    let reference = m.map(|x| x.to_f64());
    let value = v.map(|x| x.to_f64());
    assert_eq!((m * v).map(|x| x.to_f64()), reference * value);
    assert_eq!(m.tr_mul(&v).map(|x| x.to_f64()), reference.tr_mul(&value));
    assert_eq!((m * m).map(|x| x.to_f64()), reference * reference);
    assert_eq!(
        (m + Matrix::<Fixed, 3>::identity() - m.transpose()).map(|x| x.to_f64()),
        reference + Matrix::<f64, 3>::identity() - reference.transpose()
    );
    assert_eq!(v.dot(&v).to_f64(), value.dot(&value));
    assert_eq!(Fixed::dot(v.as_slice(), v.as_slice()), v.dot(&v));
    assert_eq!((v * number(2.0) / number(4.0)).map(|x| x.to_f64()), value / 2.0);
    assert_eq!(-v + v, Vector::<Fixed, 3>::zeros());
    assert_eq!(v.component_mul(&v)[1], number(0.25));
    assert_eq!(number(1.5).powi(3), number(3.375));
    assert_eq!(number(2.0).min(number(-1.0)).max(number(0.0)), Fixed::zero());
}

#[test]
fn unit_vectors_and_polar_coordinates_of_points_of_every_size() {
    let (mut worst, mut worst_polar) = (0.0_f64, 0.0_f64);
    let small = (-30..=30).flat_map(|a| (-30..=30).map(move |b| (a, b)));
    for (a, b) in pairs().chain(small) {
        for c in [0, a ^ b] {
            let exact = [a, b, c].map(f64::from);
            let length = exact.iter().map(|x| x * x).sum::<f64>().sqrt();
            let (found, unit) = Fixed::unit([bits(a), bits(b), bits(c)]);
            let capped = length.min(f64::from(i32::MAX));
            assert!(
                (f64::from(found.to_bits()) - capped).abs() <= 0.5 + 1.5e-8 * length,
                "{a} {b} {c}: {found} {length}"
            );
            if length == 0.0 {
                assert_eq!(unit, [Fixed::zero(); 3]);
                continue;
            }
            for (x, exact) in unit.iter().zip(exact) {
                worst = worst.max((x.to_f64() - exact / length).abs());
            }
            if c == 0 {
                let (found, angle) = Fixed::polar(bits(a), bits(b));
                assert_eq!(angle, bits(b).atan2(bits(a)));
                worst_polar = worst_polar.max((f64::from(found.to_bits()) - capped).abs() - 4e-8 * length);
            }
        }
    }
    println!("unit: {} steps; polar: {worst_polar} steps and 4e-8 of the length", worst / STEP);
    assert!(worst <= 0.52 * STEP && worst_polar <= 0.5);
}
