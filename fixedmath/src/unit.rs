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
    let (normal, shift) = root::normalised(square);
    let inverse = root::reciprocal((normal >> 32) as u32) as i32;
    // No component exceeds the length, which is below 2^(32 - shift): brought up to 31 bits they lose nothing.
    let [x, y, z] = if shift == 0 {
        [x >> 1, y >> 1, z >> 1]
    } else {
        [x << (shift - 1), y << (shift - 1), z << (shift - 1)]
    };
    Some([
        stretched(x, inverse),
        stretched(y, inverse),
        stretched(z, inverse),
    ])
}

/// `component inverse` in 2:30 for a component in 1:31 and an inverse in 2:30.
const fn stretched(component: i32, inverse: i32) -> I2F30 {
    I2F30::from_bits(((component as i64 * inverse as i64 + (1 << 30)) >> 31) as i32)
}

/// A vector whose length is 1 + e brought to length 1 - 3/2 e^2 - 1/2 e^3: one Newton step, no root.
///
/// For directions that rounding has moved off the sphere. The step shortens what is longer than sqrt(3) to nothing: such
/// a vector gives 0.
#[inline]
pub const fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
    let [x, y, z] = [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()];
    let square = (x as i64 * x as i64) as u64 + (y as i64 * y as i64) as u64 + (z as i64 * z as i64) as u64;
    // (3 - |v|^2) / 2 in 2:30; the upper word alone tells whether that is negative.
    let factor = if (square >> 32) as u32 >= 3 << 28 {
        0
    } else {
        (((3 << 60) - square) >> 31) as i32
    };
    [corrected(x, factor), corrected(y, factor), corrected(z, factor)]
}

const fn corrected(component: i32, factor: i32) -> I2F30 {
    I2F30::from_bits(((component as i64 * factor as i64 + (1 << 29)) >> 30) as i32)
}
