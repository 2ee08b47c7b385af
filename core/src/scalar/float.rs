//! `f32` and `f64`.

use super::Scalar;
use super::angle::{ArcTangent, SineCosine, polynomial};
use super::lanes::{Lanes32, Lanes64};
use core::f32::consts as single;
use core::f64::consts as double;

/// The polynomial's own error is 8e-9 of a radian.
pub(super) const ATAN_F32: ArcTangent<f32, 4> = ArcTangent {
    bound: 0.414_213_57,
    eighth: single::FRAC_PI_4,
    quarter: single::FRAC_PI_2,
    three_eighths: 3.0 * single::FRAC_PI_4,
    half: single::PI,
    lacking: -8.742_278e-8 / single::PI,
    series: [-0.333_329_56, 0.199_779_2, -0.138_797_79, 0.080_600_63],
};

/// The polynomial's own error is 6e-19 of a radian.
pub(super) const ATAN_F64: ArcTangent<f64, 11> = ArcTangent {
    bound: 0.414_213_562_373_095_03,
    eighth: double::FRAC_PI_4,
    quarter: double::FRAC_PI_2,
    three_eighths: 3.0 * double::FRAC_PI_4,
    half: double::PI,
    lacking: 1.224_646_799_147_353_2e-16 / double::PI,
    series: [
        -0.333_333_333_333_332,
        0.199_999_999_999_540_4,
        -0.142_857_142_802_440_25,
        0.111_111_107_859_036_48,
        -0.090_908_978_294_620_51,
        0.076_920_615_087_787_28,
        -0.066_631_188_828_936_48,
        0.058_479_977_106_940_806,
        -0.050_397_938_284_177_025,
        0.038_076_979_417_507_56,
        -0.017_920_780_782_812_94,
    ],
};

/// The polynomials' own errors are 4e-9 of the sine and 1e-10 of the cosine.
const CIRCLE_F32: SineCosine<f32, 3> = SineCosine {
    eighth: single::FRAC_PI_4,
    quarter: (single::FRAC_PI_2, -4.371_139e-8),
    half: (single::PI, -8.742_278e-8),
    sine: [-0.166_666_55, 0.008_332_178, -0.000_195_172_66],
    cosine: [0.041_666_646, -0.001_388_736_8, 2.443_841_5e-5],
};

/// The polynomials' own errors are 3e-18 of the sine and 5e-20 of the cosine.
const CIRCLE_F64: SineCosine<f64, 6> = SineCosine {
    eighth: double::FRAC_PI_4,
    quarter: (double::FRAC_PI_2, 6.123_233_995_736_766e-17),
    half: (double::PI, 1.224_646_799_147_353_2e-16),
    sine: [
        -0.166_666_666_666_666_32,
        0.008_333_333_333_322_418,
        -0.000_198_412_698_298_123_8,
        2.755_731_369_357_205e-6,
        -2.505_075_838_421_045_5e-8,
        1.589_681_178_647_399e-10,
    ],
    cosine: [
        0.041_666_666_666_666_6,
        -0.001_388_888_888_887_413_1,
        2.480_158_728_948_703_6e-5,
        -2.755_731_435_379_461e-7,
        2.087_572_347_968_585_4e-9,
        -1.135_965_887_347_340_2e-11,
    ],
};

/// `libm` has the instruction where there is vector arithmetic.
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
use libm::sqrtf;
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
use pliant_fpu::sqrt as sqrtf;

/// e^x, within 1e-7 of it, in half the steps of `libm`'s, which still answers where the result is next to nothing, or too much.
#[inline(always)]
fn exp(x: f32) -> f32 {
    /// A number plus this is rounded to a whole one, which is then in its last binary digits.
    const WHOLE: f32 = 12_582_912.0;
    /// ln 2 as a number with few digits, whose multiples are exact, and the rest.
    const LN_2: (f32, f32) = (0.693_359_4, -2.121_944_4e-4);
    /// e^r = 1 + r + r^2 (c_0 + c_1 r + ...), |r| <= ln(2)/2. The polynomial's own error is 3e-9.
    const SERIES: [f32; 5] = [0.499_999_93, 0.166_665_2, 0.041_668_394, 0.008_368_78, 0.001_381_446_7];
    if !(libm::fabsf(x) <= 87.0) {
        return libm::expf(x);
    }
    let power = x * single::LOG2_E + WHOLE;
    let whole = power - WHOLE;
    let r = (x - whole * LN_2.0) - whole * LN_2.1;
    let mantissa = 1.0 + (r + r * r * polynomial(&SERIES, r));
    f32::from_bits(mantissa.to_bits().wrapping_add(power.to_bits() << 23))
}

macro_rules! scalar {
    ($float:ty, $lanes:ty, $angle:ident, $circle:ident, $($method:ident = $function:path),+) => {
        impl Scalar for $float {
            type Lanes = $lanes;
            const EPSILON: Self = <$float>::EPSILON;
            const FLOATS: bool = true;
            const MAX: Self = <$float>::MAX;
            const FAR: Self = 1e15;
            const MIN_AXIS: Self = 1e-4;

            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $circle.at(self).unwrap_or_else(|| (Scalar::sin(self), Scalar::cos(self)))
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $angle.angle(self, x)
            }
            #[inline(always)]
            fn polar(x: Self, y: Self) -> (Self, Self) {
                $angle.polar(y, x, Scalar::sqrt)
            }
            #[inline(always)]
            fn rounding(size: Self) -> Self {
                <$float>::EPSILON * size
            }
            #[inline(always)]
            fn norm(components: &[Self]) -> Self {
                Scalar::sqrt(<Self as Scalar>::dot(components, components))
            }
            #[inline(always)]
            fn other_leg(hypotenuse: Self, leg: Self) -> Self {
                Scalar::sqrt(Scalar::max((hypotenuse - leg) * (hypotenuse + leg), 0.0))
            }
            #[inline(always)]
            fn dot(a: &[Self], b: &[Self]) -> Self {
                // From the first product on, not from zero: as nalgebra sums.
                a.iter().zip(b).map(|(a, b)| a * b).reduce(|sum, product| sum + product).unwrap_or(0.0)
            }
            $(#[inline(always)]
            fn $method(self) -> Self {
                $function(self)
            })+
        }
    };
}
#[rustfmt::skip]
scalar!(f32, Lanes32, ATAN_F32, CIRCLE_F32, abs = libm::fabsf, sqrt = sqrtf, exp = exp, sin = libm::sinf, cos = libm::cosf);
#[rustfmt::skip]
scalar!(f64, Lanes64, ATAN_F64, CIRCLE_F64, abs = libm::fabs, sqrt = libm::sqrt, exp = libm::exp, sin = libm::sin, cos = libm::cos);

#[cfg(test)]
mod tests {
    #[test]
    fn exponential_within_its_error_and_the_range() {
        for i in -1_100_000..=1_100_000 {
            let x = i as f32 * 1e-4;
            let exact = libm::exp(f64::from(x));
            let found = f64::from(super::exp(x));
            if exact > f64::from(f32::MAX) {
                assert_eq!(found, f64::INFINITY);
            } else {
                assert!((found - exact).abs() <= 1e-7 * exact + 1e-45, "{x}: {found} {exact}");
            }
        }
        assert_eq!([super::exp(0.0), super::exp(f32::NEG_INFINITY)], [1.0, 0.0]);
        assert!(super::exp(f32::NAN).is_nan());
    }
}
