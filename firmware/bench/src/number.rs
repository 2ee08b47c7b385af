//! The number types, as far as they differ for a measurement.

use pliant_core::Scalar;
use pliant_core::scalar::Fixed;

/// How many [`Number::units`] one is.
pub const ONE: i32 = 1 << 14;

/// A number type that can be made from an integer exactly, and looked at bit by bit.
pub trait Number: Scalar {
    /// What reports call it.
    const NAME: &str;

    /// `n` units of 2^-14: exact up to 1024, and without soft-float f64 on a board.
    fn units(n: i32) -> Self;
    /// Its bits.
    fn bits(self) -> u64;
}

impl Number for f32 {
    const NAME: &str = "f32";
    fn units(n: i32) -> Self {
        n as f32 * (1.0 / ONE as f32)
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

impl Number for f64 {
    const NAME: &str = "f64";
    fn units(n: i32) -> Self {
        f64::from(n) * (1.0 / f64::from(ONE))
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

impl Number for Fixed {
    const NAME: &str = "fixed";
    fn units(n: i32) -> Self {
        Self::from_bits(n.saturating_mul(1 << 6))
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits() as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_exact() {
        for n in [0, 1, -1, ONE, 12_345, -(ONE * 900) + 1] {
            let exact = f64::from(n) / f64::from(ONE);
            assert_eq!(f64::from(f32::units(n)), exact);
            assert_eq!(f64::units(n), exact);
            assert_eq!(Fixed::units(n).to_f64(), exact);
        }
    }
}
