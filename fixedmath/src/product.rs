//! Products with one rounding, and dot products summed in 64 bits.
//!
//! A 32-bit product is one `SMULL` on an ARMv5TE core whatever its binary point, so the formats differ only in the
//! shift that follows. A direction's component kept in 2:30 therefore costs no more than one in 16:16 and carries 14
//! more bits.

use fixed::types::{I2F30, I16F16, I32F32};

const fn wide(a: i32, b: i32) -> i64 {
    a as i64 * b as i64
}

/// Drops `SHIFT` bits of a product, rounding halves up. No product of two `i32` comes near the `i64` limits.
const fn rounded<const SHIFT: u32>(product: i64) -> i64 {
    (product + (1 << (SHIFT - 1))) >> SHIFT
}

const fn saturated(value: i64) -> i32 {
    if value > i32::MAX as i64 {
        i32::MAX
    } else if value < i32::MIN as i64 {
        i32::MIN
    } else {
        value as i32
    }
}

/// `a b` rounded down, the published multiply: within 1 ulp below. Saturates.
pub const fn truncated(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits(saturated(wide(a.to_bits(), b.to_bits()) >> 16))
}

/// `a b` to the nearest, halves up: within 0.5 ulp. Saturates.
///
/// ```
/// use fixedmath::{product, I16F16};
/// let third = I16F16::from_bits(21845);
/// assert_eq!(product::nearest(third, third), I16F16::from_bits(7282));
/// assert_eq!(product::nearest(I16F16::MAX, I16F16::MAX), I16F16::MAX);
/// ```
pub const fn nearest(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits(saturated(rounded::<16>(wide(a.to_bits(), b.to_bits()))))
}

/// A length times a direction's component, to the nearest, halves up: within 0.5 ulp. Saturates, which only a
/// component outside [-1, 1] can bring about.
pub const fn scaled(length: I16F16, component: I2F30) -> I16F16 {
    I16F16::from_bits(saturated(rounded::<30>(wide(
        length.to_bits(),
        component.to_bits(),
    ))))
}

/// A product of two direction components, to the nearest, halves up: within 0.5 ulp. Saturates, which only components
/// outside [-1, 1] can bring about.
pub const fn of_units(a: I2F30, b: I2F30) -> I2F30 {
    I2F30::from_bits(saturated(rounded::<30>(wide(a.to_bits(), b.to_bits()))))
}

/// The dot product of two 16:16 vectors in 32:32: exact, or saturated where the sum leaves the format.
///
/// ```
/// use fixedmath::{product, I16F16, I32F32};
/// let ulp = I16F16::from_bits(1);
/// let v = [I16F16::from_num(3), I16F16::from_num(4), ulp];
/// assert_eq!(product::dot(v, v), I32F32::from_num(25) + I32F32::from_bits(1));
/// ```
pub const fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
    let x = wide(a[0].to_bits(), b[0].to_bits());
    let y = wide(a[1].to_bits(), b[1].to_bits());
    let z = wide(a[2].to_bits(), b[2].to_bits());
    // Two products of magnitude at most 2^62 sum to at most 2^63, which is one too many.
    I32F32::from_bits(x.saturating_add(y).saturating_add(z))
}

/// The dot product of two 16:16 vectors modulo 2^64 ulp of 32:32, for sums whose last step is known to fit.
///
/// Exact while the components stay below 26,754 in magnitude.
pub const fn wrapping_dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
    let x = wide(a[0].to_bits(), b[0].to_bits());
    let y = wide(a[1].to_bits(), b[1].to_bits());
    let z = wide(a[2].to_bits(), b[2].to_bits());
    I32F32::from_bits(x.wrapping_add(y).wrapping_add(z))
}
