//! The published system's: 16:16 throughout, 64-bit intermediates kept to the root.

use fixedmath::{I2F30, I16F16, I48F16, U0F32, angle, division, product, root};

use super::{Directions, Formats, Sampling, vector};

/// 16:16 for every quantity but sums of squares, which stay in 48:16 until the root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Published {}

impl Published {
    pub(crate) fn sum_of_products(a: [I16F16; 3], b: [I16F16; 3]) -> I48F16 {
        I48F16::from_bits(product::wrapping_dot(a, b).to_bits() >> 16)
    }
}

impl Formats for Published {
    type Length = I16F16;
    type Unit = I16F16;

    const NOTHING: I16F16 = I16F16::ZERO;
    const FAR: I16F16 = I16F16::MAX;
    const ZERO: I16F16 = I16F16::ZERO;
    const ONE: I16F16 = I16F16::ONE;

    fn length(length: I16F16) -> I16F16 {
        length
    }

    fn unit(component: I2F30) -> I16F16 {
        I16F16::from_bits(component.to_bits() >> 14)
    }

    fn scale(l: I16F16, u: I16F16) -> I16F16 {
        product::truncated(l, u)
    }
}

impl Directions for Published {
    fn cosine(a: [I16F16; 3], b: [I16F16; 3]) -> I16F16 {
        I16F16::from_bits(Self::sum_of_products(a, b).to_bits() as i32)
    }

    fn times(a: I16F16, b: I16F16) -> I16F16 {
        product::truncated(a, b)
    }

    fn normalised(v: [I16F16; 3], otherwise: [I16F16; 3]) -> [I16F16; 3] {
        let length = root::split(Self::sum_of_products(v, v));
        if length == I16F16::ZERO {
            return otherwise;
        }
        v.map(|component| division::restoring(component, length))
    }

    fn bisector(a: [I16F16; 3], b: [I16F16; 3], otherwise: [I16F16; 3]) -> [I16F16; 3] {
        Self::normalised(vector::add(a, b), otherwise)
    }

    fn renormalised(v: [I16F16; 3]) -> [I16F16; 3] {
        Self::normalised(v, v)
    }
}

impl Sampling for Published {
    fn cos_sin(turn: U0F32) -> (I16F16, I16F16) {
        (
            angle::parabolic_sine(turn.to_bits().wrapping_add(1 << 30)),
            angle::parabolic_sine(turn.to_bits()),
        )
    }

    fn signed(fraction: U0F32) -> I16F16 {
        I16F16::from_bits((fraction.to_bits() ^ 1 << 31) as i32 >> 15)
    }

    fn root_of(fraction: U0F32) -> I16F16 {
        root::restoring(I16F16::from_bits((fraction.to_bits() >> 16) as i32))
    }

    fn complement(z: I16F16) -> I16F16 {
        root::restoring(Self::ONE - product::truncated(z, z))
    }

    fn below(fraction: U0F32, probability: I16F16) -> bool {
        ((fraction.to_bits() >> 16) as i32) < probability.to_bits()
    }
}
