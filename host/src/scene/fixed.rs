//! From double precision to the formats of a scene's records, to the nearest.

use fixedmath::{I2F30, I16F16, U0F32};

/// To 16:16; scene validation keeps values within it.
pub(super) fn q16(value: f64) -> I16F16 {
    I16F16::from_bits((value * 65536.0).round() as i32)
}

/// To 2:30.
pub(super) fn q30(value: f64) -> I2F30 {
    I2F30::from_bits((value * f64::from(1 << 30)).round() as i32)
}

/// To 0:32, where all ones stand for 1: the conversion saturates there.
pub(super) fn q0_32(value: f64) -> U0F32 {
    U0F32::from_bits((value * 4_294_967_296.0).round() as u32)
}
