//! Numbers of whatever size.

use bytemuck::{Pod, Zeroable};
use fixedmath::division;

/// A number that is not negative, of 32 significant bits: `mantissa` 2^`exponent`.
///
/// What is between densities of light, squares of distances and areas spans a hundred powers of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Magnitude {
    /// Its upper bit is set, unless all of it is 0.
    mantissa: u32,
    exponent: i32,
}

impl Magnitude {
    const ZERO: Self = Self {
        mantissa: 0,
        exponent: 0,
    };

    /// `number` 2^`exponent`, cut to 32 bits.
    #[inline]
    pub const fn new(number: u64, exponent: i32) -> Self {
        let (upper, lower) = ((number >> 32) as u32, number as u32);
        if upper == 0 {
            return Self::of_word(lower, exponent);
        }
        let places = upper.leading_zeros();
        Self {
            mantissa: upper << places | (lower >> 1) >> (31 - places),
            exponent: exponent + 32 - places as i32,
        }
    }

    #[inline]
    const fn of_word(number: u32, exponent: i32) -> Self {
        if number == 0 {
            return Self::ZERO;
        }
        let places = number.leading_zeros();
        Self {
            mantissa: number << places,
            exponent: exponent - places as i32,
        }
    }

    #[inline]
    const fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    /// The product, within 2 of the last of 32 bits.
    #[inline]
    #[must_use]
    pub const fn times(self, other: Self) -> Self {
        let product = self.mantissa as u64 * other.mantissa as u64;
        let exponent = self.exponent + other.exponent + 32;
        let upper = (product >> 32) as u32;
        // One of its upper two bits is set, unless all of it is 0.
        if upper >> 31 == 0 {
            Self {
                mantissa: upper << 1 | product as u32 >> 31,
                exponent: exponent - 1,
            }
        } else {
            Self {
                mantissa: upper,
                exponent,
            }
        }
    }

    /// The sum, within 2 of the last of 32 bits.
    #[inline]
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        let (large, small) = if self.exponent >= other.exponent && !self.is_zero() || other.is_zero() {
            (self, other)
        } else {
            (other, self)
        };
        let apart = (large.exponent - small.exponent) as u32;
        let aligned = if apart < 32 { small.mantissa >> apart } else { 0 };
        let (sum, carries) = large.mantissa.overflowing_add(aligned);
        if carries {
            Self {
                mantissa: sum >> 1 | 1 << 31,
                exponent: large.exponent + 1,
            }
        } else {
            Self {
                mantissa: sum,
                exponent: large.exponent,
            }
        }
    }

    /// The quotient, within 2 of the last of 31 bits. By 0 it is as large as can be.
    #[inline(never)]
    #[must_use]
    pub const fn over(self, divisor: Self) -> Self {
        // Half of the dividend, so that the quotient is below 1.
        let quotient = division::long((self.mantissa as u64) << 31, divisor.mantissa);
        Self::of_word(quotient, self.exponent - divisor.exponent - 31)
    }

    /// Its multiple of 2^-`bits`, cut to a whole number; all ones where that does not fit 64 bits.
    #[inline]
    pub const fn to_fixed(self, bits: i32) -> u64 {
        let places = self.exponent + bits;
        if places <= -32 || self.mantissa == 0 {
            0
        } else if places <= 0 {
            (self.mantissa >> -places) as u64
        } else if places <= 32 {
            (self.mantissa as u64) << places
        } else {
            u64::MAX
        }
    }

    /// A share in 0:32, cut, of which all ones stand for 1.
    #[inline]
    pub const fn to_share(self) -> u32 {
        let places = -32 - self.exponent;
        if places < 0 {
            u32::MAX
        } else if places < 32 {
            self.mantissa >> places
        } else {
            0
        }
    }

    /// Its size: it is less than 2^this, and at least half of that. Of 0, anything.
    #[inline]
    pub const fn log2(self) -> i32 {
        self.exponent + 32
    }

    /// 2^`power` times as much.
    #[inline]
    #[must_use]
    pub const fn scaled(self, power: i32) -> Self {
        Self {
            exponent: self.exponent + power,
            ..self
        }
    }

    /// Whether it is a number, of a size from which none is made that has none.
    pub(super) const fn is_sound(self) -> bool {
        self.mantissa >> 31 == 1 && self.exponent.unsigned_abs() < 1 << 10
    }

    /// Mantissa and exponent.
    pub const fn parts(self) -> (u32, i32) {
        (self.mantissa, self.exponent)
    }
}
