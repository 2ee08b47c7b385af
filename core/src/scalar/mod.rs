//! The numbers the method computes with.
//!
//! Every function that is not plain arithmetic is this crate's own or goes through `libm`, never through the
//! platform's math library: then a PC and a microcontroller compute the same bits from the same inputs.
//!
//! Square roots are right to half a digit. Angles, sines and cosines are polynomials that minimise the largest error
//! (Remez), as is e^x in `f32` and fixed point; in `f64` it is `libm`'s. In fixed point polar coordinates are found
//! by CORDIC (Volder 1959). Errors are stated at the operations of [`Scalar`], those of fixed point all at [`Fixed`].

mod angle;
mod fixed;
mod float;
mod integer;
pub(crate) mod lanes;
mod transcendental;

pub use self::fixed::Fixed;

use core::fmt::{Debug, Display};
use core::ops::Neg;
use lanes::{LANES, Lanes};
use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

/// A number type the method can run on: `f32`, `f64` or [`Fixed`].
///
/// Small on purpose: only the operations the method needs.
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
    /// Several numbers side by side: vector registers, where the machine has them.
    type Lanes: Lanes<Self, LANES>;
    /// Distance from one to the next larger number: the unit of rounding at 1, and everywhere in fixed point.
    const EPSILON: Self;
    /// Has it a floating point? Then the unit of rounding is as small as the number, and otherwise [`EPSILON`](Self::EPSILON) throughout.
    const FLOATS: bool;
    /// Largest finite number.
    const MAX: Self;
    /// An obstacle with this Gamma or a larger one is too far to matter: in floating point, 1e15, it would not change
    /// a digit of the velocity; in fixed point, 1000, Gamma is near the end of the range.
    const FAR: Self;
    /// Smallest hard semi-axis of an obstacle, m: 1e-4 in floating point, 0.002 in fixed point, where its reciprocal
    /// has to fit.
    const MIN_AXIS: Self;

    /// The nearest number of this type; beyond the range its end, or infinity for a type that has it.
    fn from_f64(x: f64) -> Self;
    /// The same number as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// Neither infinite nor not-a-number.
    fn is_finite(self) -> bool;
    /// |x|
    fn abs(self) -> Self;
    /// Square root. Below zero: not-a-number, or zero for a type without one.
    fn sqrt(self) -> Self;
    /// e^x
    fn exp(self) -> Self;
    /// Sine, x in rad.
    fn sin(self) -> Self;
    /// Cosine, x in rad.
    fn cos(self) -> Self;
    /// Sine and cosine, x in rad: cheaper than one after the other. Error for |x| <= pi: 2e-16 (`f64`), 1e-7 (`f32`),
    /// 1e-6 ([`Fixed`], any x).
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the point (x, self), in rad, from -pi to pi; zero at the origin, and -0 counts as 0.
    ///
    /// Error, rad: 9e-16 (`f64`), 2e-7 (`f32`), 1.5e-6 ([`Fixed`]).
    fn atan2(self, x: Self) -> Self;
    /// Length and angle (as [`Scalar::atan2`]) of the point (x, y): for little more than the angle. Error of the
    /// length: 2e-16 (`f64`), 2e-7 (`f32`) of it, half a step and 4e-8 of it ([`Fixed`]).
    fn polar(x: Self, y: Self) -> (Self, Self);
    /// A bound on the rounding error of one product of this size: in floats EPSILON size; in fixed point one step,
    /// and one more for each whole unit of it, since its terms are wrong by a step each.
    fn rounding(size: Self) -> Self;
    /// Euclidean length, for components whose squares need not fit in fixed point.
    fn norm(components: &[Self]) -> Self;
    /// sqrt(hypotenuse^2 - leg^2), zero where that is no number: the other leg, for lengths whose squares need not
    /// fit, or have no digits, in fixed point.
    fn other_leg(hypotenuse: Self, leg: Self) -> Self;
    /// The length of a vector of up to three components, and the vector over it; zero where that is no number. Error
    /// of the length in fixed point: half a step, and 1.5e-8 of it.
    #[inline(always)]
    fn unit<const D: usize>(v: [Self; D]) -> (Self, [Self; D]) {
        let length = Self::norm(&v);
        (length, if length > Self::zero() { v.map(|x| x / length) } else { [Self::zero(); D] })
    }
    /// a_0 b_0 + a_1 b_1 + ..., as far as both go.
    fn dot(a: &[Self], b: &[Self]) -> Self;

    /// The smaller of two numbers; self where either is none.
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two numbers; self where either is none.
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// x^n for a whole n >= 0, by repeated multiplication.
    fn powi(self, n: u8) -> Self {
        if n == 0 { Self::one() } else { (1..n).fold(self, |y, _| y * self) }
    }
}
