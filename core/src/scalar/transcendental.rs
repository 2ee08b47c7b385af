//! e^x, sine, cosine and polar coordinates of fixed-point numbers with 20 binary digits after the point.
//!
//! The polynomials (Remez) are evaluated with 30 digits after the point; [`high`] of a number with 30 and one with 31 has 29.

use super::integer::{high, normalised, product, rounded, short_reciprocal};

/// Digits after the point.
const DIGITS: u32 = 20;

/// sum_i c_i w^i with the c_i in 2^-30; w in units of 2^-(32 - LOST).
#[inline]
fn polynomial<const LOST: u32, const N: usize>(c: [i32; N], w: i32) -> i32 {
    c.iter().rev().copied().reduce(|sum, c| (high(sum, w) << LOST) + c).unwrap_or(0)
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

/// Length and angle of (x, y); the angle is zero at the origin.
///
/// CORDIC (Volder 1959): the point is turned towards the first axis by angles whose tangents are powers of two, which
/// takes shifts and sums only, and becomes longer by what is known beforehand. Once the angle is small, it is the
/// ratio of the coordinates.
pub(super) fn polar(x: i32, y: i32) -> (i32, i32) {
    /// atan(2^-i) for i from 1 on, in 2^-29
    const TURNS: [i32; 8] =
        [248_918_915, 131_521_918, 66_762_579, 33_510_843, 16_771_758, 8_387_925, 4_194_219, 2_097_141];
    /// What these turns make the length shorter by, in 2^-31: the product of cos(atan(2^-i)).
    const SHORTER: i32 = 1_844_232_157;
    /// pi/2 and pi in 2^-29
    const QUARTER: i32 = 843_314_857;
    const HALF: i32 = 1_686_629_713;
    let (across, along) = (y.unsigned_abs(), x.unsigned_abs());
    if across | along == 0 {
        return (0, 0);
    }
    // An angle knows no size: the larger coordinate has 29 digits, with room for what it grows. The smaller one goes across.
    let (_, zeros) = normalised(across | along);
    let grown = |v: u32| ((v << zeros) >> 3) as i32;
    let upright = across > along;
    let (mut a, mut b) = if upright { (grown(across), grown(along)) } else { (grown(along), grown(across)) };
    let mut angle = 0;
    for (i, turn) in (1..).zip(TURNS) {
        if b >= 0 {
            (a, b, angle) = (a + (b >> i), b - (a >> i), angle + turn);
        } else {
            (a, b, angle) = (a - (b >> i), b + (a >> i), angle - turn);
        }
    }
    // |b/a| <= 2^-8, of which the third power would not show.
    let doubled = u32::from(a < 1 << 29);
    let reciprocal = short_reciprocal((a as u32) << (2 + doubled)) as i32;
    let ratio = (rounded(b << doubled, 7) * reciprocal) >> 9;
    let rest = angle + ratio;
    // sqrt(a^2 + b^2) = a + b (b/a)/2
    let long = high(a + ((b * (ratio >> 12)) >> 18), SHORTER);
    let length = match zeros {
        ..4 => (long as u32).saturating_mul(16 >> zeros).min(i32::MAX as u32) as i32,
        4 => long,
        _ => rounded(long, zeros - 4),
    };
    let rest = if upright { QUARTER - rest } else { rest };
    let rest = rounded(if x < 0 { HALF - rest } else { rest }, 29 - DIGITS);
    (length, if y < 0 { -rest } else { rest })
}
