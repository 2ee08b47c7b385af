//! The square root of `f32` on processors that have an instruction for it which no stable function reaches.

/// Is this one faster than `libm`'s? Where there is vector arithmetic `libm` has the instruction. Both give the same number.
const OWN: bool = cfg!(target_arch = "arm");

/// The square root to the nearest number.
#[inline(always)]
pub(super) fn nearest(x: f32) -> f32 {
    if OWN { rounded(x) } else { libm::sqrtf(x) }
}

/// Newton's y/2 + x/(2 y), twice, from half the exponent: good to a digit. What the square lacks says which number is the nearest.
#[inline(never)]
fn rounded(x: f32) -> f32 {
    let bits = x.to_bits();
    let (least, infinite) = (0x0080_0000, 0x7f80_0000);
    // Zero, numbers below the normal ones, negative ones, infinity and not-a-number are rare.
    if bits.wrapping_sub(least) >= infinite - least {
        return libm::sqrtf(x);
    }
    // Within 3.5 %; then too large by 0 to 0.06 %, of which half is taken off; then within one digit.
    let y = f32::from_bits((bits >> 1) + 0x1fbb_4f2e);
    let y = (y + x / y) * 0.499_85;
    let y = (y + x / y) * 0.5;
    // With whole numbers, x = m 2^e: m = root^2 + rest, of which the last 32 digits are enough.
    // From a power of two it is half a step down, so not from there.
    let found = y.to_bits();
    let found = found - u32::from(found & 0x007f_ffff == 0);
    let whole = |bits: u32| (bits & 0x007f_ffff) | 0x0080_0000;
    let shift = (bits >> 23).wrapping_sub((found >> 23) << 1).wrapping_add(150);
    let root = whole(found);
    let rest = whole(bits).wrapping_shl(shift).wrapping_sub(root.wrapping_mul(root)) as i32;
    let root = root as i32;
    // (root - 1/2)^2 < root^2 + rest < (root + 1/2)^2
    let step = i32::from(rest > root) - i32::from(rest <= -root);
    f32::from_bits(found.wrapping_add_signed(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_significand_has_the_nearest_root() {
        // Powers of four only shift the exponent.
        for bits in 0x3f80_0000..0x4080_0000 {
            let x = f32::from_bits(bits);
            assert_eq!(rounded(x).to_bits(), libm::sqrtf(x).to_bits(), "{x}");
        }
    }

    #[test]
    fn every_exponent_and_what_is_no_normal_number() {
        for upper in 0..=0x1ff_u32 {
            for lower in [0, 1, 0x0040_0000, 0x007f_fffe, 0x007f_ffff] {
                let x = f32::from_bits((upper << 23) | lower);
                let (own, other) = (rounded(x), libm::sqrtf(x));
                assert!(own.to_bits() == other.to_bits() || own.is_nan() && other.is_nan(), "{x}");
            }
        }
    }
}
