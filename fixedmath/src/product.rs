//! Products with one rounding, and dot products summed in 64 bits.
//!
//! A 32-bit product is one `SMULL` on an ARMv5TE core whatever its binary point, so the formats differ only in the
//! shift that follows. A direction's component kept in 2:30 therefore costs no more than one in 16:16 and carries 14
//! more bits. Sums of products stay in 64 bits, exactly, and are rounded once.
//!
//! Each product comes *saturating* under its plain name, `wrapping_` for results that are known to fit, and `checked_`
//! for those that may not.

use fixed::types::{I2F30, I16F16, I32F32};

use crate::assembly;

const fn wide(a: i32, b: i32) -> i64 {
    a as i64 * b as i64
}

/// Half a unit of what is left when `SHIFT` bits go. No product of two `i32` comes within it of the `i64` limits.
const fn half<const SHIFT: u32>() -> i64 {
    1 << (SHIFT - 1)
}

/// A sum rounded down to what is left of it without its lowest `SHIFT` bits, saturated.
#[inline]
const fn floored<const SHIFT: u32>(sum: i64) -> i32 {
    match fitting::<SHIFT>(sum) {
        Some(bits) => bits,
        None => i32::MAX ^ (sum >> 63) as i32,
    }
}

/// As [`floored`], or `None` where that would saturate.
const fn fitting<const SHIFT: u32>(sum: i64) -> Option<i32> {
    let shifted = sum >> SHIFT;
    if shifted as i32 as i64 == shifted {
        Some(shifted as i32)
    } else {
        None
    }
}

const fn lengths(bits: Option<i32>) -> Option<I16F16> {
    match bits {
        Some(bits) => Some(I16F16::from_bits(bits)),
        None => None,
    }
}

const fn units(bits: Option<i32>) -> Option<I2F30> {
    match bits {
        Some(bits) => Some(I2F30::from_bits(bits)),
        None => None,
    }
}

/// `a b` rounded down, the published multiply: within 1 ulp below. Saturates.
///
/// Cost: 7 instructions.
#[doc(alias = "mul")]
#[inline]
pub const fn truncated(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits(floored::<16>(wide(a.to_bits(), b.to_bits())))
}

/// [`truncated`] modulo 2^32 ulp, for products known to fit.
///
/// Cost: 3 instructions.
#[doc(alias = "mul")]
#[inline]
pub const fn wrapping_truncated(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits((wide(a.to_bits(), b.to_bits()) >> 16) as i32)
}

/// [`truncated`], or `None` where the product does not fit.
pub const fn checked_truncated(a: I16F16, b: I16F16) -> Option<I16F16> {
    lengths(fitting::<16>(wide(a.to_bits(), b.to_bits())))
}

/// `a b` to the nearest, halves up: within 0.5 ulp. Saturates.
///
/// Cost: 6 instructions.
///
/// ```
/// use fixedmath::{product, I16F16};
/// let third = I16F16::from_bits(21845);
/// assert_eq!(product::nearest(third, third), I16F16::from_bits(7282));
/// assert_eq!(product::nearest(I16F16::MAX, I16F16::MAX), I16F16::MAX);
/// ```
#[doc(alias = "mul")]
#[inline]
pub fn nearest(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits(assembly::saturated::<16>(wide(a.to_bits(), b.to_bits())))
}

/// [`nearest`] modulo 2^32 ulp, for products known to fit.
///
/// Cost: 3 instructions.
#[doc(alias = "mul")]
#[inline]
pub fn wrapping_nearest(a: I16F16, b: I16F16) -> I16F16 {
    I16F16::from_bits(assembly::rounded::<16>(wide(a.to_bits(), b.to_bits())))
}

/// [`nearest`], or `None` where the product does not fit.
///
/// ```
/// use fixedmath::{product, I16F16};
/// let half = I16F16::from_num(0.5);
/// assert_eq!(product::checked_nearest(half, half), Some(I16F16::from_num(0.25)));
/// assert_eq!(product::checked_nearest(I16F16::MIN, I16F16::MIN), None);
/// ```
pub const fn checked_nearest(a: I16F16, b: I16F16) -> Option<I16F16> {
    lengths(fitting::<16>(wide(a.to_bits(), b.to_bits()) + half::<16>()))
}

/// A length times a direction's component, to the nearest, halves up: within 0.5 ulp. Saturates, which only a
/// component outside [-1, 1] can bring about.
///
/// Cost: 6 instructions.
#[doc(alias = "mul")]
#[inline]
pub fn scaled(length: I16F16, component: I2F30) -> I16F16 {
    I16F16::from_bits(assembly::saturated::<30>(wide(
        length.to_bits(),
        component.to_bits(),
    )))
}

/// A length times a direction's component, rounded down: within 1 ulp below. Saturates.
///
/// Cost: 7 instructions.
#[inline]
pub const fn truncated_scaled(length: I16F16, component: I2F30) -> I16F16 {
    I16F16::from_bits(floored::<30>(wide(length.to_bits(), component.to_bits())))
}

/// [`scaled`] modulo 2^32 ulp: the same for every component in [-1, 1], but for `MIN` times -1.
///
/// Cost: 3 instructions.
#[inline]
pub fn wrapping_scaled(length: I16F16, component: I2F30) -> I16F16 {
    I16F16::from_bits(assembly::rounded::<30>(wide(
        length.to_bits(),
        component.to_bits(),
    )))
}

/// [`scaled`], or `None` where the product does not fit.
pub const fn checked_scaled(length: I16F16, component: I2F30) -> Option<I16F16> {
    lengths(fitting::<30>(
        wide(length.to_bits(), component.to_bits()) + half::<30>(),
    ))
}

/// [`truncated_scaled`], or `None` where the product does not fit.
pub const fn checked_truncated_scaled(length: I16F16, component: I2F30) -> Option<I16F16> {
    lengths(fitting::<30>(wide(length.to_bits(), component.to_bits())))
}

/// A product of two direction components, to the nearest, halves up: within 0.5 ulp of 2^-30. Saturates, which only
/// components outside [-1, 1] can bring about.
///
/// Cost: 6 instructions.
#[doc(alias = "mul")]
#[inline]
pub fn of_units(a: I2F30, b: I2F30) -> I2F30 {
    I2F30::from_bits(assembly::saturated::<30>(wide(a.to_bits(), b.to_bits())))
}

/// A product of two direction components rounded down, modulo 4: within 1 ulp of 2^-30 below, for components in [-1, 1].
///
/// Cost: 3 instructions.
#[inline]
pub const fn wrapping_of_units(a: I2F30, b: I2F30) -> I2F30 {
    I2F30::from_bits((wide(a.to_bits(), b.to_bits()) >> 30) as i32)
}

/// [`of_units`], or `None` where the product does not fit.
pub const fn checked_of_units(a: I2F30, b: I2F30) -> Option<I2F30> {
    units(fitting::<30>(wide(a.to_bits(), b.to_bits()) + half::<30>()))
}

/// `sum + a b` in 32:32: exact, or saturated where it leaves the format.
///
/// Cost: 8 instructions.
///
/// ```
/// use fixedmath::{product, I16F16, I32F32};
/// let (two, three) = (I16F16::from_num(2), I16F16::from_num(3));
/// let sum = product::accumulate(I32F32::ONE, two, three);
/// assert_eq!(product::rounded(sum), I16F16::from_num(7));
/// ```
#[doc(alias("mla", "mul_add"))]
#[inline]
pub const fn accumulate(sum: I32F32, a: I16F16, b: I16F16) -> I32F32 {
    I32F32::from_bits(sum.to_bits().saturating_add(wide(a.to_bits(), b.to_bits())))
}

/// `sum + a b` modulo 2^64 ulp of 32:32, for sums known to fit: one `SMLAL`.
///
/// Cost: 1 instruction.
#[inline]
pub const fn wrapping_accumulate(sum: I32F32, a: I16F16, b: I16F16) -> I32F32 {
    I32F32::from_bits(sum.to_bits().wrapping_add(wide(a.to_bits(), b.to_bits())))
}

/// `sum + a b`, or `None` where it leaves 32:32.
pub const fn checked_accumulate(sum: I32F32, a: I16F16, b: I16F16) -> Option<I32F32> {
    match sum.to_bits().checked_add(wide(a.to_bits(), b.to_bits())) {
        Some(sum) => Some(I32F32::from_bits(sum)),
        None => None,
    }
}

/// A sum of products as a length, to the nearest, halves up: within 0.5 ulp. Saturates.
///
/// Cost: 5 instructions.
#[inline]
pub fn rounded(sum: I32F32) -> I16F16 {
    I16F16::from_bits(assembly::saturated::<16>(sum.to_bits()))
}

/// [`rounded`], or `None` where the sum does not fit.
///
/// ```
/// use fixedmath::{product, I16F16, I32F32};
/// let half_ulp = I32F32::from_bits(1 << 15);
/// assert_eq!(product::checked_rounded(half_ulp), Some(I16F16::from_bits(1)));
/// assert_eq!(product::checked_rounded(I32F32::from_num(32_768) - half_ulp), None);
/// ```
pub const fn checked_rounded(sum: I32F32) -> Option<I16F16> {
    match sum.to_bits().checked_add(half::<16>()) {
        Some(sum) => lengths(fitting::<16>(sum)),
        None => None,
    }
}

/// The dot product of two 16:16 vectors in 32:32: exact, or saturated, sum by sum, where one leaves the format.
///
/// Cost: 17 instructions.
///
/// ```
/// use fixedmath::{product, I16F16, I32F32};
/// let ulp = I16F16::from_bits(1);
/// let v = [I16F16::from_num(3), I16F16::from_num(4), ulp];
/// assert_eq!(product::dot(v, v), I32F32::from_num(25) + I32F32::from_bits(1));
/// ```
#[inline]
pub const fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
    let first = I32F32::from_bits(wide(a[0].to_bits(), b[0].to_bits()));
    // Two products of magnitude at most 2^62 sum to at most 2^63, which is one too many.
    accumulate(accumulate(first, a[1], b[1]), a[2], b[2])
}

/// The dot product of two 16:16 vectors modulo 2^64 ulp of 32:32, for sums whose last step is known to fit.
///
/// Exact while the components stay below 26,754 in magnitude.
///
/// Cost: 3 instructions.
#[inline]
pub const fn wrapping_dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
    let first = I32F32::from_bits(wide(a[0].to_bits(), b[0].to_bits()));
    wrapping_accumulate(wrapping_accumulate(first, a[1], b[1]), a[2], b[2])
}

/// The dot product of two 16:16 vectors in 32:32, or `None` where a sum leaves the format.
pub const fn checked_dot(a: [I16F16; 3], b: [I16F16; 3]) -> Option<I32F32> {
    let first = I32F32::from_bits(wide(a[0].to_bits(), b[0].to_bits()));
    match checked_accumulate(first, a[1], b[1]) {
        Some(sum) => checked_accumulate(sum, a[2], b[2]),
        None => None,
    }
}

/// The dot product of two 16:16 vectors as a length: one rounding to the nearest, within 0.5 ulp. Saturates; beyond
/// components of 26,754 the sum of three products may wrap first.
///
/// Cost: 8 instructions.
#[inline]
pub fn rounded_dot(a: [I16F16; 3], b: [I16F16; 3]) -> I16F16 {
    rounded(wrapping_dot(a, b))
}

/// [`rounded_dot`], or `None` where the result does not fit, for components of any magnitude.
pub const fn checked_rounded_dot(a: [I16F16; 3], b: [I16F16; 3]) -> Option<I16F16> {
    match checked_dot(a, b) {
        Some(sum) => checked_rounded(sum),
        None => None,
    }
}

/// How far a 16:16 vector goes along a direction: their dot product, rounded once to the nearest, within 0.5 ulp.
/// Saturates; components of `direction` lie in [-1, 1].
///
/// Cost: 8 instructions.
///
/// ```
/// use fixedmath::{product, I16F16, I2F30};
/// let v = [I16F16::from_num(1), I16F16::from_num(-20), I16F16::from_num(300)];
/// assert_eq!(product::projection(v, [I2F30::ZERO, I2F30::ZERO, -I2F30::ONE]), I16F16::from_num(-300));
/// ```
#[inline]
pub fn projection(v: [I16F16; 3], direction: [I2F30; 3]) -> I16F16 {
    // Three products of at most 2^61 and a half fit.
    let sum = wide(v[0].to_bits(), direction[0].to_bits())
        .wrapping_add(wide(v[1].to_bits(), direction[1].to_bits()))
        .wrapping_add(wide(v[2].to_bits(), direction[2].to_bits()));
    I16F16::from_bits(assembly::saturated::<30>(sum))
}

/// [`projection`], or `None` where it does not fit, for components of any magnitude.
pub const fn checked_projection(v: [I16F16; 3], direction: [I2F30; 3]) -> Option<I16F16> {
    match checked_sum(
        [v[0].to_bits(), v[1].to_bits(), v[2].to_bits()],
        [
            direction[0].to_bits(),
            direction[1].to_bits(),
            direction[2].to_bits(),
        ],
    ) {
        Some(sum) => lengths(fitting::<30>(sum)),
        None => None,
    }
}

/// The cosine between two directions: their dot product, rounded once to the nearest, within 0.5 ulp of 2^-30, for
/// components in [-1, 1] and results below 2 in magnitude, modulo 4 otherwise.
///
/// Cost: 5 instructions.
#[inline]
pub fn cosine(a: [I2F30; 3], b: [I2F30; 3]) -> I2F30 {
    let sum = wide(a[0].to_bits(), b[0].to_bits())
        .wrapping_add(wide(a[1].to_bits(), b[1].to_bits()))
        .wrapping_add(wide(a[2].to_bits(), b[2].to_bits()));
    I2F30::from_bits(assembly::rounded::<30>(sum))
}

/// [`cosine`], or `None` where it does not fit, for components of any magnitude.
pub const fn checked_cosine(a: [I2F30; 3], b: [I2F30; 3]) -> Option<I2F30> {
    match checked_sum(
        [a[0].to_bits(), a[1].to_bits(), a[2].to_bits()],
        [b[0].to_bits(), b[1].to_bits(), b[2].to_bits()],
    ) {
        Some(sum) => units(fitting::<30>(sum)),
        None => None,
    }
}

/// Half of 2^30 and three products.
const fn checked_sum(a: [i32; 3], b: [i32; 3]) -> Option<i64> {
    match wide(a[0], b[0]).checked_add(wide(a[1], b[1])) {
        Some(sum) => match sum.checked_add(wide(a[2], b[2])) {
            Some(sum) => sum.checked_add(half::<30>()),
            None => None,
        },
        None => None,
    }
}
