//! Ours: lengths in 16:16, directions in 2:30, squares in 32:32.

use fixedmath::{I2F30, I16F16, I32F32, angle, product, root, unit, warp};

use super::Numbers;

/// Each quantity in the format that fits it. A 32-bit product is one `SMULL` wherever its binary point is, so this costs
/// what 16:16 throughout would.
#[derive(Clone, Copy, Debug)]
pub enum Mixed {}

/// 1 / r as `mantissa` 2^(shift - 46): a point of the sphere shifted left by `shift` and multiplied has no more than 62 bits.
#[derive(Clone, Copy, Debug)]
pub struct Reciprocal {
    mantissa: i32,
    shift: u8,
}

/// 1 as a product of two direction components, 4:60.
const ONE_SQUARED: u64 = 1 << 60;

fn bits(v: [I2F30; 3]) -> [i64; 3] {
    [
        v[0].to_bits().into(),
        v[1].to_bits().into(),
        v[2].to_bits().into(),
    ]
}

fn upper(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

impl Numbers for Mixed {
    type Length = I16F16;
    type Unit = I2F30;
    type Square = I32F32;
    /// 18:46, exact.
    type Projection = i64;
    /// 4:28 in 64 bits: a ratio of 4 squared, taken from 1, still fits with room.
    type Ratio = i64;
    /// 0:32, where all ones stand for 1.
    type Weight = u32;
    /// 32:32.
    type Radiance = u64;
    type Reciprocal = Reciprocal;

    const NOTHING: I16F16 = I16F16::ZERO;
    /// 3 ulp: 1 of the projection's cut, 1/2 of the root, and 0.87 where the three components are rounded.
    const GRAZING: I16F16 = I16F16::from_bits(3);
    /// 2^16 / 3, twice the longest radius.
    const FAR: I16F16 = I16F16::from_bits(0x5555_5555);
    const ONE: I2F30 = I2F30::ONE;
    const ZERO: I2F30 = I2F30::ZERO;
    const NO_SQUARE: I32F32 = I32F32::ZERO;
    const FULL: u32 = u32::MAX;
    const DARK: u64 = 0;

    fn length(bits: i32) -> I16F16 {
        I16F16::from_bits(bits)
    }

    fn unit(bits: i32) -> I2F30 {
        I2F30::from_bits(bits)
    }

    fn square(bits: i64) -> I32F32 {
        I32F32::from_bits(bits)
    }

    fn ratio(bits: i32) -> i64 {
        bits.into()
    }

    fn ratio_squared(ratio: i64) -> i64 {
        (ratio * ratio) >> 28
    }

    fn weight(bits: u32) -> u32 {
        bits
    }

    fn reciprocal(_radius: i32, mantissa: i32, shift: u8) -> Reciprocal {
        Reciprocal { mantissa, shift }
    }

    #[inline]
    fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
        product::wrapping_dot(a, b)
    }

    #[inline]
    fn product(a: I16F16, b: I16F16) -> I32F32 {
        I32F32::from_bits(i64::from(a.to_bits()) * i64::from(b.to_bits()))
    }

    #[inline]
    fn root(square: I32F32) -> I16F16 {
        root::of_square(square)
    }

    #[inline]
    fn project(v: [I16F16; 3], d: [I2F30; 3]) -> i64 {
        let [x, y, z] = bits(d);
        i64::from(v[0].to_bits()) * x + i64::from(v[1].to_bits()) * y + i64::from(v[2].to_bits()) * z
    }

    #[inline]
    fn length_of(projection: i64) -> I16F16 {
        I16F16::from_bits((projection >> 30) as i32)
    }

    #[inline]
    fn squared(projection: i64) -> I32F32 {
        // The square of 32:32 a half at a time: a projection is a length, so its whole part has 15 bits.
        let fine = projection.unsigned_abs() >> 14;
        let (whole, part) = ((fine >> 32) as u32, fine as u32);
        let cross = 2 * u64::from(whole) * u64::from(part);
        let square = (u64::from(whole * whole) << 32) + cross + u64::from(upper(part, part));
        I32F32::from_bits(square as i64)
    }

    #[inline]
    fn scale(l: I16F16, u: I2F30) -> I16F16 {
        product::wrapping_scaled(l, u)
    }

    #[inline]
    fn normal(p: [I16F16; 3], r: Reciprocal) -> [I2F30; 3] {
        let component = |p: I16F16| {
            let shifted = p.to_bits() << r.shift;
            I2F30::from_bits(((i64::from(shifted) * i64::from(r.mantissa)) >> 30) as i32)
        };
        unit::renormalised([component(p[0]), component(p[1]), component(p[2])])
    }

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
    fn bisector(a: [I2F30; 3], b: [I2F30; 3], otherwise: [I2F30; 3]) -> [I2F30; 3] {
        unit::checked_bisector(a, b).unwrap_or(otherwise)
    }

    #[inline]
    fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
        unit::renormalised(v)
    }

    #[inline]
    fn cos_sin(turn: u32) -> (I2F30, I2F30) {
        angle::cos_sin(turn)
    }

    #[inline]
    fn signed(fraction: u32) -> I2F30 {
        I2F30::from_bits((fraction ^ 1 << 31) as i32 >> 1)
    }

    #[inline]
    fn root_of(fraction: u32) -> I2F30 {
        // The root of a 0:32 fraction shifted to 0:60 has 30 bits.
        I2F30::from_bits(root::nearest(u64::from(fraction) << 28) as i32)
    }

    #[inline]
    fn complement(z: I2F30) -> I2F30 {
        let z = i64::from(z.to_bits());
        I2F30::from_bits(root::nearest(ONE_SQUARED.saturating_sub((z * z) as u64)) as i32)
    }

    #[inline]
    fn tent(fraction: u32) -> I2F30 {
        warp::tent(fraction)
    }

    #[inline]
    fn sphere(height: u32, turn: u32) -> [I2F30; 3] {
        warp::sphere(height, turn)
    }

    #[inline]
    fn below(fraction: u32, probability: I2F30) -> bool {
        ((fraction >> 2) as i32) < probability.to_bits()
    }

    #[inline]
    fn refracted_square(cosine: I2F30, ratio_squared: i64) -> i64 {
        let c = i64::from(cosine.to_bits());
        let sine_squared = (ONE_SQUARED as i64 - c * c) >> 30;
        (1 << 28) - ((ratio_squared * sine_squared) >> 30)
    }

    #[inline]
    fn is_refracted(square: i64) -> bool {
        square >= 0
    }

    #[inline]
    fn root_of_ratio(square: i64) -> I2F30 {
        // 4:28 to 4:60, whose root has 30 bits.
        I2F30::from_bits(root::nearest((square as u64) << 32) as i32)
    }

    #[inline]
    fn refract(ratio: i64, d: [I2F30; 3], cosine: I2F30, refracted: I2F30, n: [I2F30; 3]) -> [I2F30; 3] {
        let ratio = ratio as i32;
        let bend =
            ((i64::from(ratio) * i64::from(cosine.to_bits())) >> 30) as i32 - (refracted.to_bits() >> 2);
        let component = |d: I2F30, n: I2F30| {
            let sum = i64::from(ratio) * i64::from(d.to_bits()) + i64::from(bend) * i64::from(n.to_bits());
            I2F30::from_bits(((sum + (1 << 27)) >> 28) as i32)
        };
        [
            component(d[0], n[0]),
            component(d[1], n[1]),
            component(d[2], n[2]),
        ]
    }

    #[inline]
    fn across(k: u32, jitter: I2F30, subpixels: u32, reciprocal: u64) -> I2F30 {
        let _ = subpixels;
        // (2 k + 1) / (2 subpixels) in 2:30, then the jitter's share of a sub-pixel.
        let centre = ((u64::from(2 * k + 1) * reciprocal) >> 16) as i32;
        let offset = (i64::from(jitter.to_bits()) * (reciprocal >> 15) as i64) >> 30;
        I2F30::from_bits(centre - (1 << 29) + offset as i32)
    }

    #[inline]
    fn combine(forward: [I2F30; 3], a: I2F30, right: [I2F30; 3], b: I2F30, up: [I2F30; 3]) -> [I2F30; 3] {
        let (a, b) = (i64::from(a.to_bits()), i64::from(b.to_bits()));
        let component = |i: usize| {
            let sum = i64::from(right[i].to_bits()) * a + i64::from(up[i].to_bits()) * b;
            I2F30::from_bits(forward[i].to_bits() + ((sum + (1 << 29)) >> 30) as i32)
        };
        [component(0), component(1), component(2)]
    }

    #[inline]
    fn attenuate(throughput: u32, reflectance: u32) -> u32 {
        upper(throughput, reflectance)
    }

    #[inline]
    fn emitted(throughput: u32, emission: u32) -> u64 {
        (u64::from(throughput) * u64::from(emission)) >> 16
    }

    #[inline]
    fn radiance_bits(sum: u64) -> u64 {
        sum
    }
}
