//! Fixed point for processors without a floating-point unit.

use super::lanes::{Each, LANES};
use super::{Scalar, integer, transcendental};
use core::fmt::{Debug, Display, Formatter, Result};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use fixed::types::I12F20;
use num_traits::{One, Zero};

/// Digits after the point.
const DIGITS: u32 = I12F20::FRAC_NBITS;
/// Half of the last digit, in units of a product.
const HALF: i64 = 1 << (DIGITS - 1);

/// A number of 32 bits with 20 of them after the point: from -2048 to 2048 in steps of 2^-20 = 9.5e-7.
///
/// Everything saturates: a result beyond the range is its end, x/0 is the end on the side of x, 0/0 = 0, the square root of a
/// negative number is zero, and not-a-number becomes zero. Nothing wraps and nothing panics.
///
/// | | error | instructions, Armv6-M |
/// |---|---|---|
/// | `+` `-` negation `abs` | none | 5 |
/// | `*` | half a step | 28 |
/// | `/` | half a step | 120 |
/// | `sqrt` | half a step | 95 |
/// | `dot`, `norm` of two | half a step | 70, 140 |
/// | `unit` of two or three | half a step and a fiftieth; of the length half a step and 1.5e-8 of it | 220, 260 |
/// | `exp` | one step, or 2.5e-7 of the result | 95 |
/// | `sin_cos` | 7e-7, and 4e-10 of the angle | 200 |
/// | `polar`, `atan2` | 1.5e-6; of the length half a step and 4e-8 of it, as it is turned in 29 digits | 185 |
/// | `from_f64` | half a step | none for a constant |
///
/// ```
/// use pliant_core::{Fixed, Scalar};
/// let third = Fixed::from_f64(1.0) / Fixed::from_f64(3.0);
/// assert_eq!(third.to_bits(), 349_525);
/// assert_eq!(Fixed::from_f64(1e9), Fixed::MAX);
/// assert_eq!(Fixed::MAX + third, Fixed::MAX);
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd)]
pub struct Fixed(I12F20);

impl Fixed {
    /// The number of `bits` steps of 2^-20.
    pub const fn from_bits(bits: i32) -> Self {
        Self(I12F20::from_bits(bits))
    }

    /// How many steps of 2^-20 it is.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    fn magnitude(self) -> u32 {
        self.to_bits().unsigned_abs()
    }
}

impl Debug for Fixed {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        Debug::fmt(&self.0, f)
    }
}

impl Display for Fixed {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        Display::fmt(&self.0, f)
    }
}

impl Add for Fixed {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Fixed {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Fixed {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl Mul for Fixed {
    type Output = Self;
    /// To the nearest step, ties upwards.
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::from_bits(integer::scaled::<DIGITS>(self.to_bits(), other.to_bits()))
    }
}

impl Div for Fixed {
    type Output = Self;
    /// To the nearest step, ties away from zero.
    fn div(self, other: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        let quotient = integer::quotient::<DIGITS>(self.magnitude(), other.magnitude());
        // 2^31 is the end of the range on both sides: as it stands below zero, one less above.
        if (self < Self::zero()) == (other < Self::zero()) {
            Self::from_bits(quotient.min(i32::MAX as u32) as i32)
        } else {
            Self::from_bits((quotient as i32).wrapping_neg())
        }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $operator:tt),+) => {
        $(impl $trait for Fixed {
            #[inline]
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        })+
    };
}
assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl Zero for Fixed {
    fn zero() -> Self {
        Self(I12F20::ZERO)
    }
    fn is_zero(&self) -> bool {
        self.to_bits() == 0
    }
}

impl One for Fixed {
    fn one() -> Self {
        Self(I12F20::ONE)
    }
}

impl Scalar for Fixed {
    type Lanes = Each<Self, LANES>;
    const EPSILON: Self = Self(I12F20::DELTA);
    const FLOATS: bool = false;
    const MAX: Self = Self(I12F20::MAX);
    const FAR: Self = Self::from_bits(1000 << DIGITS);
    /// 2 mm.
    const MIN_AXIS: Self = Self::from_bits(2097);

    #[inline]
    fn from_f64(x: f64) -> Self {
        // All of it folds at compile time, where x is a constant. Conversion to an integer saturates, and makes not-a-number zero.
        let steps = x * f64::from(1_u32 << DIGITS);
        let whole = steps as i32;
        let rest = steps - f64::from(whole);
        Self::from_bits(if rest >= 0.5 {
            whole.saturating_add(1)
        } else if rest <= -0.5 {
            whole.saturating_sub(1)
        } else {
            whole
        })
    }
    fn to_f64(self) -> f64 {
        f64::from(self.to_bits()) / f64::from(1_u32 << DIGITS)
    }
    fn is_finite(self) -> bool {
        true
    }
    #[inline]
    fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }
    fn sqrt(self) -> Self {
        let bits = u64::try_from(self.to_bits()).unwrap_or(0);
        Self::from_bits(integer::root(bits << DIGITS) as i32)
    }
    fn exp(self) -> Self {
        Self::from_bits(transcendental::exp(self.to_bits()))
    }
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = transcendental::sin_cos(self.to_bits());
        (Self::from_bits(sin), Self::from_bits(cos))
    }
    fn polar(x: Self, y: Self) -> (Self, Self) {
        let (length, angle) = transcendental::polar(x.to_bits(), y.to_bits());
        (Self::from_bits(length), Self::from_bits(angle))
    }
    fn atan2(self, x: Self) -> Self {
        Self::polar(x, self).1
    }
    fn rounding(size: Self) -> Self {
        // A step for the product itself, and one for each whole unit of a term that is itself wrong by a step; rounded up.
        let whole = size.abs().to_bits().saturating_add((1 << DIGITS) - 1) >> DIGITS;
        Self::from_bits(whole + 1)
    }
    fn norm(components: &[Self]) -> Self {
        // The sum of four may be 2^64.
        let squares = components.iter().map(|x| integer::square(x.to_bits()));
        let square = if components.len() <= 3 {
            squares.fold(0, u64::wrapping_add)
        } else {
            squares.fold(0, u64::saturating_add)
        };
        Self::from_bits(integer::root(square) as i32)
    }
    fn other_leg(hypotenuse: Self, leg: Self) -> Self {
        let square = integer::product((hypotenuse - leg).to_bits(), (hypotenuse + leg).to_bits());
        Self::from_bits(integer::root(u64::try_from(square).unwrap_or(0)) as i32)
    }
    fn unit<const D: usize>(v: [Self; D]) -> (Self, [Self; D]) {
        const { assert!(D <= 3, "the square of four may be 2^64") };
        let (length, unit) = integer::unit(v.map(Self::to_bits));
        (Self::from_bits(length as i32), unit.map(|x| Self::from_bits(integer::rounded(x, 29 - DIGITS))))
    }
    #[inline]
    fn dot(a: &[Self], b: &[Self]) -> Self {
        if let ([a, c], [b, d]) = (a, b) {
            let [a, b, c, d] = [a, b, c, d].map(|x| x.to_bits());
            return Self::from_bits(integer::scaled_pair::<DIGITS>(a, b, c, d));
        }
        let products = || a.iter().zip(b).map(|(a, b)| integer::product(a.to_bits(), b.to_bits()));
        // A product is at most 2^62. The sum of three may leave 64 bits, but not come back to where a result fits.
        if a.len() <= 3
            && let Some(sum) = integer::narrowed::<DIGITS>(products().fold(HALF, i64::wrapping_add))
        {
            return Self::from_bits(sum);
        }
        // More of them may depend on their order, out of range.
        let sum = products().fold(HALF, i64::saturating_add);
        Self::from_bits(integer::narrowed::<DIGITS>(sum).unwrap_or_else(|| integer::end((sum >> 32) as i32)))
    }
}
