//! What the tracer's arithmetic needs of a floating-point format.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point format. Conversions are rounded to the nearest.
pub trait Float:
    Copy
    + Debug
    + Send
    + Sync
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Farther than anything.
    const FAR: Self;

    /// A constant.
    fn of(constant: f64) -> Self;
    /// A signed number.
    fn of_i32(number: i32) -> Self;
    /// An unsigned number.
    fn of_u32(number: u32) -> Self;
    /// A long number.
    fn of_i64(number: i64) -> Self;
    /// A whole number that has been converted, over 2^`bits`: exactly, and without a product, which is dear in soft float.
    fn over_power(self, bits: u8) -> Self;
    /// The whole part of what is not negative.
    fn to_u64(self) -> u64;
    /// The root, correctly rounded.
    fn root(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sine_cosine(self) -> (Self, Self);
}

macro_rules! float {
    ($format:ident, $bits:ident, $root:path, $sine_cosine:path) => {
        impl Float for $format {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const FAR: Self = 1e9;

            #[inline]
            fn of(constant: f64) -> Self {
                constant as Self
            }

            #[inline]
            fn of_i32(number: i32) -> Self {
                number as Self
            }

            #[inline]
            fn of_u32(number: u32) -> Self {
                number as Self
            }

            #[inline]
            fn of_i64(number: i64) -> Self {
                number as Self
            }

            #[inline]
            fn over_power(self, bits: u8) -> Self {
                match self.to_bits() {
                    0 => self,
                    // A whole number's exponent is far from the least there is.
                    number => Self::from_bits(number - ($bits::from(bits) << (Self::MANTISSA_DIGITS - 1))),
                }
            }

            #[inline]
            fn to_u64(self) -> u64 {
                self as u64
            }

            #[inline]
            fn root(self) -> Self {
                $root(self)
            }

            #[inline]
            fn sine_cosine(self) -> (Self, Self) {
                $sine_cosine(self)
            }
        }
    };
}

float!(f32, u32, libm::sqrtf, libm::sincosf);
float!(f64, u64, libm::sqrt, libm::sincos);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_divides_exactly() {
        for number in [0, 1, -1, 3, -65_536, 16_777_215, i32::MIN, i32::MAX] {
            for bits in [0, 1, 16, 28, 30, 32] {
                let power = f64::from(bits).exp2();
                assert_eq!(f64::of_i32(number).over_power(bits), f64::from(number) / power);
                assert_eq!(f32::of_i32(number).over_power(bits), number as f32 / power as f32);
            }
        }
        let square = i64::MIN / 3;
        assert_eq!(
            f64::of_i64(square).over_power(32),
            square as f64 / 4_294_967_296.0
        );
    }
}
