//! Two 16-bit numbers in a word, and sums of their products.
//!
//! A product of two halves, with a sum added to it, is one instruction of one cycle on an ARMv5TE core (`SMLAxy`), of two whole
//! words three (`SMLAL`). What is to be multiplied often, and does with 16 bits, is best kept in pairs: they take half
//! the registers, too.

use crate::assembly;

/// Two signed 16-bit numbers in a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Halves(i32);

impl Halves {
    /// The pair.
    pub const fn new(lower: i16, upper: i16) -> Self {
        Self((upper as i32) << 16 | lower as u16 as i32)
    }

    /// The lower halves of two words.
    ///
    /// Cost: 3 instructions.
    #[inline]
    pub fn of_lower(lower: i32, upper: i32) -> Self {
        Self(assembly::lower_halves(lower, upper))
    }

    /// The upper halves of two words.
    ///
    /// Cost: 3 instructions.
    #[inline]
    pub fn of_upper(lower: i32, upper: i32) -> Self {
        Self(assembly::upper_halves(lower, upper))
    }

    /// The pair in a word.
    #[inline]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// The word.
    #[inline]
    pub const fn to_bits(self) -> i32 {
        self.0
    }

    /// The number in the lower half.
    #[inline]
    pub const fn lower(self) -> i16 {
        self.0 as i16
    }

    /// The number in the upper half.
    #[inline]
    pub const fn upper(self) -> i16 {
        (self.0 >> 16) as i16
    }
}

/// `sum` plus the product of two lower halves, modulo 2^32.
///
/// Cost: 1 instruction.
#[inline]
pub fn wrapping_lower(sum: i32, a: Halves, b: Halves) -> i32 {
    assembly::lower_lower(sum, a.0, b.0)
}

/// `sum` plus the product of `a`'s lower and `b`'s upper half, modulo 2^32.
///
/// Cost: 1 instruction.
#[inline]
pub fn wrapping_lower_upper(sum: i32, a: Halves, b: Halves) -> i32 {
    assembly::lower_upper(sum, a.0, b.0)
}

/// `sum` plus the products of two lower and of two upper halves, modulo 2^32.
///
/// Cost: 2 instructions.
///
/// ```
/// use fixedmath::halves::{self, Halves};
/// assert_eq!(halves::wrapping_dot(1, Halves::new(3, -4), Halves::new(100, 1000)), -3699);
/// ```
#[inline]
pub fn wrapping_dot(sum: i32, a: Halves, b: Halves) -> i32 {
    assembly::upper_upper(assembly::lower_lower(sum, a.0, b.0), a.0, b.0)
}
