//! Directions: vectors of unit length in 2:30.

use fixed::types::I2F30;

use crate::root;

/// `v` brought to unit length: each component within 3 ulp of 2^-30. `None` for a vector shorter than 2^-15, whose
/// direction is mostly rounding.
///
/// Components may have any magnitude the format holds; the longest vector has length sqrt(12).
///
/// ```
/// use fixedmath::{unit, I2F30};
/// let v = [3, 0, -4].map(|x| I2F30::from_bits(x << 20));
/// let n = unit::normalised(v).unwrap();
/// assert!((n[0].to_num::<f64>() - 0.6).abs() < 3e-9 && (n[2].to_num::<f64>() + 0.8).abs() < 3e-9);
/// ```
#[inline]
pub const fn normalised(v: [I2F30; 3]) -> Option<[I2F30; 3]> {
    let [x, y, z] = [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()];
    // 4:60, at most 12 * 2^60: unsigned, it fits.
    let square = (x as i64 * x as i64) as u64 + (y as i64 * y as i64) as u64 + (z as i64 * z as i64) as u64;
    if square < 1 << 30 {
        return None;
    }
    let shift = square.leading_zeros() / 2;
    let inverse = root::reciprocal((square << (2 * shift) >> 32) as u32);
    Some([
        stretched(x, shift, inverse),
        stretched(y, shift, inverse),
        stretched(z, shift, inverse),
    ])
}

/// `component / length` in 2:30 for a length of `2^(32 - shift) / inverse` (1:31), to the nearest.
const fn stretched(component: i32, shift: u32, inverse: u32) -> I2F30 {
    // |component| <= length < 2^(32 - shift) in bits, so the shifted component stays below 2^32.
    let product = ((component as i64) << shift >> 1) * (inverse as i64);
    I2F30::from_bits(((product + (1 << 31)) >> 32) as i32)
}

/// A vector whose length is 1 + e brought to length 1 - 3/2 e^2: one Newton step, no root.
///
/// For directions that rounding has moved off the sphere; e must lie within 2^-3 of 0, and components within [-1.25, 1.25].
#[inline]
pub const fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
    let [x, y, z] = [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()];
    let square = (x as i64 * x as i64)
        .wrapping_add(y as i64 * y as i64)
        .wrapping_add(z as i64 * z as i64);
    // (3 - |v|^2) / 2 in 2:30.
    let factor = ((3i64 << 60).wrapping_sub(square) >> 31) as i32;
    [corrected(x, factor), corrected(y, factor), corrected(z, factor)]
}

const fn corrected(component: i32, factor: i32) -> I2F30 {
    I2F30::from_bits(((component as i64 * factor as i64 + (1 << 29)) >> 30) as i32)
}
