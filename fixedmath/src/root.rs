//! Square roots.
//!
//! The published roots work a bit at a time: [`restoring`] in 16:16, and [`split`] for 48:16 by
//! `sqrt(x y) = sqrt(x) sqrt(y)` with `y` a power of four, which keeps as many significant bits of the argument as 16:16
//! has room for and no more.
//!
//! Ours ([`of_square`], [`of_length`], [`of_fraction`]) are correctly rounded: the argument is
//! shifted until it fills 64 bits, a line from a 24-entry table gives its reciprocal root to 2^-10, one Newton step
//! to 2^-19, and the remainder of the root this gives, which is exact in integers, mends the root to its last bit.

use fixed::types::{I2F30, I16F16, I32F32, I48F16};

/// Square root of 16:16 by restoring steps, rounded down: within 1 ulp below. A negative argument gives 0.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::restoring(I16F16::from_num(2)), I16F16::from_bits(92681));
/// ```
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

/// Square root of 48:16 by `sqrt(x) = 2^k sqrt(x / 4^k)`, the published way: within 1.01 * 2^k ulp below, k the
/// smallest that brings the argument into 16:16: one ulp of the small root, and what the shift cut off the argument.
///
/// A negative argument gives 0; a root past 32,767 saturates.
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

/// Square root of a 32:32 square in 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0; a root past
/// 32,767 saturates.
///
/// ```
/// use fixedmath::{root, I16F16, I32F32};
/// assert_eq!(root::of_square(I32F32::from_num(100_000_000)), I16F16::from_num(10_000));
/// assert_eq!(root::of_square(-I32F32::ONE), I16F16::ZERO);
/// ```
#[inline]
pub const fn of_square(x: I32F32) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    let root = nearest(x.to_bits() as u64);
    I16F16::from_bits(if root > i32::MAX as u32 {
        i32::MAX
    } else {
        root as i32
    })
}

/// Square root of 48:16 in 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0; a root past 32,767
/// saturates.
///
/// ```
/// use fixedmath::{root, I16F16, I48F16};
/// assert_eq!(root::of_wide(I48F16::from_num(1_000_000)), I16F16::from_num(1000));
/// assert_eq!(root::of_wide(I48F16::MAX), I16F16::MAX);
/// ```
#[inline]
pub const fn of_wide(x: I48F16) -> I16F16 {
    let bits = x.to_bits();
    if bits <= 0 {
        return I16F16::ZERO;
    }
    if bits >> 46 != 0 {
        return I16F16::MAX;
    }
    I16F16::from_bits(nearest((bits as u64) << 16) as i32)
}

/// Square root of 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::of_length(I16F16::from_num(2)), I16F16::from_bits(92682));
/// ```
#[inline]
pub const fn of_length(x: I16F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    let x = x.to_bits() as u32;
    let (normal, shift) = normal_word(x);
    let y = line(normal);
    let root = upper(normal, y);
    let root = grown(root, upper(root, y), SHORT);
    // The root of x 2^16 has 24 bits at most; these are 30, less `shift`. Rounded from below it is the nearest, or one less
    // where it is next to half an ulp.
    let root = ((root >> (5 + shift)) + 1) >> 1;
    let remainder = (x << 16).wrapping_sub(root.wrapping_mul(root)) as i32;
    I16F16::from_bits(root as i32 + (remainder > root as i32) as i32)
}

/// `1 / sqrt(x)` of 16:16, to the nearest but for ties too close to tell: within 0.51 ulp. An argument of 0 or less gives
/// `MAX`.
///
/// ```
/// use fixedmath::{root, I16F16};
/// assert_eq!(root::reciprocal_of_length(I16F16::from_num(4)), I16F16::from_num(0.5));
/// assert_eq!(root::reciprocal_of_length(I16F16::ZERO), I16F16::MAX);
/// ```
#[inline]
pub const fn reciprocal_of_length(x: I16F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::MAX;
    }
    let (normal, shift) = normal_word(x.to_bits() as u32);
    let y = line(normal);
    let y = grown(y, upper(upper(normal, y), y), 0);
    // 2^(24 + shift) / sqrt(normal), of which y has 2^46.
    I16F16::from_bits((((y >> (21 - shift)) + 1) >> 1) as i32)
}

/// Square root of 2:30, to the nearest: within 0.5 ulp of 2^-30. A negative argument gives 0.
#[inline]
pub const fn of_fraction(x: I2F30) -> I2F30 {
    if x.to_bits() <= 0 {
        return I2F30::ZERO;
    }
    I2F30::from_bits(nearest((x.to_bits() as u64) << 30) as i32)
}

/// Square root of a share in 0:32, not 0, in 2:30: within 4 ulp of 2^-30.
#[inline]
pub(crate) const fn of_share(share: u32) -> u32 {
    let (normal, shift) = normal_word(share);
    rough(normal) >> shift
}

/// Twice the square root of a share in 0:64, not 0 and below 1/4, in 2:30: within 8 ulp of 2^-30.
#[inline]
pub(crate) const fn of_wide_share(share: u64) -> u32 {
    let (normal, shift) = normalised(share);
    rough((normal >> 32) as u32) >> (shift - 1)
}

/// The root of `x` 2^-32 in 2:30 for `x` >= 2^30, within 4 ulp.
#[inline]
const fn rough(x: u32) -> u32 {
    let y = line(x);
    let root = upper(x, y);
    grown(root, upper(root, y), 0)
}

/// The integer nearest to the square root of `v`; `u32::MAX` where that is 2^32.
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

/// The square root of `v`, rounded down.
#[inline]
pub const fn floor(v: u64) -> u32 {
    if v == 0 {
        return 0;
    }
    let (normal, shift) = normalised(v);
    floor_of_normal(normal) >> shift
}

/// `v` > 0 shifted left by the even number of places that brings it to 2^62 or more, and half that number.
#[inline]
pub(crate) const fn normalised(v: u64) -> (u64, u32) {
    let (upper, lower) = ((v >> 32) as u32, v as u32);
    if upper == 0 {
        // A shift by less than a word is four instructions, by any number of places nine.
        let places = lower.leading_zeros() & !1;
        return ((lower << places) as u64 * (1 << 32), places / 2 + 16);
    }
    let places = upper.leading_zeros() & !1;
    let upper = upper << places | (lower >> 1) >> (31 - places);
    ((upper as u64) << 32 | (lower << places) as u64, places / 2)
}

/// The root of `v` >= 2^62, rounded down.
#[inline]
const fn floor_of_normal(v: u64) -> u32 {
    let x = (v >> 32) as u32;
    let y = reciprocal_seed(x);
    let rough = upper(x, y) << 2;
    // A root off by e leaves a remainder of 2 root e, and y is 1 / root: |e| < 2^-19 here, so 50 of its bits matter.
    let remainder = v.wrapping_sub(rough as u64 * rough as u64) as i64;
    let mend = ((remainder >> 14) as i32 as i64 * y as i64) >> 49;
    let root = (rough as i32).wrapping_add(mend as i32) as u32;
    // What was cut off above leaves the root at most one off.
    let remainder = v.wrapping_sub(root as u64 * root as u64) as i64;
    if remainder < 0 {
        root - 1
    } else if remainder > 2 * root as i64 {
        root + 1
    } else {
        root
    }
}

/// `x` > 0 shifted left by the even number of places that brings it to 2^30 or more, and half that number.
#[inline]
const fn normal_word(x: u32) -> (u32, u32) {
    let shift = x.leading_zeros() / 2;
    (x << (2 * shift), shift)
}

/// Leaves a root some 2^-27 of itself short, more than its rounding can add; made to fit an `MVN`.
const SHORT: i32 = 0x3fc1;

/// `v` times the root of `1 / (1 - e)`, for `v` below 2^31 and `square` = 1 - e in 4:28, |e| < 2^-9: the step of third
/// order, `1 + e/2 + 3/8 e^2`, within 2^-28.
///
/// It turns a reciprocal root y of x, and likewise a root x y, into better ones when x y^2 is 1 - e. `short` in
/// 2^-40 is taken from e.
#[inline]
const fn grown(v: u32, square: u32, short: i32) -> u32 {
    // 2^28 - square in 2^-40, where the 1 has left the word.
    let e = (-short).wrapping_sub((square << 12) as i32);
    let squared = upper_signed(e, e);
    let growth = e + ((squared - (squared >> 2)) >> 8);
    v.wrapping_add_signed(upper_signed(v as i32, growth) >> 9)
}

/// The upper word of a product: one `SMULL`.
const fn upper_signed(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// The upper word of a product: one `UMULL`.
const fn upper(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, within 2^-10 of itself.
#[inline]
const fn line(x: u32) -> u32 {
    let [start, loss] = LINES[(x >> 27) as usize];
    start - upper(loss, x << 5)
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, from below, within 2^-19: a line, and one Newton step
/// `y (3 - x y^2) / 2`, which never overshoots.
#[inline]
const fn reciprocal_seed(x: u32) -> u32 {
    let y = line(x);
    // x y^2 is 1 - e in 4:28; what the two products cut off must not count as e, or y could reach 2 and the sign bit.
    let e = (1 << 28) - 2 - upper(upper(x, y), y) as i32;
    (y as i32 + ((y as i32 as i64 * (e << 3) as i64) >> 32) as i32) as u32
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, from below, within 2 ulp: below 2 even for x = 2^30.
#[inline]
pub(crate) const fn reciprocal(x: u32) -> u32 {
    let y = reciprocal_seed(x);
    // A second step, with the root in 1:31 and e in 64 bits.
    let root = ((x as u64 * y as u64) >> 31) + 1;
    let e = ((1 << 61) - (root as u32 as u64 * y as u64) as i64) >> 14;
    (y as i32 + ((y as i32 as i64 * e as i32 as i64) >> 48) as i32) as u32
}

/// Lines for `1 / sqrt(x)` in 2:30 between multiples of 1/32 of [1/4, 1): the value at the segment's start, and what it
/// loses along the segment. The first eight, below 1/4, are never read and spare the index its subtraction.
static LINES: [[u32; 2]; 32] = lines();

const fn lines() -> [[u32; 2]; 32] {
    let mut lines = [[0; 2]; 32];
    let mut segment = 8;
    while segment < 32 {
        // 2^30 / sqrt(i / 32) is the root of 2^65 / i: with 2^5 taken out of the root, which is that of 2^55 * 2^10 / i.
        let i = segment as u64;
        let start = slow_floor((1 << 63) / i) * 2;
        let end = slow_floor((1 << 63) / (i + 1)) * 2;
        let middle = slow_floor((1 << 63) / (2 * i + 1) * 2) * 2;
        // The chord lies above the curve: half its worst distance balances the error.
        let sag = start / 2 + end / 2 - middle;
        lines[segment] = [start - sag / 2, start - end];
        segment += 1;
    }
    lines
}

/// A root for the table, at compile time only.
const fn slow_floor(v: u64) -> u32 {
    let (mut root, mut bit) = (0u64, 1u64 << 31);
    while bit != 0 {
        if (root | bit) * (root | bit) <= v {
            root |= bit;
        }
        bit >>= 1;
    }
    root as u32
}
