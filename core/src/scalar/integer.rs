//! What fixed point is made of: products, quotients and roots of whole numbers, in few instructions on a processor that neither
//! multiplies 32 by 32 bits into 64 nor divides.

/// Is a long product one instruction? Armv6-M has none, and of the Arm processors it is the one without atomic exchange, which a
/// program can ask the compiler about. Both ways give the same number.
const LONG_MULTIPLY: bool = cfg!(any(not(target_arch = "arm"), target_has_atomic = "32"));

/// a b
#[inline]
pub(super) fn product(a: i32, b: i32) -> i64 {
    if LONG_MULTIPLY { i64::from(a) * i64::from(b) } else { by_halves(a, b) }
}

/// a^2
#[inline]
pub(super) fn square(a: i32) -> u64 {
    product(a, a) as u64
}

/// The upper half of a b, rounded down.
#[inline]
pub(super) fn high(a: i32, b: i32) -> i32 {
    (product(a, b) >> 32) as i32
}

/// a b, without signs.
#[inline]
fn unsigned_product(a: u32, b: u32) -> u64 {
    if LONG_MULTIPLY { u64::from(a) * u64::from(b) } else { unsigned_by_halves(a, b) }
}

/// a b from four products of 16 bits; no sum in it leaves 32 bits.
#[inline]
fn by_halves(a: i32, b: i32) -> i64 {
    let (upper, lower) = (|x: i32| x >> 16, |x: i32| x & 0xffff);
    let low = (lower(a) as u32).wrapping_mul(lower(b) as u32);
    let first = upper(a).wrapping_mul(lower(b)).wrapping_add((low >> 16) as i32);
    let second = lower(a).wrapping_mul(upper(b)).wrapping_add(lower(first));
    let high = upper(a).wrapping_mul(upper(b)).wrapping_add(upper(first)).wrapping_add(upper(second));
    (i64::from(high) << 32) | i64::from(((second as u32) << 16) | (low & 0xffff))
}

/// The same, without signs.
#[inline]
fn unsigned_by_halves(a: u32, b: u32) -> u64 {
    let (upper, lower) = (|x: u32| x >> 16, |x: u32| x & 0xffff);
    let low = lower(a).wrapping_mul(lower(b));
    let first = upper(a).wrapping_mul(lower(b)).wrapping_add(upper(low));
    let second = lower(a).wrapping_mul(upper(b)).wrapping_add(lower(first));
    let high = upper(a).wrapping_mul(upper(b)).wrapping_add(upper(first)).wrapping_add(upper(second));
    (u64::from(high) << 32) | u64::from((second << 16) | lower(low))
}

/// a b / 2^BITS to the nearest, ties upwards, or the end of the range.
#[inline]
pub(super) fn scaled<const BITS: u32>(a: i32, b: i32) -> i32 {
    if LONG_MULTIPLY {
        let rounded = product(a, b).wrapping_add(1 << (BITS - 1));
        return narrowed::<BITS>(rounded).unwrap_or_else(|| end(a ^ b));
    }
    scaled_by_halves::<BITS>(a, b)
}

/// The same from four products of 16 bits, as in [`by_halves`]. The lowest 16 bits of a b decide nothing; half of the last digit goes in
/// above them.
#[inline]
fn scaled_by_halves<const BITS: u32>(a: i32, b: i32) -> i32 {
    let (upper, lower) = (|x: i32| x >> 16, |x: i32| x & 0xffff);
    let low = (lower(a) as u32).wrapping_mul(lower(b) as u32);
    let first = upper(a).wrapping_mul(lower(b)).wrapping_add((low >> 16) as i32);
    let second = lower(a).wrapping_mul(upper(b)).wrapping_add(lower(first)).wrapping_add(1 << (BITS - 17));
    let high = upper(a).wrapping_mul(upper(b)).wrapping_add(upper(first)).wrapping_add(upper(second));
    if fits::<BITS>(high) { (high << (32 - BITS)) | (lower(second) >> (BITS - 16)) } else { end(high) }
}

/// (a b + c d) / 2^BITS to the nearest, ties upwards, or the end of the range.
#[inline]
pub(super) fn scaled_pair<const BITS: u32>(a: i32, b: i32, c: i32, d: i32) -> i32 {
    if LONG_MULTIPLY {
        let sum = product(a, b).wrapping_add(product(c, d)).wrapping_add(1 << (BITS - 1));
        return narrowed::<BITS>(sum).unwrap_or_else(|| end_of_pair((sum >> 32) as i32));
    }
    scaled_pair_by_halves::<BITS>(a, b, c, d)
}

/// The same as in [`scaled_by_halves`], the sums one after the other. A function of its own, for it takes all registers there are.
#[inline(never)]
fn scaled_pair_by_halves<const BITS: u32>(a: i32, b: i32, c: i32, d: i32) -> i32 {
    let (upper, lower) = (|x: i32| x >> 16, |x: i32| x & 0xffff);
    let low = (lower(a) as u32).wrapping_mul(lower(b) as u32);
    let first = upper(a).wrapping_mul(lower(b)).wrapping_add((low >> 16) as i32);
    let second = lower(a).wrapping_mul(upper(b)).wrapping_add(lower(first));
    let high = upper(a).wrapping_mul(upper(b)).wrapping_add(upper(first)).wrapping_add(upper(second));
    let low = (lower(c) as u32).wrapping_mul(lower(d) as u32).wrapping_add(low & 0xffff);
    let first = upper(c).wrapping_mul(lower(d)).wrapping_add((low >> 16) as i32);
    let middle = lower(second) + (1 << (BITS - 17));
    let second = lower(c).wrapping_mul(upper(d)).wrapping_add(lower(first));
    let high =
        upper(c).wrapping_mul(upper(d)).wrapping_add(high).wrapping_add(upper(first)).wrapping_add(upper(second));
    let middle = middle + lower(second);
    let high = high.wrapping_add(upper(middle));
    if fits::<BITS>(high) { (high << (32 - BITS)) | (lower(middle) >> (BITS - 16)) } else { end_of_pair(high) }
}

/// The end of the range for a sum of two products with this upper word: only 2^63, of four least numbers, looks as if it were below zero.
fn end_of_pair(high: i32) -> i32 {
    end(high.wrapping_sub(1))
}

/// The end of the range on the side of x.
#[cold]
#[inline(never)]
pub(super) fn end(x: i32) -> i32 {
    if x < 0 { i32::MIN } else { i32::MAX }
}

/// Do 64 bits with this upper word fit into 32, once divided by 2^BITS? They do if the bits above the result's sign are all like it.
#[inline]
fn fits<const BITS: u32>(high: i32) -> bool {
    high >> 31 == high >> (BITS - 1)
}

/// p / 2^BITS rounded down, if it fits.
#[inline]
pub(super) fn narrowed<const BITS: u32>(p: i64) -> Option<i32> {
    let high = (p >> 32) as i32;
    fits::<BITS>(high).then_some((high << (32 - BITS)) | (p as u32 >> BITS) as i32)
}

/// x / 2^by to the nearest, ties upwards; by from 1 to 31.
#[inline]
pub(super) fn rounded(x: i32, by: u32) -> i32 {
    ((x >> (by - 1)) + 1) >> 1
}

/// n 2^BITS / d to the nearest, ties upwards; 2^31 where it is more or d = 0. Both n and d are at most 2^31.
///
/// A reciprocal good to 26 digits and never too large gives a quotient that is never too large either, short by up to
/// 21, and by no more than 2 where it is below 2^27. What it leaves is thus below 2^32, so 32 bits of it are all of
/// it, and says which whole number is the nearest.
pub(super) fn quotient<const BITS: u32>(n: u32, d: u32) -> u32 {
    if n >> (31 - BITS) >= d {
        return 1 << 31;
    }
    let (normal, zeros) = normalised(d);
    let mut quotient = shifted(unsigned_product(n, reciprocal(normal)), 62 - BITS - zeros);
    let mut rest = (n << BITS).wrapping_sub(quotient.wrapping_mul(d));
    while rest >= d {
        rest -= d;
        quotient += 1;
    }
    if rest >= d - rest { quotient + 1 } else { quotient }
}

/// x with its first digit moved to the highest place, and by how many places; x is not zero.
#[inline]
pub(super) fn normalised(x: u32) -> (u32, u32) {
    if LONG_MULTIPLY {
        // A processor that has the one instruction has the other.
        let zeros = x.leading_zeros();
        return (x << (zeros & 31), zeros);
    }
    normalised_by_bytes(x)
}

/// The same from the zeros of a byte, in a table.
#[inline]
fn normalised_by_bytes(x: u32) -> (u32, u32) {
    const ZEROS: [u8; 256] = {
        let mut zeros = [8; 256];
        let mut byte = 1;
        while byte < 256 {
            zeros[byte] = (byte as u8).leading_zeros() as u8;
            byte += 1;
        }
        zeros
    };
    let of = |byte: u32| u32::from(ZEROS[usize::from(byte as u8)]);
    let zeros = match x {
        0x100_0000.. => of(x >> 24),
        0x1_0000.. => of(x >> 16) + 8,
        0x100.. => of(x >> 8) + 16,
        _ => of(x) + 24,
    };
    (x << (zeros & 31), zeros)
}

/// p / 2^by, rounded down, for a result that fits; by from 1 to 63. Half of p at a time, for a shift of 64 bits would be a call.
#[inline]
fn shifted(p: u64, by: u32) -> u32 {
    let (upper, lower) = ((p >> 32) as u32, p as u32);
    if by >= 32 { upper >> (by & 31) } else { (upper << ((32 - by) & 31)) | (lower >> (by & 31)) }
}

/// 2^62 / d for d from 2^31 on, to 26 digits and never more than it is: Newton's r (2 - d r), which doubles the digits.
#[inline]
fn reciprocal(d: u32) -> u32 {
    finer_reciprocal(d, short_reciprocal(d))
}

/// The same from an estimate r, which is 2^47 / d to 14 digits.
#[inline]
fn finer_reciprocal(d: u32, r: u32) -> u32 {
    let x = d >> 16;
    // One step with all digits of d: what 1 - D r is, in 2^-31.
    let missing = (1_u32 << 31).wrapping_sub(x * r + (((d & 0xffff) * r) >> 16)) as i32;
    ((r << 15) - 1).wrapping_add_signed((r as i32 * (missing >> 2)) >> 14)
}

/// 2^47 / d for d from 2^31 on, to 14 digits.
#[inline]
pub(super) fn short_reciprocal(d: u32) -> u32 {
    // D = d/2^31 from 1 to 2; r in 2^-16 is 1/D, at first by the best line, 24/17 - 8/17 D, to 4 digits.
    let x = d >> 16;
    let mut r = 92_521 - ((x * 61_681) >> 16);
    for _ in 0..2 {
        r = (r * ((1 << 16) - ((x * r) >> 16))) >> 15;
    }
    r
}

/// The square root to the nearest, at most 2^31 - 1.
///
/// As with [`quotient`]: the estimate is good to 26 digits, and what it leaves says which whole number is the nearest.
pub(super) fn root(square: u64) -> u32 {
    if square >= 1 << 62 {
        return i32::MAX as u32;
    }
    if square == 0 {
        return 0;
    }
    let (leading, places) = leading(square);
    let mut root = normal_root(leading).0 >> places;
    if root >= 1 << 26 {
        return nearest_root(square, root);
    }
    // Within two of it: 32 bits of what is left are all of it.
    let mut rest = (square as u32).wrapping_sub(root.wrapping_mul(root)) as i32;
    // (root - 1/2)^2 < square < (root + 1/2)^2
    while rest > root as i32 {
        rest -= (root + root + 1) as i32;
        root += 1;
    }
    while rest <= -(root as i32) {
        root -= 1;
        rest += (root + root + 1) as i32;
    }
    root
}

/// The same from an estimate for which 32 bits are not enough.
#[cold]
#[inline(never)]
fn nearest_root(square: u64, mut root: u32) -> u32 {
    let mut rest = square.wrapping_sub(unsigned_product(root, root)) as i64;
    while rest > i64::from(root) {
        rest -= i64::from(root) + i64::from(root) + 1;
        root += 1;
    }
    while rest <= -i64::from(root) {
        root -= 1;
        rest += i64::from(root) + i64::from(root) + 1;
    }
    root.min(i32::MAX as u32)
}

/// h and n such that 2^32 h is the square from its first digit on, which is h's first or second, and the root of it 2^n times the square's.
#[inline]
fn leading(square: u64) -> (u32, u32) {
    let (upper, lower) = ((square >> 32) as u32, square as u32);
    if upper == 0 {
        let (leading, zeros) = normalised(lower);
        (leading >> (zeros & 1), 16 + (zeros >> 1))
    } else {
        let zeros = normalised(upper).1 & 30;
        ((upper << zeros) | ((lower >> 1) >> (31 - zeros)), zeros >> 1)
    }
}

/// The length of a vector of up to three coordinates, to 26 digits and at most 2^31 - 1, and the vector of that
/// direction whose length is 2^29; nothing for zero.
pub(super) fn unit<const D: usize>(v: [i32; D]) -> (u32, [i32; D]) {
    let square = v.iter().fold(0_u64, |sum, x| sum.wrapping_add(square(*x)));
    if square == 0 {
        return (0, v);
    }
    let (leading, places) = leading(square);
    let (root, estimate) = normal_root(leading);
    let inverse = finer_reciprocal(root, estimate).min(i32::MAX as u32) as i32;
    let Some(places) = places.checked_sub(1) else {
        return (i32::MAX as u32, v.map(|x| high(x >> 1, inverse)));
    };
    let length = (root >> places).div_ceil(2).min(i32::MAX as u32);
    (length, v.map(|x| high(x << places, inverse)))
}

/// sqrt(2^32 h) for h from 2^30 on, to 26 digits: h times Newton's reciprocal root y (3 - h y^2)/2, and its
/// remainder. With it y, to 14 digits.
#[inline]
fn normal_root(h: u32) -> (u32, u32) {
    // y in 2^-15 is the reciprocal root of h/2^32, at first by the best parabola, to 2.4 %.
    let x = h >> 16;
    let mut y = 87_518 - ((x * (107_655 - ((x * 53_693) >> 16))) >> 16);
    for _ in 0..2 {
        let square = ((y >> 1) * (y >> 1)) >> 13;
        y = (y * (((3 << 15) - ((x * square) >> 16)) >> 1)) >> 15;
    }
    let r = (x * y) >> 15;
    let rest = h.wrapping_sub(r * r) as i32;
    ((r << 16).saturating_add_signed(((rest >> 4) * y as i32) >> 12), y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pattern of long runs of ones and zeros: where carries and signs go wrong.
    fn telling() -> impl Iterator<Item = i32> + Clone {
        (0..32).flat_map(|n| [1_i64 << n, (1 << n) - 1, (1 << n) + 1, -1 << n].map(|x| x as i32))
    }

    #[test]
    fn both_ways_to_multiply_agree() {
        for a in telling() {
            for b in telling() {
                assert_eq!(by_halves(a, b), i64::from(a) * i64::from(b), "{a} {b}");
                let (c, d) = (a as u32, b as u32);
                assert_eq!(unsigned_by_halves(c, d), u64::from(c) * u64::from(d), "{c} {d}");
            }
        }
        let mut x = 1_u64;
        for _ in 0..1_000_000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (a, b) = ((x >> 32) as i32, (x.swap_bytes() >> 32) as i32);
            assert_eq!(by_halves(a, b), i64::from(a) * i64::from(b), "{a} {b}");
            let (c, d) = (a as u32, b as u32);
            assert_eq!(unsigned_by_halves(c, d), u64::from(c) * u64::from(d), "{c} {d}");
        }
    }

    #[test]
    fn both_ways_to_scale_and_to_normalise_agree() {
        for (a, b) in telling().flat_map(|a| telling().map(move |b| (a, b))) {
            let exact =
                ((i64::from(a) * i64::from(b)).saturating_add(1 << 19) >> 20).clamp(i32::MIN.into(), i32::MAX.into());
            assert_eq!(i64::from(scaled_by_halves::<20>(a, b)), exact, "{a} {b}");
            assert_eq!(i64::from(scaled::<20>(a, b)), exact, "{a} {b}");
            for (c, d) in telling().flat_map(|c| [i32::MIN, i32::MAX, a, !b, 5].map(|d| (c, d))) {
                let sum = i128::from(a) * i128::from(b) + i128::from(c) * i128::from(d);
                let exact = ((sum + (1 << 19)) >> 20).clamp(i32::MIN.into(), i32::MAX.into());
                assert_eq!(i128::from(scaled_pair_by_halves::<20>(a, b, c, d)), exact, "{a} {b} {c} {d}");
                assert_eq!(i128::from(scaled_pair::<20>(a, b, c, d)), exact, "{a} {b} {c} {d}");
            }
        }
        for x in telling().map(|x| x as u32).filter(|x| *x != 0) {
            assert_eq!(normalised_by_bytes(x), (x << x.leading_zeros(), x.leading_zeros()));
        }
    }

    #[test]
    fn estimates_are_as_good_as_said() {
        for n in (1_u32 << 31..=u32::MAX).step_by(1009).chain([u32::MAX, u32::MAX - 1]) {
            let exact = libm::exp2(62.0) / f64::from(n);
            let error = f64::from(reciprocal(n)) / exact - 1.0;
            assert!(error <= 0.0 && error > -libm::exp2(-26.5), "{n}");
            let error = f64::from(short_reciprocal(n)) / exact * libm::exp2(15.0) - 1.0;
            assert!(error.abs() < libm::exp2(-14.0), "{n}");
        }
        for n in (1_u32 << 30..=u32::MAX).step_by(2003).chain([u32::MAX, u32::MAX - 1]) {
            let exact = libm::sqrt(f64::from(n) * libm::exp2(32.0));
            assert!((f64::from(normal_root(n).0) / exact - 1.0).abs() < libm::exp2(-26.0), "{n}");
        }
    }

    #[test]
    fn a_root_is_the_nearest_one_that_fits() {
        let check = |square: u64| {
            let exact = u128::from(square);
            let r = u128::from(root(square));
            if square >= (1 << 62) - (1 << 31) {
                assert_eq!(r, (1 << 31) - 1);
            } else {
                // (r - 1/2)^2 < square < (r + 1/2)^2, in quarters
                assert!(4 * exact < (2 * r + 1).pow(2), "{square}: {r}");
                assert!(r == 0 || 4 * exact > (2 * r - 1).pow(2), "{square}: {r}");
            }
        };
        for n in 0..31 {
            for r in [(1_u64 << n) - 1, 1 << n, (1 << n) + 1, 3 << n >> 1] {
                for square in [r * r, r * r + r, r * r + r + 1, (r * r).saturating_sub(1), r * r + 2 * r] {
                    check(square);
                }
            }
        }
        let mut x = 1_u64;
        for n in 0..1_000_000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            check(x >> (n % 64));
        }
        (0..100_000).for_each(check);
        [u64::MAX, 1 << 62, (1 << 62) - 1, 1 << 60, (1 << 60) - 1].into_iter().for_each(check);
    }
}
