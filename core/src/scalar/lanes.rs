//! Several numbers side by side, on which one operation works at once where the machine has vector instructions.
//!
//! Each lane has the bits that the scalar operation has: nothing is contracted, and nothing is summed across lanes.

use super::Scalar;
use core::array::from_fn;
use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Lanes of [`Scalar::Lanes`]: one where there are no vector instructions of `f32` and `f64` both.
pub const LANES: usize = if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) { 4 } else { 1 };

/// `N` numbers side by side.
pub trait Lanes<S: Scalar, const N: usize>:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// An answer for each lane.
    type Mask: Copy;

    /// These numbers.
    fn new(numbers: &[S; N]) -> Self;
    /// The numbers.
    fn numbers(self) -> [S; N];
    /// The same number in each lane.
    #[inline(always)]
    fn splat(number: S) -> Self {
        Self::new(&[number; N])
    }
    /// The same answer for each lane.
    fn mask(answer: bool) -> Self::Mask;
    /// |x|
    fn abs(self) -> Self;
    /// self < other
    fn below(self, other: Self) -> Self::Mask;
    /// self = 0
    fn is_zero(self) -> Self::Mask;
    /// `yes` where the mask says so, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// -self where the mask says so, else self.
    fn opposite_where(self, mask: Self::Mask) -> Self;
    /// self/under where the mask says so, else `otherwise`.
    fn over_where(self, mask: Self::Mask, under: Self, otherwise: Self) -> Self;
    /// Does the first mask say so in any lane where the second does not?
    fn any_but(mask: Self::Mask, but: Self::Mask) -> bool;
    /// As [`Scalar::dot`], in each lane.
    fn dot<const D: usize>(a: &[Self; D], b: &[Self; D]) -> Self;
    /// As [`Scalar::norm`], in each lane.
    fn norm<const D: usize>(v: &[Self; D]) -> Self;
    /// As [`Scalar::polar`], in each lane.
    fn polar(x: Self, y: Self) -> (Self, Self);

    /// As [`Scalar::max`], in each lane.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.below(other), other, self)
    }
}

/// Lanes that are computed one by one.
#[derive(Clone, Copy, Debug)]
pub struct Each<S, const N: usize>(pub [S; N]);

macro_rules! each {
    ($($operator:ident $method:ident $sign:tt),+) => {
        $(impl<S: Scalar, const N: usize> $operator for Each<S, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $sign other.0[i]))
            }
        })+
    };
}
each!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<S: Scalar, const N: usize> Neg for Each<S, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl<S: Scalar, const N: usize> Lanes<S, N> for Each<S, N> {
    type Mask = [bool; N];

    #[inline(always)]
    fn new(numbers: &[S; N]) -> Self {
        Self(*numbers)
    }
    #[inline(always)]
    fn numbers(self) -> [S; N] {
        self.0
    }
    #[inline(always)]
    fn mask(answer: bool) -> [bool; N] {
        [answer; N]
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(S::abs))
    }
    #[inline(always)]
    fn below(self, other: Self) -> [bool; N] {
        from_fn(|i| self.0[i] < other.0[i])
    }
    #[inline(always)]
    fn is_zero(self) -> [bool; N] {
        from_fn(|i| self.0[i] == S::zero())
    }
    #[inline(always)]
    fn select(mask: [bool; N], yes: Self, no: Self) -> Self {
        Self(from_fn(|i| if mask[i] { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn opposite_where(self, mask: [bool; N]) -> Self {
        Self(from_fn(|i| if mask[i] { -self.0[i] } else { self.0[i] }))
    }
    #[inline(always)]
    fn over_where(self, mask: [bool; N], under: Self, otherwise: Self) -> Self {
        Self(from_fn(|i| if mask[i] { self.0[i] / under.0[i] } else { otherwise.0[i] }))
    }
    #[inline(always)]
    fn any_but(mask: [bool; N], but: [bool; N]) -> bool {
        mask.iter().zip(&but).any(|(mask, but)| *mask && !*but)
    }
    #[inline(always)]
    fn dot<const D: usize>(a: &[Self; D], b: &[Self; D]) -> Self {
        Self(from_fn(|i| S::dot(&a.map(|a| a.0[i]), &b.map(|b| b.0[i]))))
    }
    #[inline(always)]
    fn norm<const D: usize>(v: &[Self; D]) -> Self {
        Self(from_fn(|i| S::norm(&v.map(|v| v.0[i]))))
    }
    #[inline(always)]
    fn polar(x: Self, y: Self) -> (Self, Self) {
        let polar: [(S, S); N] = from_fn(|i| S::polar(x.0[i], y.0[i]));
        (Self(polar.map(|p| p.0)), Self(polar.map(|p| p.1)))
    }
}

/// The registers of x86-64 and Arm's 64 bits. `wide` hands each operation on to one instruction (or two of half the lanes).
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod registers {
    use super::super::float::{ATAN_F32, ATAN_F64};
    use super::{LANES, Lanes};
    use wide::{f32x4, f64x4};

    macro_rules! registers {
        ($wide:ty, $number:ty, $angle:ident) => {
            impl Lanes<$number, LANES> for $wide {
                type Mask = Self;

                #[inline(always)]
                fn new(numbers: &[$number; LANES]) -> Self {
                    <$wide>::new(*numbers)
                }
                #[inline(always)]
                fn numbers(self) -> [$number; LANES] {
                    self.to_array()
                }
                #[inline(always)]
                fn mask(answer: bool) -> Self {
                    Self::splat(0.0).simd_eq(Self::splat(if answer { 0.0 } else { 1.0 }))
                }
                #[inline(always)]
                fn abs(self) -> Self {
                    <$wide>::abs(self)
                }
                #[inline(always)]
                fn below(self, other: Self) -> Self {
                    self.simd_lt(other)
                }
                #[inline(always)]
                fn is_zero(self) -> Self {
                    self.simd_eq(Self::splat(0.0))
                }
                #[inline(always)]
                fn select(mask: Self, yes: Self, no: Self) -> Self {
                    mask.bitselect(yes, no)
                }
                #[inline(always)]
                fn opposite_where(self, mask: Self) -> Self {
                    self ^ (mask & Self::splat(-0.0))
                }
                #[inline(always)]
                fn over_where(self, mask: Self, under: Self, otherwise: Self) -> Self {
                    mask.bitselect(self / under, otherwise)
                }
                #[inline(always)]
                fn any_but(mask: Self, but: Self) -> bool {
                    (mask & !but).any()
                }
                #[inline(always)]
                fn dot<const D: usize>(a: &[Self; D], b: &[Self; D]) -> Self {
                    let products = a.iter().zip(b).map(|(a, b)| *a * *b);
                    products.reduce(|sum, product| sum + product).unwrap_or(Self::splat(0.0))
                }
                #[inline(always)]
                fn norm<const D: usize>(v: &[Self; D]) -> Self {
                    <Self as Lanes<$number, LANES>>::dot(v, v).sqrt()
                }
                #[inline(always)]
                fn polar(x: Self, y: Self) -> (Self, Self) {
                    $angle.anywhere(y, x, <$wide>::sqrt)
                }
            }
        };
    }
    registers!(f32x4, f32, ATAN_F32);
    registers!(f64x4, f64, ATAN_F64);
}

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
pub use wide::{f32x4 as Lanes32, f64x4 as Lanes64};
/// Lanes of `f32`.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub type Lanes32 = Each<f32, LANES>;
/// Lanes of `f64`.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub type Lanes64 = Each<f64, LANES>;
