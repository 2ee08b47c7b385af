//! Angles in floating point against `libm`: every quadrant, every axis, and the ends of the range.

use pliant_core::Scalar;

const TURN: f64 = 2.0 * core::f64::consts::PI;
const COUNT: i32 = 1_000_000;

/// Angles all round in equal steps.
fn all_round() -> impl Iterator<Item = f64> {
    (-COUNT..=COUNT).map(|i| f64::from(i) / f64::from(COUNT) * 0.5 * TURN)
}

/// Points all round, at many distances.
fn points() -> impl Iterator<Item = (f64, f64)> {
    all_round().enumerate().map(|(i, angle)| {
        let distance = libm::exp2((i % 41) as f64 - 20.0);
        (distance * libm::sin(angle), distance * libm::cos(angle))
    })
}

#[test]
fn the_angle_of_a_point() {
    let (mut double, mut single) = (0.0_f64, 0.0_f64);
    for (y, x) in points() {
        double = double.max((Scalar::atan2(y, x) - libm::atan2(y, x)).abs());
        let (y, x) = (y as f32, x as f32);
        let exact = libm::atan2(f64::from(y), f64::from(x));
        single = single.max((f64::from(Scalar::atan2(y, x)) - exact).abs());
    }
    println!("atan2: f64 {double:e}, f32 {single:e}");
    assert!(double <= 9e-16 && single <= 2e-7);
}

#[test]
fn a_small_angle_keeps_its_digits() {
    for exponent in -300..0 {
        let y = 1.234_567 * libm::pow(10.0, f64::from(exponent));
        let error = Scalar::atan2(y, 1.0) / libm::atan2(y, 1.0) - 1.0;
        assert!(error.abs() <= 4e-16, "{y}: {error:e}");
        if exponent > -38 {
            let error = f64::from(Scalar::atan2(y as f32, 1.0_f32)) / libm::atan2(f64::from(y as f32), 1.0) - 1.0;
            assert!(error.abs() <= 2e-7, "{y}: {error:e}");
        }
    }
}

macro_rules! axes_and_ends {
    ($name:ident, $float:ident, $bound:literal) => {
        #[test]
        fn $name() {
            use core::$float::consts::*;
            let at = |y: $float, x: $float| Scalar::atan2(y, x);
            for r in [1.0, $float::MAX, $float::MIN_POSITIVE, $float::from_bits(1), 0.3] {
                assert_eq!(at(0.0, r), 0.0);
                assert_eq!(at(0.0, -r), PI);
                assert_eq!(at(r, 0.0), FRAC_PI_2);
                assert_eq!(at(-r, 0.0), -FRAC_PI_2);
                assert_eq!(at(r, r), FRAC_PI_4);
                assert_eq!(at(-r, r), -FRAC_PI_4);
                assert_eq!(at(r, -r), 3.0 * FRAC_PI_4);
                assert_eq!(at(-r, -r), -3.0 * FRAC_PI_4);
            }
            assert_eq!(at(0.0, 0.0), 0.0);
            assert_eq!(at(-0.0, -0.0), 0.0);
            assert!(at($float::NAN, 1.0).is_nan() && at(1.0, $float::NAN).is_nan() && at($float::NAN, 0.0).is_nan());
            let sizes = [
                0.0,
                $float::from_bits(1),
                $float::from_bits(7),
                $float::MIN_POSITIVE,
                $float::EPSILON,
                0.7,
                1.0,
                1e30,
                $float::MAX / 2.0,
                $float::MAX,
            ];
            for y in sizes.into_iter().flat_map(|y| [y, -y]) {
                for x in sizes.into_iter().flat_map(|x| [x, -x]) {
                    // Adding zero makes nothing of the sign of a zero, as ours does.
                    let exact = libm::atan2(f64::from(y) + 0.0, f64::from(x) + 0.0);
                    let angle = at(y, x);
                    assert!((f64::from(angle) - exact).abs() <= $bound, "{y} {x}: {angle} {exact}");
                    assert!(y == 0.0 || angle == 0.0 || (y > 0.0) == (angle > 0.0), "{y} {x}: {angle}");
                }
            }
        }
    };
}
axes_and_ends!(axes_and_ends_in_single_precision, f32, 2e-7);
axes_and_ends!(axes_and_ends_in_double_precision, f64, 9e-16);

#[test]
fn sine_and_cosine_from_one_reduction() {
    let (mut double, mut single) = (0.0_f64, 0.0_f64);
    let quarters = (-4..=4).flat_map(|n| (-50..=50).map(move |d| f64::from(n) * TURN / 8.0 + f64::from(d) * 1e-9));
    let beyond = [4.0, -5.0, 100.0, 1e6];
    for x in all_round().chain(quarters).chain(beyond) {
        let (sin, cos) = Scalar::sin_cos(x);
        double = double.max((sin - libm::sin(x)).abs()).max((cos - libm::cos(x)).abs());
        let x = x as f32;
        let (sin, cos) = Scalar::sin_cos(x);
        let exact = f64::from(x);
        single = single.max((f64::from(sin) - libm::sin(exact)).abs()).max((f64::from(cos) - libm::cos(exact)).abs());
    }
    println!("sin_cos: f64 {double:e}, f32 {single:e}");
    assert!(double <= 3e-16 && single <= 1.2e-7);
    assert_eq!(Scalar::sin_cos(0.0_f64), (0.0, 1.0));
    assert_eq!(Scalar::sin_cos(0.0_f32), (0.0, 1.0));
    let (sin, cos) = Scalar::sin_cos(f64::NAN);
    assert!(sin.is_nan() && cos.is_nan());
}

#[test]
fn lengths_and_dot_products_are_as_nalgebra_sums_them() {
    let v = nalgebra::Vector3::new(0.1_f64, -0.7, 1e-3);
    let w = nalgebra::Vector3::new(3.3, 0.2, -1e3);
    assert_eq!(<f64 as Scalar>::dot(v.as_slice(), w.as_slice()), v.dot(&w));
    assert_eq!(<f64 as Scalar>::norm(v.as_slice()), libm::sqrt(v.dot(&v)));
    assert_eq!(<f32 as Scalar>::norm(&[3.0, 4.0]), 5.0);
    assert_eq!(<f64 as Scalar>::norm(&[]), 0.0);
    assert_eq!(<f32 as Scalar>::rounding(2.0), 2.0 * f32::EPSILON);
}
