//! Angles by polynomials, from one reduction and plain arithmetic only.
//!
//! The coefficients minimise the largest error (Remez), relative to the function for the sine and the arc tangent.

use super::Scalar;

/// A number as an unevaluated sum of a leading part and a correction: constants that have more digits than the type.
type Pair<S> = (S, S);

/// sum_i c_i u^i
#[inline(always)]
pub(super) fn polynomial<S: Scalar, const N: usize>(c: &[S; N], u: S) -> S {
    c.iter().rev().copied().reduce(|sum, c| sum * u + c).unwrap_or_else(S::zero)
}

/// Is the angle of a point near to the axis worth a way of its own, which has the same bits? Not where compilers compute several at once.
const BRANCHES: bool = cfg!(target_arch = "arm");

/// What the angle of a point needs.
pub(super) struct ArcTangent<S, const N: usize> {
    /// tan(pi/8)
    pub bound: S,
    /// pi/4, pi/2, 3 pi/4 and pi to the nearest number.
    pub eighth: S,
    pub quarter: S,
    pub three_eighths: S,
    pub half: S,
    /// What they lack, for each radian; zero where that is no digit.
    pub lacking: S,
    /// atan(t) = t + t u (c_0 + c_1 u + ...), u = t^2, |t| <= tan(pi/8)
    pub series: [S; N],
}

impl<S: Scalar, const N: usize> ArcTangent<S, N> {
    /// The angle of (x, y) with one division: t = min/max of |x| and |y|, or (t - 1)/(t + 1) where t > tan(pi/8), which is short
    /// by pi/4; mirrored at the diagonal and at both axes.
    #[inline(always)]
    pub fn angle(&self, y: S, x: S) -> S {
        self.polar(y, x, |squared| squared).1
    }

    /// t^2 and atan t for t = over/under up to tan(pi/8).
    #[inline(always)]
    fn short(&self, over: S, under: S) -> (S, S) {
        let t = over / under;
        let u = t * t;
        (u, t + t * (u * polynomial(&self.series, u)))
    }

    /// The length and angle of (x, y); `root` is the square root, of numbers up to 1 + tan(pi/8)^2.
    #[inline(always)]
    pub fn polar(&self, y: S, x: S, root: impl Fn(S) -> S) -> (S, S) {
        if !BRANCHES {
            return self.anywhere(y, x, root);
        }
        let across = y.abs();
        if !(across <= self.bound * x) {
            return self.elsewhere(y, x, root);
        }
        if x == S::zero() {
            return (S::zero(), S::zero());
        }
        let (u, angle) = self.short(across, x);
        (x * root(S::one() + u), if y < S::zero() { -angle } else { angle })
    }

    /// Apart, so that nothing of it is done before it is known to be needed.
    #[cold]
    #[inline(never)]
    fn elsewhere(&self, y: S, x: S, root: impl Fn(S) -> S) -> (S, S) {
        self.anywhere(y, x, root)
    }

    /// The lengths and angles of several points, with the bits of [`Self::polar`].
    #[inline(always)]
    pub fn polars<const M: usize>(&self, y: &[S; M], x: &[S; M], root: impl Fn(S) -> S) -> ([S; M], [S; M]) {
        let (mut length, mut angle) = ([S::zero(); M], [S::zero(); M]);
        if BRANCHES {
            for i in 0..M {
                (length[i], angle[i]) = self.polar(y[i], x[i], &root);
            }
            return (length, angle);
        }
        let (mut under, mut squared, mut factor) = (length, length, length);
        for i in 0..M {
            let reduced = self.reduced(y[i], x[i]);
            (under[i], squared[i], factor[i], angle[i]) =
                (reduced.under, reduced.squared, reduced.factor, reduced.angle);
        }
        // Roots apart: with them among the rest, compilers would do all of it one by one.
        for squared in &mut squared {
            *squared = root(*squared);
        }
        for i in 0..M {
            length[i] = under[i] * squared[i] * factor[i];
        }
        (length, angle)
    }

    #[inline(always)]
    fn anywhere(&self, y: S, x: S, root: impl Fn(S) -> S) -> (S, S) {
        let Reduced { under, squared, factor, angle } = self.reduced(y, x);
        (under * root(squared) * factor, angle)
    }

    #[inline(always)]
    fn reduced(&self, y: S, x: S) -> Reduced<S> {
        let (zero, half) = (S::zero(), S::from_f64(0.5));
        let (across, along) = (y.abs(), x.abs());
        let upright = across > along;
        let small = if upright { along } else { across };
        let large = if upright { across } else { along };
        let steep = small > self.bound * large;
        // Halved, so that the sum of the largest numbers stays in range.
        let over = if steep { small * half - large * half } else { small };
        let under = if steep { small * half + large * half } else { large };
        // At the origin 0/1.
        let (u, rest) = self.short(over, if under == zero { S::one() } else { under });
        // Only selections from here on: in a loop over many points, compilers compute several at once.
        let back = x < zero;
        let rest = if upright { -rest } else { rest };
        let rest = if back { -rest } else { rest };
        let leading = if back { self.half } else { zero };
        let leading = if upright { self.quarter } else { leading };
        let odd = if back { self.three_eighths } else { self.eighth };
        let leading = if steep { odd } else { leading };
        // Odd eighths lack less than would show.
        let rest = if steep || self.lacking == zero { rest } else { rest + leading * self.lacking };
        let angle = leading + rest;
        // Halves of sum and difference are the point turned by pi/4 and sqrt(2) times as near.
        let factor = if steep { S::from_f64(core::f64::consts::SQRT_2) } else { S::one() };
        Reduced { under, squared: S::one() + u, factor, angle: if y < zero { -angle } else { angle } }
    }
}

/// The angle of a point, and what its length is made of: under sqrt(squared) factor.
struct Reduced<S> {
    under: S,
    squared: S,
    factor: S,
    angle: S,
}

/// What sine and cosine need.
pub(super) struct SineCosine<S, const N: usize> {
    /// pi/4
    pub eighth: S,
    /// pi/2 and pi to the nearest number, and what these lack.
    pub quarter: Pair<S>,
    pub half: Pair<S>,
    /// sin(r) = r + r u (c_0 + c_1 u + ...), u = r^2, |r| <= pi/4
    pub sine: [S; N],
    /// cos(r) = 1 - u/2 + u^2 (c_0 + c_1 u + ...)
    pub cosine: [S; N],
}

impl<S: Scalar, const N: usize> SineCosine<S, N> {
    /// (sin x, cos x), or `None` beyond |x| = pi (and a little more), where this reduction would lose digits.
    #[inline]
    pub fn at(&self, x: S) -> Option<(S, S)> {
        let a = x.abs();
        if !(a <= self.half.0 + self.eighth) {
            return None;
        }
        let near = a <= self.eighth;
        let sideways = a <= self.quarter.0 + self.eighth;
        let base = if sideways { self.quarter } else { self.half };
        // The first difference is exact, for a is within a factor of two of what is taken off.
        let r = if near { a } else { (a - base.0) - base.1 };
        let u = r * r;
        let sin = r + r * (u * polynomial(&self.sine, u));
        let cos = S::one() - (u * S::from_f64(0.5) - u * (u * polynomial(&self.cosine, u)));
        let (sin, cos) = match (near, sideways) {
            (true, _) => (sin, cos),
            (_, true) => (cos, -sin),
            _ => (-sin, -cos),
        };
        Some((if x < S::zero() { -sin } else { sin }, cos))
    }
}
