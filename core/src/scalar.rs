//! The numbers the method computes with.
//!
//! Every function that is not plain arithmetic goes through `libm`, never through the platform's math library:
//! then a PC and a microcontroller compute the same bits from the same inputs.

use core::fmt::{Debug, Display};
use core::ops::Neg;
use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

/// A number type the method can run on: `f32` or `f64`.
///
/// Small on purpose: only the operations the method needs, so that a fixed-point type can offer them too.
///
/// ```
/// use pliant_core::Scalar;
/// assert_eq!(<f32 as Scalar>::from_f64(2.0).sqrt(), libm::sqrtf(2.0));
/// ```
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + Debug
    + Display
    + PartialOrd
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// Distance from one to the next larger number.
    const EPSILON: Self;
    /// Largest finite number.
    const MAX: Self;
    /// The nearest number of this type.
    fn from_f64(x: f64) -> Self;
    /// The same number as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// Neither infinite nor not-a-number.
    fn is_finite(self) -> bool;
    /// |x|
    fn abs(self) -> Self;
    /// Square root; not-a-number below zero.
    fn sqrt(self) -> Self;
    /// e^x
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine, x in rad.
    fn sin(self) -> Self;
    /// Cosine, x in rad.
    fn cos(self) -> Self;
    /// Angle of the point (x, self), in rad, from -pi to pi.
    fn atan2(self, x: Self) -> Self;

    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// x^n for a whole n >= 0, by repeated multiplication.
    fn powi(self, n: u8) -> Self {
        (0..n).fold(Self::one(), |y, _| y * self)
    }
}

macro_rules! scalar {
    ($float:ty, $atan2:path, $($method:ident = $function:path),+) => {
        impl Scalar for $float {
            const EPSILON: Self = <$float>::EPSILON;
            const MAX: Self = <$float>::MAX;
            fn from_f64(x: f64) -> Self {
                x as $float
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            $(fn $method(self) -> Self {
                $function(self)
            })+
        }
    };
}
#[rustfmt::skip]
scalar!(f32, libm::atan2f, abs = libm::fabsf, sqrt = libm::sqrtf, exp = libm::expf, ln = libm::logf, sin = libm::sinf, cos = libm::cosf);
#[rustfmt::skip]
scalar!(f64, libm::atan2, abs = libm::fabs, sqrt = libm::sqrt, exp = libm::exp, ln = libm::log, sin = libm::sin, cos = libm::cos);
