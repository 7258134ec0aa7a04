//! The twins in plain Rust.
#![forbid(unsafe_code)]

/// The lower halves of `lower` and `upper`.
#[inline]
pub(crate) fn lower_halves(lower: i32, upper: i32) -> i32 {
    upper << 16 | lower & 0xffff
}

/// The upper halves of `lower` and `upper`.
#[inline]
pub(crate) fn upper_halves(lower: i32, upper: i32) -> i32 {
    upper >> 16 << 16 | (lower as u32 >> 16) as i32
}

/// `sum` plus the product of both lower halves, modulo 2^32.
#[inline]
pub(crate) fn lower_lower(sum: i32, a: i32, b: i32) -> i32 {
    sum.wrapping_add(i32::from(a as i16) * i32::from(b as i16))
}

/// `sum` plus the product of `a`'s lower and `b`'s upper half, modulo 2^32.
#[inline]
pub(crate) fn lower_upper(sum: i32, a: i32, b: i32) -> i32 {
    sum.wrapping_add(i32::from(a as i16) * (b >> 16))
}

/// `sum` plus the product of both upper halves, modulo 2^32.
#[inline]
pub(crate) fn upper_upper(sum: i32, a: i32, b: i32) -> i32 {
    sum.wrapping_add((a >> 16) * (b >> 16))
}
