//! Whole numbers times powers of two: what every scalar of a device is, and what sums and products of them are, exactly.

use num_bigint::{BigInt, Sign};
use std::ops::{Add, Mul, Neg, Sub};

/// digits 2^exponent
#[derive(Debug, Clone)]
pub struct Dyadic {
    digits: BigInt,
    exponent: i32,
}

impl Dyadic {
    /// The number that an f64 is; `None` where it is infinite or not a number.
    pub fn new(x: f64) -> Option<Self> {
        const MANTISSA: u32 = f64::MANTISSA_DIGITS - 1;
        if !x.is_finite() {
            return None;
        }
        let bits = x.to_bits();
        let fraction = (bits & ((1 << MANTISSA) - 1)) as i64;
        let biased = (bits >> MANTISSA & 0x7ff) as i32;
        // Below the least normal number there is no leading one.
        let (digits, biased) = if biased == 0 { (fraction, 1) } else { (fraction | 1 << MANTISSA, biased) };
        let digits = BigInt::from(if x.is_sign_negative() { -digits } else { digits });
        Some(Self { digits, exponent: biased - 1075 })
    }

    /// Zero.
    pub fn zero() -> Self {
        Self { digits: BigInt::ZERO, exponent: 0 }
    }

    /// Greater than zero?
    pub fn is_positive(&self) -> bool {
        self.digits.sign() == Sign::Plus
    }

    /// Zero?
    pub fn is_zero(&self) -> bool {
        self.digits.sign() == Sign::NoSign
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: Self) -> Dyadic {
        let (low, high) = if self.exponent <= other.exponent { (self, other) } else { (other, self) };
        let digits = &low.digits + (&high.digits << high.exponent.abs_diff(low.exponent));
        Dyadic { digits, exponent: low.exponent }
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;
    fn neg(self) -> Dyadic {
        Dyadic { digits: -&self.digits, exponent: self.exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: Self) -> Dyadic {
        self + &-other
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Self) -> Dyadic {
        Dyadic { digits: &self.digits * &other.digits, exponent: self.exponent + other.exponent }
    }
}
