//! Ours: lengths in 16:16, directions in 2:30, squares in 32:32.

use fixedmath::{I2F30, I16F16, U0F32, angle, product, root, unit, warp};

use super::{Directions, Formats, Sampling};

/// Each quantity in the format that fits it. A 32-bit product is one `SMULL` wherever its binary point is, so this costs
/// what 16:16 throughout would.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mixed {}

impl Formats for Mixed {
    type Length = I16F16;
    type Unit = I2F30;

    const NOTHING: I16F16 = I16F16::ZERO;
    /// 2^16 / 3, twice the longest radius.
    const FAR: I16F16 = I16F16::from_bits(0x5555_5555);
    const ZERO: I2F30 = I2F30::ZERO;
    const ONE: I2F30 = I2F30::ONE;

    #[inline]
    fn length(length: I16F16) -> I16F16 {
        length
    }

    #[inline]
    fn unit(component: I2F30) -> I2F30 {
        component
    }

    #[inline]
    fn scale(l: I16F16, u: I2F30) -> I16F16 {
        product::wrapping_scaled(l, u)
    }
}

impl Directions for Mixed {
    #[inline]
    fn cosine(a: [I2F30; 3], b: [I2F30; 3]) -> I2F30 {
        product::cosine(a, b)
    }

    #[inline]
    fn times(a: I2F30, b: I2F30) -> I2F30 {
        product::wrapping_of_units(a, b)
    }

    #[inline]
    fn normalised(v: [I2F30; 3], otherwise: [I2F30; 3]) -> [I2F30; 3] {
        unit::checked_normalised(v).unwrap_or(otherwise)
    }

    #[inline]
    fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
        unit::renormalised(v)
    }
}

impl Sampling for Mixed {
    #[inline]
    fn cos_sin(turn: U0F32) -> (I2F30, I2F30) {
        angle::cos_sin(turn.to_bits())
    }

    #[inline]
    fn root_of(fraction: U0F32) -> I2F30 {
        // The root of a 0:32 fraction shifted to 0:60 has 30 bits.
        I2F30::from_bits(root::nearest(u64::from(fraction.to_bits()) << 28) as i32)
    }

    #[inline]
    fn below(fraction: U0F32, probability: I2F30) -> bool {
        ((fraction.to_bits() >> 2) as i32) < probability.to_bits()
    }

    #[inline]
    fn tent(fraction: U0F32) -> I2F30 {
        warp::tent(fraction.to_bits())
    }

    #[inline]
    fn on_hemisphere(fraction: U0F32) -> Option<[I2F30; 3]> {
        warp::checked_hemisphere(fraction.to_bits())
    }

    #[inline]
    fn around(axis: [I2F30; 3], v: [I2F30; 3]) -> [I2F30; 3] {
        unit::around(axis, v)
    }
}
