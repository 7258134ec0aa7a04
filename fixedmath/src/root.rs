//! Square roots.
//!
//! The published roots work a bit at a time: [`restoring`] in 16:16, and [`split`] for 48:16 by
//! `sqrt(x y) = sqrt(x) sqrt(y)` with `y` a power of four, which keeps as many significant bits of the argument as 16:16
//! has room for and no more.
//!
//! Ours shift the argument until it fills its word and read a reciprocal root off a line, to 2^-10. From there one step of
//! third order leads to 2^-28: the root of 16:16 ([`of_length`]) is then mended by its remainder, which is exact in
//! integers, and correctly rounded; the reciprocal root ([`reciprocal_of_length`]) is rounded as it is. Roots of 64 bits
//! ([`of_square`], [`of_wide`], [`of_fraction`]) take a Newton step to 2^-19, one by their remainder, and are mended to
//! the last bit.

use fixed::types::{I2F30, I16F16, I32F32, I48F16};

mod kernel;

use kernel::{fine, floor_of_normal, near, near_reciprocal, normal_word, root_from_below, rough};
pub(crate) use kernel::{normalised, reciprocal};

/// Square root of 16:16 by restoring steps, rounded down: within 1 ulp below. A negative argument gives 0.
///
/// Cost: 320 instructions.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::restoring(I16F16::from_num(2)), I16F16::from_bits(92681));
/// ```
#[doc(alias = "sqrt")]
pub const fn restoring(x: I16F16) -> I16F16 {
    if x.to_bits() < 0 {
        return I16F16::ZERO;
    }
    // Two argument bits a step come down into the remainder; 24 of the 48 bits of x * 2^16 are root bits.
    let mut argument = (x.to_bits() as u64) << 16;
    let (mut remainder, mut root) = (0u32, 0u32);
    let mut step = 0;
    while step < 24 {
        remainder = remainder << 2 | (argument >> 46) as u32 & 3;
        argument <<= 2;
        let trial = root << 2 | 1;
        root <<= 1;
        if remainder >= trial {
            remainder -= trial;
            root |= 1;
        }
        step += 1;
    }
    I16F16::from_bits(root as i32)
}

/// [`restoring`], or `None` for a negative argument.
pub const fn checked_restoring(x: I16F16) -> Option<I16F16> {
    if x.to_bits() < 0 { None } else { Some(restoring(x)) }
}

/// Square root of 48:16 by `sqrt(x) = 2^k sqrt(x / 4^k)`, the published way: within 1.01 * 2^k ulp below, k the
/// smallest that brings the argument into 16:16: one ulp of the small root, and what the shift cut off the argument.
///
/// A negative argument gives 0; a root past 32,767 saturates.
///
/// Cost: 354 instructions.
#[doc(alias = "sqrt")]
pub const fn split(x: I48F16) -> I16F16 {
    if x.to_bits() < 0 {
        return I16F16::ZERO;
    }
    let significant = 64 - x.to_bits().leading_zeros();
    let k = if significant > 31 {
        (significant - 31).div_ceil(2)
    } else {
        0
    };
    let root = (restoring(I16F16::from_bits((x.to_bits() >> (2 * k)) as i32)).to_bits() as i64) << k;
    I16F16::from_bits(if root > i32::MAX as i64 {
        i32::MAX
    } else {
        root as i32
    })
}

/// [`split`], or `None` for a negative argument, and from 2^30 on, where the root does not fit.
pub const fn checked_split(x: I48F16) -> Option<I16F16> {
    if x.to_bits() < 0 || x.to_bits() >> 46 != 0 {
        None
    } else {
        Some(split(x))
    }
}

/// The first 32:32 argument whose root is rounded to 32,768: (2^31 - 1/2)^2 is 2^62 - 2^31 + 1/4.
const UNFIT: i64 = (1 << 62) - (1 << 31) + 1;

/// Square root of a 32:32 square in 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0; a root past
/// 32,767 saturates.
///
/// Cost: 47 instructions.
///
/// ```
/// use fixedmath::{root, I16F16, I32F32};
/// assert_eq!(root::of_square(I32F32::from_num(100_000_000)), I16F16::from_num(10_000));
/// assert_eq!(root::of_square(-I32F32::ONE), I16F16::ZERO);
/// ```
#[doc(alias = "sqrt")]
#[inline]
pub const fn of_square(x: I32F32) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    if x.to_bits() >= UNFIT {
        return I16F16::MAX;
    }
    I16F16::from_bits(nearest(x.to_bits() as u64) as i32)
}

/// [`of_square`], or `None` for a negative argument, and for one whose root, rounded, does not fit.
pub const fn checked_of_square(x: I32F32) -> Option<I16F16> {
    if x.to_bits() < 0 || x.to_bits() >= UNFIT {
        None
    } else {
        Some(of_square(x))
    }
}

/// [`of_square`], quicker: within 1.2 ulp for squares from 2^11 to 2^28.
///
/// Cost: 54 instructions.
#[inline]
pub const fn near_square(x: I32F32) -> I16F16 {
    let whole = (x.to_bits() >> 32) as u32;
    if whole.wrapping_sub(1 << 11) < (1 << 28) - (1 << 11) {
        I16F16::from_bits(near(x.to_bits() as u64) as i32)
    } else {
        of_square_apart(x)
    }
}

/// Kept apart from what happens more often.
#[cold]
#[inline(never)]
const fn of_square_apart(x: I32F32) -> I16F16 {
    of_square(x)
}

/// Square root of 48:16 in 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0; a root past 32,767
/// saturates.
///
/// Cost: 45 instructions.
///
/// ```
/// use fixedmath::{root, I16F16, I48F16};
/// assert_eq!(root::of_wide(I48F16::from_num(1_000_000)), I16F16::from_num(1000));
/// assert_eq!(root::of_wide(I48F16::MAX), I16F16::MAX);
/// ```
#[doc(alias = "sqrt")]
#[inline]
pub const fn of_wide(x: I48F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    if x.to_bits() > UNFIT >> 16 {
        return I16F16::MAX;
    }
    I16F16::from_bits(nearest((x.to_bits() as u64) << 16) as i32)
}

/// [`of_wide`], or `None` for a negative argument, and for one whose root, rounded, does not fit.
pub const fn checked_of_wide(x: I48F16) -> Option<I16F16> {
    if x.to_bits() < 0 || x.to_bits() > UNFIT >> 16 {
        None
    } else {
        Some(of_wide(x))
    }
}

/// Square root of 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0.
///
/// Cost: 29 instructions.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::of_length(I16F16::from_num(2)), I16F16::from_bits(92682));
/// ```
#[doc(alias = "sqrt")]
#[inline]
pub const fn of_length(x: I16F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    let x = x.to_bits() as u32;
    let (normal, shift) = normal_word(x);
    let root = root_from_below(normal);
    // The root of x 2^16 has 24 bits at most; these are 30, less `shift`. Rounded from below it is the nearest, or one less
    // where it is next to half an ulp.
    let root = ((root >> (5 + shift)) + 1) >> 1;
    let remainder = (x << 16).wrapping_sub(root.wrapping_mul(root)) as i32;
    I16F16::from_bits(root as i32 + (remainder > root as i32) as i32)
}

/// [`of_length`], or `None` for a negative argument.
pub const fn checked_of_length(x: I16F16) -> Option<I16F16> {
    if x.to_bits() < 0 { None } else { Some(of_length(x)) }
}

/// `1 / sqrt(x)` of 16:16, to the nearest but for ties too close to tell: within 0.51 ulp. An argument of 0 or less gives
/// `MAX`.
///
/// Cost: 26 instructions.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::reciprocal_of_length(I16F16::from_num(4)), I16F16::from_num(0.5));
/// assert_eq!(root::reciprocal_of_length(I16F16::ZERO), I16F16::MAX);
/// ```
#[doc(alias("rsqrt", "inverse_sqrt"))]
#[inline]
pub const fn reciprocal_of_length(x: I16F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::MAX;
    }
    let (normal, shift) = normal_word(x.to_bits() as u32);
    let y = near_reciprocal(normal);
    // 2^(24 + shift) / sqrt(normal), of which y has 2^46.
    I16F16::from_bits((((y >> (21 - shift)) + 1) >> 1) as i32)
}

/// [`reciprocal_of_length`], or `None` for an argument of 0 or less.
pub const fn checked_reciprocal_of_length(x: I16F16) -> Option<I16F16> {
    if x.to_bits() <= 0 {
        None
    } else {
        Some(reciprocal_of_length(x))
    }
}

/// Square root of 2:30, to the nearest: within 0.5 ulp of 2^-30. A negative argument gives 0.
///
/// Cost: 51 instructions.
#[doc(alias = "sqrt")]
#[inline]
pub const fn of_fraction(x: I2F30) -> I2F30 {
    if x.to_bits() <= 0 {
        return I2F30::ZERO;
    }
    I2F30::from_bits(nearest((x.to_bits() as u64) << 30) as i32)
}

/// [`of_fraction`], or `None` for a negative argument.
pub const fn checked_of_fraction(x: I2F30) -> Option<I2F30> {
    if x.to_bits() < 0 {
        None
    } else {
        Some(of_fraction(x))
    }
}

/// Square root of a share in 0:32, not 0, in 2:30: within 4 ulp of 2^-30.
#[inline]
pub(crate) const fn of_share(share: u32) -> u32 {
    let (normal, shift) = normal_word(share);
    fine(normal) >> shift
}

/// Twice the square root of a share in 0:64, not 0 and below 1/4, in 2:30: within 8 ulp of 2^-30.
#[inline]
pub(crate) const fn of_wide_share(share: u64) -> u32 {
    let (normal, shift) = normalised(share);
    rough((normal >> 32) as u32) >> (shift - 1)
}

/// The integer nearest to the square root of `v`; `u32::MAX` where that is 2^32.
///
/// Cost: 51 instructions.
#[doc(alias("sqrt", "isqrt"))]
#[inline]
pub const fn nearest(v: u64) -> u32 {
    if v == 0 {
        return 0;
    }
    let (normal, shift) = normalised(v);
    let root = floor_of_normal(normal);
    if shift == 0 {
        let remainder = normal.wrapping_sub(root as u64 * root as u64);
        root.saturating_add((remainder > root as u64) as u32)
    } else {
        // The root of `normal` is floor(2^shift sqrt(v)): rounding it rounds the root itself.
        (root >> shift) + (root >> (shift - 1) & 1)
    }
}

/// [`nearest`], or `None` where that is 2^32.
pub const fn checked_nearest(v: u64) -> Option<u32> {
    // (2^32 - 1/2)^2 is 2^64 - 2^32 + 1/4.
    if v > 0xffff_ffff_0000_0000 {
        None
    } else {
        Some(nearest(v))
    }
}

/// The square root of `v`, rounded down.
///
/// Cost: 44 instructions.
#[doc(alias("sqrt", "isqrt"))]
#[inline]
pub const fn floor(v: u64) -> u32 {
    if v == 0 {
        return 0;
    }
    let (normal, shift) = normalised(v);
    floor_of_normal(normal) >> shift
}
