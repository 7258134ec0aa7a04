//! The exponential function.
//!
//! `e^x` is `2^(x log2 e)`: the whole part of the exponent is a shift, its next five bits choose from a table, and what is
//! left is below 1/32 and takes a cubic.

use fixed::types::I16F16;

/// The largest argument whose exponential fits, 16:16: ln 32768, rounded down.
const LARGEST: i32 = 681_391;
/// The smallest whose exponential is not rounded to 0, 16:16: ln 2^-17, rounded up.
const SMALLEST: i32 = -772_243;

/// 2^((i + 1/64) / 32) ... at the start of each 32nd of an octave, 1:31.
static POWERS: [u32; 32] = powers();

/// `e^x`: within 1.2 ulp. Saturates above ln 32768 = 10.397; below ln 2^-17 = -11.784 it is 0.
///
/// Cost: 34 instructions.
///
/// ```
/// use fixedmath::{exponential, I16F16};
/// assert_eq!(exponential::natural(I16F16::ZERO), I16F16::ONE);
/// assert_eq!(exponential::natural(I16F16::ONE), I16F16::from_bits(178_145));
/// assert_eq!(exponential::natural(I16F16::MAX), I16F16::MAX);
/// ```
#[doc(alias = "exp")]
#[inline]
pub const fn natural(x: I16F16) -> I16F16 {
    /// log2 e in 2:30, and what that is too large in 2^-41.
    const LOG2_E: i32 = 1_549_082_005;
    const EXCESS: i32 = 656;
    let x = x.to_bits();
    if x > LARGEST {
        return I16F16::MAX;
    }
    if x < SMALLEST {
        return I16F16::ZERO;
    }
    // x has 21 bits here; the exponent of 2 in 18:46.
    let exponent = x as i64 * LOG2_E as i64 - ((x * EXCESS) >> 11) as i64;
    let whole = (exponent >> 46) as i32;
    let fraction = (exponent >> 14) as u32;
    // 1:31, to be shifted right by 15 - whole, which is 1 to 32.
    let power = power(fraction);
    I16F16::from_bits((((power >> (14 - whole)) + 1) >> 1) as i32)
}

/// [`natural`], or `None` where that saturates.
pub const fn checked_natural(x: I16F16) -> Option<I16F16> {
    if x.to_bits() > LARGEST {
        None
    } else {
        Some(natural(x))
    }
}

/// 2^`fraction` in 1:31, for a fraction in 0:32.
#[inline]
const fn power(fraction: u32) -> u32 {
    // 2^(f / 32) - 1 for f in [0, 1) as a cubic without constant term, minimax to 2^-34, in 2^-37.
    const C: [u32; 3] = [2_977_044_705, 32_241_241, 235_237];
    let start = POWERS[(fraction >> 27) as usize];
    let f = fraction << 5;
    let growth = upper(C[0] + upper(C[1] + upper(C[2], f), f), f);
    start + (upper(start, growth) >> 5)
}

const fn upper(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// Each power is the root of the product of its neighbours, so they come by halving: 2, its root, the root of that.
const fn powers() -> [u32; 32] {
    let mut powers = [0; 32];
    // 2^(1/32) by five roots of 2, in 2:62.
    let mut step: u64 = 1 << 63;
    let mut round = 0;
    while round < 5 {
        step = root(step);
        round += 1;
    }
    let mut power: u64 = 1 << 62;
    let mut i = 0;
    while i < 32 {
        // Half an ulp more makes up for what multiplying by it cuts off.
        powers[i] = ((power + (1 << 31)) >> 31) as u32;
        power = ((power as u128 * step as u128) >> 62) as u64;
        i += 1;
    }
    powers
}

/// The root of 2:62, at compile time only.
const fn root(v: u64) -> u64 {
    let square = (v as u128) << 62;
    let (mut root, mut bit) = (0u128, 1u128 << 63);
    while bit != 0 {
        if (root | bit) * (root | bit) <= square {
            root |= bit;
        }
        bit >>= 1;
    }
    root as u64
}
