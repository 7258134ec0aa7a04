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
    /// The whole part of what is not negative.
    fn to_u64(self) -> u64;
    /// The root, correctly rounded.
    fn root(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sine_cosine(self) -> (Self, Self);
}

macro_rules! float {
    ($format:ident, $root:path, $sine_cosine:path) => {
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

float!(f32, libm::sqrtf, libm::sincosf);
float!(f64, libm::sqrt, libm::sincos);
