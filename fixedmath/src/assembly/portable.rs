//! The twins in plain Rust, for every other instruction set.
#![forbid(unsafe_code)]

/// `sum` without its lowest `SHIFT` bits, to the nearest, halves up, modulo 2^32. `SHIFT` is 1 to 31.
#[inline]
pub(crate) fn rounded<const SHIFT: u32>(sum: i64) -> i32 {
    (sum.wrapping_add(1 << (SHIFT - 1)) >> SHIFT) as i32
}

/// As [`rounded`], saturated, also where the rounding itself would wrap.
#[inline]
pub(crate) fn saturated<const SHIFT: u32>(sum: i64) -> i32 {
    let rounded = sum.saturating_add(1 << (SHIFT - 1)) >> SHIFT;
    rounded.clamp(i32::MIN as i64, i32::MAX as i64) as i32
}
