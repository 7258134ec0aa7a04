//! The published system's: 16:16 throughout, 64-bit intermediates kept to the root.

use fixedmath::I48F16;
use fixedmath::{I2F30, I16F16, angle, division, product, root};

use super::Numbers;

/// 16:16 for every quantity but sums of squares, which stay in 48:16 until the root.
#[derive(Clone, Copy, Debug)]
pub enum Published {}

const ONE: I16F16 = I16F16::ONE;

fn sum_of_products(a: [I16F16; 3], b: [I16F16; 3]) -> i64 {
    product::wrapping_dot(a, b).to_bits() >> 16
}

fn narrow(unit: I2F30) -> I16F16 {
    I16F16::from_bits(unit.to_bits() >> 14)
}

impl Numbers for Published {
    type Length = I16F16;
    type Unit = I16F16;
    type Square = I48F16;
    type Projection = I16F16;
    type Ratio = I16F16;
    type Weight = I16F16;
    /// 32:32.
    type Radiance = u64;
    /// The radius: the published system divides.
    type Reciprocal = I16F16;

    const NOTHING: I16F16 = I16F16::ZERO;
    const GRAZING: I16F16 = I16F16::ZERO;
    const FAR: I16F16 = I16F16::MAX;
    const ONE: I16F16 = ONE;
    const ZERO: I16F16 = I16F16::ZERO;
    const NO_SQUARE: I48F16 = I48F16::ZERO;
    const FULL: I16F16 = ONE;
    const DARK: u64 = 0;

    fn length(bits: i32) -> I16F16 {
        I16F16::from_bits(bits)
    }

    fn unit(bits: i32) -> I16F16 {
        narrow(I2F30::from_bits(bits))
    }

    fn square(bits: i64) -> I48F16 {
        I48F16::from_bits(bits >> 16)
    }

    fn ratio(bits: i32) -> I16F16 {
        I16F16::from_bits(bits >> 12)
    }

    fn ratio_squared(ratio: I16F16) -> I16F16 {
        product::truncated(ratio, ratio)
    }

    fn weight(bits: u32) -> I16F16 {
        // All ones stand for 1, so the reading rounds up.
        I16F16::from_bits(((u64::from(bits) + 0x8000) >> 16) as i32)
    }

    fn reciprocal(radius: i32, _mantissa: i32, _shift: u8) -> I16F16 {
        I16F16::from_bits(radius)
    }

    fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I48F16 {
        I48F16::from_bits(sum_of_products(a, b))
    }

    fn product(a: I16F16, b: I16F16) -> I48F16 {
        I48F16::from_bits((i64::from(a.to_bits()) * i64::from(b.to_bits())) >> 16)
    }

    fn root(square: I48F16) -> I16F16 {
        root::split(square)
    }

    fn project(v: [I16F16; 3], d: [I16F16; 3]) -> I16F16 {
        I16F16::from_bits(sum_of_products(v, d) as i32)
    }

    fn length_of(projection: I16F16) -> I16F16 {
        projection
    }

    fn squared(projection: I16F16) -> I48F16 {
        Self::product(projection, projection)
    }

    fn scale(l: I16F16, u: I16F16) -> I16F16 {
        product::truncated(l, u)
    }

    fn normal(p: [I16F16; 3], r: I16F16) -> [I16F16; 3] {
        p.map(|component| division::restoring(component, r))
    }

    fn cosine(a: [I16F16; 3], b: [I16F16; 3]) -> I16F16 {
        I16F16::from_bits(sum_of_products(a, b) as i32)
    }

    fn times(a: I16F16, b: I16F16) -> I16F16 {
        product::truncated(a, b)
    }

    fn normalised(v: [I16F16; 3], otherwise: [I16F16; 3]) -> [I16F16; 3] {
        let length = root::split(I48F16::from_bits(sum_of_products(v, v)));
        if length == I16F16::ZERO {
            return otherwise;
        }
        v.map(|component| division::restoring(component, length))
    }

    fn bisector(a: [I16F16; 3], b: [I16F16; 3], otherwise: [I16F16; 3]) -> [I16F16; 3] {
        Self::normalised(crate::vector::add(a, b), otherwise)
    }

    fn renormalised(v: [I16F16; 3]) -> [I16F16; 3] {
        Self::normalised(v, v)
    }

    fn cos_sin(turn: u32) -> (I16F16, I16F16) {
        (
            angle::parabolic_sine(turn.wrapping_add(1 << 30)),
            angle::parabolic_sine(turn),
        )
    }

    fn signed(fraction: u32) -> I16F16 {
        I16F16::from_bits((fraction ^ 1 << 31) as i32 >> 15)
    }

    fn root_of(fraction: u32) -> I16F16 {
        root::restoring(I16F16::from_bits((fraction >> 16) as i32))
    }

    fn complement(z: I16F16) -> I16F16 {
        root::restoring(ONE - product::truncated(z, z))
    }

    fn below(fraction: u32, probability: I16F16) -> bool {
        ((fraction >> 16) as i32) < probability.to_bits()
    }

    fn refracted_square(cosine: I16F16, ratio_squared: I16F16) -> I16F16 {
        ONE - product::truncated(ratio_squared, ONE - product::truncated(cosine, cosine))
    }

    fn is_refracted(square: I16F16) -> bool {
        square >= I16F16::ZERO
    }

    fn root_of_ratio(square: I16F16) -> I16F16 {
        root::restoring(square)
    }

    fn refract(
        ratio: I16F16,
        d: [I16F16; 3],
        cosine: I16F16,
        refracted: I16F16,
        n: [I16F16; 3],
    ) -> [I16F16; 3] {
        let bend = product::truncated(ratio, cosine) - refracted;
        let component = |i: usize| product::truncated(ratio, d[i]) + product::truncated(bend, n[i]);
        [component(0), component(1), component(2)]
    }

    fn across(k: u32, jitter: I16F16, subpixels: u32, _reciprocal: u64) -> I16F16 {
        // Sub-pixel indices stay below 2^15 up to 16,384 pixels, as far as 16:16 can count them.
        let place = I16F16::from_bits((k as i32) << 16) + I16F16::from_bits(1 << 15) + jitter;
        division::restoring(place, I16F16::from_bits((subpixels as i32) << 16)) - I16F16::from_bits(1 << 15)
    }

    fn combine(
        forward: [I16F16; 3],
        a: I16F16,
        right: [I16F16; 3],
        b: I16F16,
        up: [I16F16; 3],
    ) -> [I16F16; 3] {
        let component =
            |i: usize| forward[i] + product::truncated(right[i], a) + product::truncated(up[i], b);
        [component(0), component(1), component(2)]
    }

    fn attenuate(throughput: I16F16, reflectance: I16F16) -> I16F16 {
        product::truncated(throughput, reflectance)
    }

    fn emitted(throughput: I16F16, emission: u32) -> u64 {
        // Negative only where 16:16 has gone wrong; there is no negative light.
        throughput.to_bits().max(0) as u64 * u64::from(emission)
    }

    fn radiance_bits(sum: u64) -> u64 {
        sum
    }
}
