//! The published system's: 16:16 throughout, 64-bit intermediates kept to the root.

use fixedmath::{I2F30, I16F16, I48F16, U0F32, angle, division, product, root};

use super::{Directions, Formats, Sampling};

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

    fn root_of(fraction: U0F32) -> I16F16 {
        root::restoring(I16F16::from_bits((fraction.to_bits() >> 16) as i32))
    }

    fn on_hemisphere(fraction: U0F32) -> Option<[I16F16; 3]> {
        let coordinate = |bits: u32| I16F16::from_bits(i32::from(bits as u16 as i16) << 1 | 1);
        let (u, v) = (
            coordinate(fraction.to_bits() >> 16),
            coordinate(fraction.to_bits()),
        );
        let square = product::truncated(u, u) + product::truncated(v, v);
        (square < Self::ONE).then(|| [u, v, root::restoring(Self::ONE - square)])
    }

    fn around(axis: [I16F16; 3], v: [I16F16; 3]) -> [I16F16; 3] {
        let ([x, y, z], [u, v, w]) = (axis, v);
        let across = product::truncated(x, u) + product::truncated(y, v);
        let along = w - division::restoring(across, Self::ONE + z.abs());
        let turned = if z < I16F16::ZERO { -across } else { across };
        [
            u + product::truncated(x, along),
            v + product::truncated(y, along),
            product::truncated(z, w) - turned,
        ]
    }

    fn below(fraction: U0F32, probability: I16F16) -> bool {
        ((fraction.to_bits() >> 16) as i32) < probability.to_bits()
    }
}
