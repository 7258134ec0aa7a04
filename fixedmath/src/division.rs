//! Division of 16:16 numbers.
//!
//! [`restoring`] is the published one, a bit a step. Ours take the divisor's reciprocal instead: the divisor is
//! shifted until it fills its word, a line from a 32-entry table gives the reciprocal to 2^-12 from below, and one step
//! of third order, `r (1 + e + e^2)` with `e = 1 - d r`, brings it to the word's last bit. A quotient made of it is at
//! most one too small, which its remainder tells.

use fixed::types::I16F16;

/// `a / b` by restoring division, one bit a step, rounded towards zero: within 1 ulp.
///
/// The published algorithm: shift a bit of the dividend into the remainder, take the divisor away where it fits, note a
/// one. A quotient that does not fit saturates; a zero divisor gives the end of the range on the dividend's side, and
/// 0 / 0 is 0.
///
/// Cost: 402 instructions.
///
/// ```
/// use fixedmath::{division, I16F16};
/// let (one, three) = (I16F16::from_num(1), I16F16::from_num(3));
/// assert_eq!(division::restoring(one, three), I16F16::from_bits(21845));
/// assert_eq!(division::restoring(one, I16F16::ZERO), I16F16::MAX);
/// ```
#[doc(alias = "div")]
pub const fn restoring(a: I16F16, b: I16F16) -> I16F16 {
    let negative = (a.to_bits() < 0) != (b.to_bits() < 0);
    let limit = if negative { 1u32 << 31 } else { i32::MAX as u32 };
    let dividend = a.to_bits().unsigned_abs();
    let divisor = b.to_bits().unsigned_abs();
    if dividend == 0 {
        return I16F16::ZERO;
    }
    // The quotient has the bits of dividend * 2^16 / divisor: it fits unless the dividend's upper part already
    // reaches the divisor.
    let magnitude = if (dividend >> 16) >= divisor {
        limit
    } else {
        let quotient = restoring_bits(dividend >> 16, dividend << 16, divisor);
        if quotient > limit { limit } else { quotient }
    };
    I16F16::from_bits(if negative {
        magnitude.wrapping_neg() as i32
    } else {
        magnitude as i32
    })
}

/// `(remainder : low) / divisor` for `remainder < divisor`, rounded down.
const fn restoring_bits(mut remainder: u32, mut low: u32, divisor: u32) -> u32 {
    let mut quotient = 0;
    let mut bit = 0;
    while bit < 32 {
        let carry = remainder >> 31;
        remainder = remainder << 1 | low >> 31;
        low <<= 1;
        quotient <<= 1;
        if carry == 1 || remainder >= divisor {
            remainder = remainder.wrapping_sub(divisor);
            quotient |= 1;
        }
        bit += 1;
    }
    quotient
}

/// `a / b` to the nearest, halves away from zero: within 0.5 ulp.
///
/// A quotient that does not fit saturates; a zero divisor gives the end of the range on the dividend's side, and
/// 0 / 0 is 0.
///
/// Cost: 38 instructions.
///
/// ```
/// use fixedmath::{division, I16F16};
/// let (two, three) = (I16F16::from_num(2), I16F16::from_num(3));
/// assert_eq!(division::nearest(two, three), I16F16::from_bits(43691));
/// assert_eq!(division::nearest(-two, I16F16::ZERO), I16F16::MIN);
/// assert_eq!(division::nearest(I16F16::MIN, -I16F16::ONE), I16F16::MAX);
/// ```
#[doc(alias = "div")]
#[inline]
pub const fn nearest(a: I16F16, b: I16F16) -> I16F16 {
    let sign = (a.to_bits() ^ b.to_bits()) >> 31;
    let (dividend, divisor) = (a.to_bits().unsigned_abs(), b.to_bits().unsigned_abs());
    // 2^31 ulp or more, or no quotient at all. None is rounded up to 2^31: that would take a dividend beyond 2^31.
    if dividend >> 15 >= divisor {
        return beyond(a, sign);
    }
    signed(quotient(dividend, divisor), sign)
}

/// `1 / x` to the nearest, halves away from zero: within 0.5 ulp.
///
/// Saturates for 0, which counts as positive, and for 1 and 2 ulp; the reciprocal of -1 ulp is `MIN`, that of -2 ulp too.
///
/// Cost: 33 instructions.
///
/// ```
/// use fixedmath::{division, I16F16};
/// assert_eq!(division::reciprocal(I16F16::from_num(-3)), I16F16::from_bits(-21845));
/// ```
#[doc(alias("div", "recip"))]
#[inline]
pub const fn reciprocal(x: I16F16) -> I16F16 {
    let sign = x.to_bits() >> 31;
    let divisor = x.to_bits().unsigned_abs();
    if divisor <= 2 {
        return I16F16::from_bits(i32::MAX ^ sign);
    }
    let quotient = if cfg!(hardware_divide) {
        divided_out(divisor)
    } else {
        multiplied_out(divisor)
    };
    let remainder = 0u32.wrapping_sub(quotient.wrapping_mul(divisor));
    signed(mended(quotient, remainder, divisor), sign)
}

/// 2^32 / `divisor` rounded down, or one less, for divisors above 2: where the core divides, in one instruction.
const fn divided_out(divisor: u32) -> u32 {
    u32::MAX / divisor
}

/// As [`divided_out`], for cores that do not divide; where both fall short they need not do so together.
#[inline]
const fn multiplied_out(divisor: u32) -> u32 {
    let shift = divisor.leading_zeros();
    reciprocal_of_normal(divisor << shift) >> (31 - shift)
}

/// [`reciprocal`], or `None` for 0, 1 and 2 ulp and -1 ulp.
pub const fn checked_reciprocal(x: I16F16) -> Option<I16F16> {
    match x.to_bits() {
        -1..=2 => None,
        _ => Some(reciprocal(x)),
    }
}

/// [`restoring`], or `None` where the divisor is zero or the quotient does not fit.
pub const fn checked_restoring(a: I16F16, b: I16F16) -> Option<I16F16> {
    if fits(a, b) { Some(restoring(a, b)) } else { None }
}

/// [`nearest`], or `None` where the divisor is zero or the quotient does not fit.
///
/// ```
/// use fixedmath::{division, I16F16};
/// assert_eq!(division::checked_nearest(I16F16::ONE, I16F16::ONE), Some(I16F16::ONE));
/// assert_eq!(division::checked_nearest(I16F16::ONE, I16F16::ZERO), None);
/// assert_eq!(division::checked_nearest(I16F16::MIN, -I16F16::ONE), None);
/// ```
pub const fn checked_nearest(a: I16F16, b: I16F16) -> Option<I16F16> {
    if fits(a, b) { Some(nearest(a, b)) } else { None }
}

/// `dividend / divisor` of a long number, rounded down.
///
/// `u32::MAX` where the quotient does not fit, and for a divisor of 0.
///
/// ```
/// use fixedmath::division;
/// assert_eq!(division::long(1 << 40, 3 << 10), 357_913_941);
/// assert_eq!(division::long(1 << 32, 1), u32::MAX);
/// ```
pub const fn long(dividend: u64, divisor: u32) -> u32 {
    if dividend >> 32 >= divisor as u64 {
        return u32::MAX;
    }
    let shift = divisor.leading_zeros();
    let (dividend, divisor) = (dividend << shift, divisor << shift);
    // Too small by less than 7: 2 for the dividend's lower word, 4 for the reciprocal, 1 for what is cut off.
    let mut quotient = ((dividend >> 32) * reciprocal_of_normal(divisor) as u64) >> 31;
    let mut remainder = dividend - quotient * divisor as u64;
    while remainder >= divisor as u64 {
        remainder -= divisor as u64;
        quotient += 1;
    }
    quotient as u32
}

/// Whether there is a quotient within the format.
const fn fits(a: I16F16, b: I16F16) -> bool {
    let (dividend, divisor) = (a.to_bits().unsigned_abs(), b.to_bits().unsigned_abs());
    let is_least = (a.to_bits() < 0) != (b.to_bits() < 0) && dividend as u64 == (divisor as u64) << 15;
    divisor != 0 && (dividend >> 15 < divisor || is_least)
}

/// What saturates: the end of the range on the quotient's side; 0 for 0 / 0.
const fn beyond(a: I16F16, sign: i32) -> I16F16 {
    if a.to_bits() == 0 {
        return I16F16::ZERO;
    }
    I16F16::from_bits(i32::MAX ^ sign)
}

/// A magnitude with its sign, all ones for minus.
const fn signed(magnitude: u32, sign: i32) -> I16F16 {
    I16F16::from_bits((magnitude as i32 ^ sign).wrapping_sub(sign))
}

/// `dividend 2^16 / divisor` to the nearest, halves up, for quotients below 2^31.
#[inline]
const fn quotient(dividend: u32, divisor: u32) -> u32 {
    let shift = divisor.leading_zeros();
    let inverse = reciprocal_of_normal(divisor << shift);
    // dividend inverse / 2^(47 - shift): shifted before where that fits, or else after.
    let quotient = if shift >= 15 {
        upper(dividend << (shift - 15), inverse)
    } else {
        upper(dividend, inverse) >> (15 - shift)
    };
    let remainder = (dividend << 16).wrapping_sub(quotient.wrapping_mul(divisor));
    mended(quotient, remainder, divisor)
}

/// A quotient that is right or one too small, rounded by its remainder, which is below twice the divisor, so that its
/// lower word is all of it.
#[inline]
const fn mended(mut quotient: u32, mut remainder: u32, divisor: u32) -> u32 {
    if remainder >= divisor {
        remainder -= divisor;
        quotient += 1;
    }
    if remainder << 1 >= divisor {
        quotient += 1;
    }
    quotient
}

/// 2^63 / `d` for `d` >= 2^31, rounded down or one less, and below 2^32.
#[inline]
pub(crate) const fn reciprocal_of_normal(d: u32) -> u32 {
    let [start, loss] = LINES[(d << 1 >> 27) as usize];
    let r = start - upper(loss, d << 6);
    // e 2^42, which has 30 bits; what is cut off makes it too small, never too large.
    let e = !((d as u64 * r as u64) >> 21) as u32;
    let e = e + (upper(e, e) >> 10);
    r + (upper(r, e) >> 10)
}

const fn upper(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// Lines for 2^63 / d below the curve, between multiples of 2^26 from 2^31 on: the value at the segment's start, and
/// what it loses along the segment.
static LINES: [[u32; 2]; 32] = lines();

const fn lines() -> [[u32; 2]; 32] {
    let mut lines = [[0; 2]; 32];
    let mut segment = 0;
    while segment < 32 {
        let i = segment as u64 + 32;
        let (start, end) = ((1 << 37) / i, (1 << 37) / (i + 1));
        let middle = (1 << 38) / (2 * i + 1);
        // The chord lies above the curve, most of all near the middle: lowered by that and a little it lies below.
        let sag = (start + end) / 2 - middle;
        let sag = sag + sag / 32 + 4;
        lines[segment] = [(start - sag) as u32, (start - end) as u32];
        segment += 1;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{divided_out, mended, multiplied_out, quotient, reciprocal_of_normal};

    /// How far the reciprocal lies below 2^63 / `d`, times `d`.
    fn shortfall(d: u32) -> u64 {
        (1 << 63) - u64::from(d) * u64::from(reciprocal_of_normal(d))
    }

    /// Cores with a divide instruction and cores without one give the same reciprocals.
    #[test]
    fn both_ways_to_a_reciprocal_are_mended_to_the_same() {
        let nearest = |quotient: u32, divisor: u32| {
            mended(
                quotient,
                0u32.wrapping_sub(quotient.wrapping_mul(divisor)),
                divisor,
            )
        };
        let powers = (2..32).flat_map(|place| [(1u32 << place) - 1, 1 << place, (1 << place) + 1]);
        let spread = (0..1u32 << 22).map(|step| (step << 9 | step >> 13).clamp(3, 1 << 31));
        for divisor in (3..1 << 17)
            .chain(powers.filter(|&divisor| divisor > 2))
            .chain(spread)
        {
            let exact = ((1u64 << 33) / u64::from(divisor)).div_ceil(2);
            for quotient in [divided_out(divisor), multiplied_out(divisor)] {
                assert_eq!(u64::from(nearest(quotient, divisor)), exact, "1 / {divisor}");
            }
        }
    }

    /// Why a quotient is never more than one too small, whatever the dividend.
    ///
    /// It is the upper word of `dividend inverse`, so an inverse short by s makes it short by less than 1 + s n / 2^32, where
    /// n is the dividend as it is multiplied. It is cut to a whole number, so it is one less at most where s n / 2^32 is
    /// at most 1. Divisors below 2^17 ulp can be checked one by one, with the largest dividend whose quotient fits; for five of
    /// them the largest dividends exceed that 1 by 4e-4, and are checked one by one as well. Larger divisors shift the
    /// product right by one place or more, which halves what is short: there s may be 2.
    #[test]
    fn quotients_are_at_most_one_too_small() {
        for divisor in 1u32..1 << 17 {
            let shift = divisor.leading_zeros();
            let d = u128::from(divisor << shift);
            let short = u128::from(shortfall(divisor << shift));
            let largest = ((u64::from(divisor) << 15) - 1).min(1 << 31) as u32;
            // The least n for which s n / 2^32 exceeds 1.
            let critical = ((d << 32) / short + 1) >> (shift - 15);
            for dividend in critical.min(1 << 31) as u32..=largest {
                let exact = (u64::from(dividend) << 17) / u64::from(divisor);
                assert_eq!(
                    u64::from(quotient(dividend, divisor)),
                    exact.div_ceil(2),
                    "{dividend} / {divisor}"
                );
            }
        }
        for step in 0..1 << 22 {
            let d = 1 << 31 | step << 9 | step >> 13;
            assert!(shortfall(d) <= 2 * u64::from(d), "{d}");
        }
    }
}
