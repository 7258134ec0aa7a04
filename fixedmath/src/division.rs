//! Division of 16:16 numbers.

use fixed::types::I16F16;

/// `a / b` by restoring division, one bit a step, rounded towards zero: within 1 ulp.
///
/// The published algorithm: shift a bit of the dividend into the remainder, take the divisor away where it fits, note a
/// one. A quotient that does not fit saturates; a zero divisor gives the end of the range on the dividend's side, and
/// 0 / 0 is 0.
///
/// ```
/// use fixedmath::{division, I16F16};
/// let (one, three) = (I16F16::from_num(1), I16F16::from_num(3));
/// assert_eq!(division::restoring(one, three), I16F16::from_bits(21845));
/// assert_eq!(division::restoring(one, I16F16::ZERO), I16F16::MAX);
/// ```
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
