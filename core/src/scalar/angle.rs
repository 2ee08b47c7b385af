//! Angles by polynomials, from one reduction and plain arithmetic only.
//!
//! The coefficients minimise the largest error (Remez), relative to the function for the sine and the arc tangent.

use super::Scalar;
use super::lanes::{Each, Lanes};

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
            return self.one(y, x, root);
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
        self.one(y, x, root)
    }

    #[inline(always)]
    fn one(&self, y: S, x: S, root: impl Fn(S) -> S) -> (S, S) {
        let (Each([length]), Each([angle])) = self.anywhere(Each([y]), Each([x]), |Each([x])| Each([root(x)]));
        (length, angle)
    }

    /// The lengths and angles of points side by side: only selections, no branches.
    #[inline(always)]
    pub fn anywhere<L: Lanes<S, M>, const M: usize>(&self, y: L, x: L, root: impl Fn(L) -> L) -> (L, L) {
        let of = L::splat;
        let (zero, one, half) = (of(S::zero()), of(S::one()), of(S::from_f64(0.5)));
        let (across, along) = (y.abs(), x.abs());
        let upright = along.below(across);
        let small = L::select(upright, along, across);
        let large = L::select(upright, across, along);
        let steep = (of(self.bound) * large).below(small);
        // Halved, so that the sum of the largest numbers stays in range.
        let over = L::select(steep, small * half - large * half, small);
        let under = L::select(steep, small * half + large * half, large);
        // At the origin 0/1.
        let t = over / L::select(under.is_zero(), one, under);
        let u = t * t;
        let series = self.series.iter().rev().map(|c| of(*c)).reduce(|sum, c| sum * u + c).unwrap_or(zero);
        let rest = t + t * (u * series);
        let back = x.below(zero);
        let rest = rest.opposite_where(upright).opposite_where(back);
        let leading = L::select(back, of(self.half), zero);
        let leading = L::select(upright, of(self.quarter), leading);
        let odd = L::select(back, of(self.three_eighths), of(self.eighth));
        let leading = L::select(steep, odd, leading);
        // Odd eighths lack less than would show.
        let rest =
            if self.lacking == S::zero() { rest } else { L::select(steep, rest, rest + leading * of(self.lacking)) };
        let angle = leading + rest;
        // Halves of sum and difference are the point turned by pi/4 and sqrt(2) times as near.
        let factor = L::select(steep, of(S::from_f64(core::f64::consts::SQRT_2)), one);
        (under * root(one + u) * factor, angle.opposite_where(y.below(zero)))
    }
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
