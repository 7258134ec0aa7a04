//! Square roots.
//!
//! The published roots work a bit at a time: [`restoring`] in 16:16, and [`split`] for 48:16 by
//! `sqrt(x y) = sqrt(x) sqrt(y)` with `y` a power of four, which keeps as many significant bits of the argument as 16:16
//! has room for and no more.
//!
//! Ours ([`of_square`], [`of_length`], [`of_fraction`]) are correctly rounded and take a third of the time: the argument
//! is shifted until it fills 64 bits, a line from a 48-entry table gives its reciprocal root to 2^-12, one Newton step
//! to 2^-24, and the remainder of the root this gives, which is exact in integers, mends the root to its last bit.

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

/// Square root of 16:16, to the nearest: within 0.5 ulp. A negative argument gives 0.
#[inline]
pub const fn of_length(x: I16F16) -> I16F16 {
    if x.to_bits() <= 0 {
        return I16F16::ZERO;
    }
    I16F16::from_bits(nearest((x.to_bits() as u64) << 16) as i32)
}

/// Square root of 2:30, to the nearest: within 0.5 ulp of 2^-30. A negative argument gives 0.
#[inline]
pub const fn of_fraction(x: I2F30) -> I2F30 {
    if x.to_bits() <= 0 {
        return I2F30::ZERO;
    }
    I2F30::from_bits(nearest((x.to_bits() as u64) << 30) as i32)
}

/// The integer nearest to the square root of `v`; `u32::MAX` where that is 2^32.
#[inline]
pub const fn nearest(v: u64) -> u32 {
    if v == 0 {
        return 0;
    }
    let shift = v.leading_zeros() / 2;
    let normal = v << (2 * shift);
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
    let shift = v.leading_zeros() / 2;
    floor_of_normal(v << (2 * shift)) >> shift
}

/// The root of `v` >= 2^62, rounded down.
#[inline]
const fn floor_of_normal(v: u64) -> u32 {
    let x = (v >> 32) as u32;
    let y = reciprocal_seed(x);
    let rough = upper_of(x, y, 31);
    // A root off by e leaves a remainder of 2 root e, and y is 1 / root: |e| < 2^9 ulp here, so 54 bits of it fit.
    let remainder = v.wrapping_sub(rough as u64 * rough as u64) as i64;
    let mend = ((remainder >> 10) as i32 as i64 * (y >> 1) as i64) >> 53;
    let root = (rough as i64 + mend) as u32;
    // Truncation above leaves the root at most one off.
    let remainder = v.wrapping_sub(root as u64 * root as u64) as i64;
    if remainder < 0 {
        root - 1
    } else if remainder > 2 * root as i64 {
        root + 1
    } else {
        root
    }
}

const fn upper_of(a: u32, b: u32, shift: u32) -> u32 {
    ((a as u64 * b as u64) >> shift) as u32
}

/// `1 / sqrt(x / 2^32)` in 1:31 for `x` >= 2^30, from below, within 2^-23.
#[inline]
pub(crate) const fn reciprocal_seed(x: u32) -> u32 {
    let line = LINES[(x >> 26) as usize - 16];
    let along = (x << 6) >> 16;
    let y = (line & 0x1_ffff) - (((line >> 17) * along) >> 16);
    // x y^2 is 1 - e: the wrap of 32 bits takes the 1 away.
    let root = upper_of(x, y, 16);
    let e = upper_of(root, y, 16).wrapping_neg() as i32;
    ((y << 15) as i32).wrapping_add((y as i32 * (e >> 7)) >> 11) as u32
}

/// `1 / sqrt(x / 2^32)` in 1:31 for `x` >= 2^30, from below, within 2 ulp of 2^-31.
#[inline]
pub(crate) const fn reciprocal(x: u32) -> u32 {
    let y = reciprocal_seed(x);
    let root = upper_of(x, y, 31);
    let e = upper_of(root, y, 31).wrapping_neg() as i32;
    (y as i32).wrapping_add(((y as i64 * e as i64) >> 33) as i32) as u32
}

/// Lines for `1 / sqrt(x)` on the 48 segments of [1/4, 1) between multiples of 1/64: the value at the segment's start in
/// the low 17 bits (1:16), what it loses along the segment in the upper 15.
static LINES: [u32; 48] = lines();

const fn lines() -> [u32; 48] {
    let mut lines = [0; 48];
    let mut segment = 0;
    while segment < 48 {
        // 2^16 / sqrt(i / 64) is the root of 2^38 / i.
        let i = segment as u64 + 16;
        let start = slow_floor((1 << 38) / i);
        let end = slow_floor((1 << 38) / (i + 1));
        let middle = slow_floor((1 << 39) / (2 * i + 1));
        // The chord lies above the curve: half its worst distance balances the error.
        let sag = (start + end) / 2 - middle;
        lines[segment] = (start - sag.div_ceil(2) - 1) | (start - end) << 17;
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
