//! Lengths of vectors, and directions: vectors of unit length in 2:30.

use fixed::types::{I2F30, I16F16};

use crate::{assembly, division, root};

/// A vector's squared length in 64 bits. Three squares of 2^62 fit without a sign.
#[inline]
const fn square(v: [i32; 3]) -> u64 {
    let [x, y, z] = [v[0] as i64, v[1] as i64, v[2] as i64];
    (x * x) as u64 + (y * y) as u64 + (z * z) as u64
}

const fn length_bits(v: [I16F16; 3]) -> [i32; 3] {
    [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()]
}

const fn unit_bits(v: [I2F30; 3]) -> [i32; 3] {
    [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()]
}

/// The length of a 16:16 vector, to the nearest: within 0.5 ulp. Saturates.
///
/// Cost: 62 instructions.
///
/// ```
/// use fixedmath::{unit, I16F16};
/// let v = [3, -4, 12].map(I16F16::from_num);
/// assert_eq!(unit::length(v), I16F16::from_num(13));
/// assert_eq!(unit::length([I16F16::MIN; 3]), I16F16::MAX);
/// ```
#[doc(alias("norm", "magnitude"))]
#[inline]
pub const fn length(v: [I16F16; 3]) -> I16F16 {
    let root = root::nearest(square(length_bits(v)));
    I16F16::from_bits(if root > i32::MAX as u32 {
        i32::MAX
    } else {
        root as i32
    })
}

/// [`length`], or `None` where it does not fit.
pub const fn checked_length(v: [I16F16; 3]) -> Option<I16F16> {
    let root = root::nearest(square(length_bits(v)));
    if root > i32::MAX as u32 {
        None
    } else {
        Some(I16F16::from_bits(root as i32))
    }
}

/// The direction of a 16:16 vector: each component within 4 ulp of 2^-30, the length within 2^-28 of 1, for every vector
/// but zero, which gives zero.
///
/// Cost: 51 instructions.
///
/// ```
/// use fixedmath::{unit, I2F30, I16F16};
/// let ulp = I16F16::from_bits(1);
/// let n = unit::of_vector([ulp, I16F16::ZERO, -ulp]);
/// assert!((n[0].to_num::<f64>() - 0.5f64.sqrt()).abs() < 3e-9);
/// assert_eq!(unit::of_vector([I16F16::ZERO; 3]), [I2F30::ZERO; 3]);
/// ```
#[doc(alias = "normalize")]
#[inline]
pub fn of_vector(v: [I16F16; 3]) -> [I2F30; 3] {
    direction(length_bits(v), square(length_bits(v)))
}

/// [`of_vector`], or `None` for zero.
pub fn checked_of_vector(v: [I16F16; 3]) -> Option<[I2F30; 3]> {
    match square(length_bits(v)) {
        0 => None,
        square => Some(direction(length_bits(v), square)),
    }
}

/// `v` brought to unit length: each component within 4 ulp of 2^-30. Zero gives zero.
///
/// Components may have any magnitude the format holds; the longest vector has length sqrt(12).
///
/// Cost: 51 instructions.
///
/// ```
/// use fixedmath::{unit, I2F30};
/// let v = [3, 0, -4].map(|x| I2F30::from_bits(x << 20));
/// let n = unit::normalised(v);
/// assert!((n[0].to_num::<f64>() - 0.6).abs() < 3e-9 && (n[2].to_num::<f64>() + 0.8).abs() < 3e-9);
/// ```
#[doc(alias = "normalize")]
#[inline]
pub fn normalised(v: [I2F30; 3]) -> [I2F30; 3] {
    direction(unit_bits(v), square(unit_bits(v)))
}

/// [`normalised`], or `None` for a vector shorter than 2^-15, whose direction is mostly rounding.
#[inline]
pub fn checked_normalised(v: [I2F30; 3]) -> Option<[I2F30; 3]> {
    let square = square(unit_bits(v));
    if square < 1 << 30 {
        return None;
    }
    Some(direction(unit_bits(v), square))
}

/// The direction halfway between two unit vectors: half their sum brought to unit length, each component within 4 ulp of
/// 2^-30, or `None` where they are opposite to within 2^-14.
#[inline]
pub fn checked_bisector(a: [I2F30; 3], b: [I2F30; 3]) -> Option<[I2F30; 3]> {
    // a + b may be 2, which 2:30 does not hold.
    let half = |i: usize| I2F30::from_bits((a[i].to_bits() >> 1) + (b[i].to_bits() >> 1));
    checked_normalised([half(0), half(1), half(2)])
}

/// `v` over its length, the root of `square`.
#[inline]
fn direction(v: [i32; 3], square: u64) -> [I2F30; 3] {
    if square == 0 {
        return [I2F30::ZERO; 3];
    }
    let (normal, shift) = root::normalised(square);
    let inverse = root::reciprocal((normal >> 32) as u32) as i32;
    // No component exceeds the length, which is below 2^(32 - shift): brought up to 31 bits they lose nothing.
    let [x, y, z] = if shift == 0 {
        [v[0] >> 1, v[1] >> 1, v[2] >> 1]
    } else {
        [v[0] << (shift - 1), v[1] << (shift - 1), v[2] << (shift - 1)]
    };
    [
        stretched(x, inverse),
        stretched(y, inverse),
        stretched(z, inverse),
    ]
}

/// `component inverse` in 2:30 for a component in 1:31 and an inverse in 2:30.
fn stretched(component: i32, inverse: i32) -> I2F30 {
    I2F30::from_bits(assembly::rounded::<31>(component as i64 * inverse as i64))
}

/// The unit vector that lies to `axis` as `v` does to (0, 0, 1), or to its opposite in a mirrored frame: for a `v` whose distribution is
/// even around that axis. Each component within 4 ulp of 2^-30.
///
/// T. Duff et al., "Building an Orthonormal Basis, Revisited", 2017, with both tangents turned by the sign of z.
///
/// Cost: 55 instructions.
#[inline]
pub fn around(axis: [I2F30; 3], v: [I2F30; 3]) -> [I2F30; 3] {
    let ([x, y, z], [u, v, w]) = (unit_bits(axis), unit_bits(v));
    let product = |a: i32, b: i32| a as i64 * b as i64;
    let across = assembly::rounded::<30>(product(x, u) + product(y, v));
    // 1 / (1 + |z|) in 1:31. Rounding may have left |z| at 1 or above.
    let height = ONE.saturating_add(z.unsigned_abs() as i32) as u32;
    let inverse = (division::reciprocal_of_normal(height << 1) >> 1) as i32;
    let along = w - assembly::rounded::<31>(product(across, inverse));
    let sign = z >> 31;
    [
        I2F30::from_bits(u + assembly::rounded::<30>(product(x, along))),
        I2F30::from_bits(v + assembly::rounded::<30>(product(y, along))),
        I2F30::from_bits(assembly::rounded::<30>(product(z, w)) - ((across ^ sign) - sign)),
    ]
}

/// 1 in 2:30.
const ONE: i32 = 1 << 30;

/// The squared length from which on [`renormalised`] gives zero: 3, in 4:60.
const NOTHING_LEFT: u64 = 3 << 60;

/// A vector whose length is 1 + e brought to length 1 - 3/2 e^2 - 1/2 e^3: one Newton step, no root.
///
/// For directions that rounding has moved off the sphere. The step shortens what is longer than sqrt(3) to nothing: such
/// a vector gives 0.
///
/// Cost: 18 instructions.
#[doc(alias = "normalize")]
#[inline]
pub fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
    let square = square(unit_bits(v));
    // (3 - |v|^2) / 2 in 2:30; the upper word alone tells whether that is negative.
    let factor = if (square >> 32) as u32 >= (NOTHING_LEFT >> 32) as u32 {
        0
    } else {
        // To the nearest: cut, it would leave vectors short by half an ulp in the mean.
        ((NOTHING_LEFT + (1 << 30) - square) >> 31) as i32
    };
    [
        corrected(v[0], factor),
        corrected(v[1], factor),
        corrected(v[2], factor),
    ]
}

/// [`renormalised`], or `None` for zero and for lengths of sqrt(3) and more, which have no direction left.
pub fn checked_renormalised(v: [I2F30; 3]) -> Option<[I2F30; 3]> {
    match square(unit_bits(v)) {
        1..NOTHING_LEFT => Some(renormalised(v)),
        _ => None,
    }
}

fn corrected(component: I2F30, factor: i32) -> I2F30 {
    I2F30::from_bits(assembly::rounded::<30>(
        component.to_bits() as i64 * factor as i64,
    ))
}
