//! e^x, sine and cosine of fixed-point numbers with 20 binary digits after the point.
//!
//! The polynomials (Remez) are evaluated with 30 digits after the point; [`high`] of a number with 30 and one with 31 has 29.

use super::integer::{high, product};

/// Digits after the point.
const DIGITS: u32 = 20;

/// sum_i c_i w^i with the c_i in 2^-30; w in units of 2^-(32 - LOST).
#[inline]
fn polynomial<const LOST: u32, const N: usize>(c: [i32; N], w: i32) -> i32 {
    c.iter().rev().copied().reduce(|sum, c| (high(sum, w) << LOST) + c).unwrap_or(0)
}

/// x / 2^by to the nearest, ties upwards; by from 1 to 31.
#[inline]
fn rounded(x: i32, by: u32) -> i32 {
    ((x >> (by - 1)) + 1) >> 1
}

/// e^x. The polynomial's own error is 8e-8 of the result.
pub(super) fn exp(x: i32) -> i32 {
    /// 1/ln 2 in 2^-30
    const LOG2_E: i32 = 1_549_082_005;
    /// 2^(1/2 + w/2), |w| <= 1, in 2^-30
    const POWER: [i32; 6] = [1_518_500_359, 526_271_921, 91_193_987, 10_535_949, 918_269, 63_001];
    // Beyond these the result is nothing, or more than there is; between them the shift by 6 fits.
    if x < -15 << DIGITS {
        return 0;
    }
    if x >= 8 << DIGITS {
        return i32::MAX;
    }
    // The power of two, in 2^-24: its whole part is a shift, the rest goes through the polynomial.
    let power = high(x << 6, LOG2_E);
    let whole = power >> 24;
    let w = ((power & 0xff_ffff) - (1 << 23)) << 8;
    let mantissa = polynomial::<1, 6>(POWER, w);
    match 10 - whole {
        ..0 => i32::MAX,
        0 => mantissa,
        shift @ 1..=31 => rounded(mantissa, shift as u32),
        _ => 0,
    }
}

/// (sin x, cos x).
pub(super) fn sin_cos(x: i32) -> (i32, i32) {
    /// 1/(2 pi) in 2^-33
    const TURN: i32 = 1_367_130_551;
    /// sin(w pi/4)/w and cos(w pi/4) as polynomials of w^2, |w| <= 1, in 2^-30
    const SINE: [i32; 4] = [843_314_845, -86_699_678, 2_673_480, -38_523];
    const COSINE: [i32; 4] = [1 << 30, -331_168_273, 17_019_235, -342_696];
    // The angle as a fraction of a turn in 2^-32, whole turns cut off by the conversion; the nearest quarter, and the rest.
    let phase = (product(x, TURN) >> 21) as u32;
    let quarter = phase.wrapping_add(1 << 29) >> 30;
    let w = (phase.wrapping_sub(quarter << 30) as i32) << 2;
    let u = high(w, w);
    let sine = rounded(high(polynomial::<2, 4>(SINE, u), w), 29 - DIGITS);
    let cosine = rounded(polynomial::<2, 4>(COSINE, u), 30 - DIGITS);
    match quarter {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}
