//! The operations: a marker each.

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16, I32F32, I48F16, product, warp};

use crate::hard;
use crate::number::{Direction, Exponent, Fraction, Turn};
use crate::operation::{Format, Function, Operation};

const fn format(integer_bits: i32, fraction_bits: i32) -> Format {
    Format {
        integer_bits,
        fraction_bits,
        signed: true,
    }
}

const LENGTH: Format = format(15, 16);
const UNIT: Format = format(1, 30);
const SQUARE: Format = format(31, 32);

type Vector = [I16F16; 3];

/// Marks an operation: name, function, format, domain, types; the domain as a condition, and inputs next to where results
/// round or overflow, where there are such.
macro_rules! operations {
    ($(
        $(#[$doc:meta])*
        $marker:ident $name:literal = $function:ident, $format:expr, $domain:literal: $input:ty => $output:ty
        $(, if |$argument:pat_param| $accepts:expr)? $(, hard $hard:path)?;
    )+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub enum $marker {}

        impl Operation for $marker {
            const NAME: &'static str = $name;
            const FUNCTION: Function = Function::$function;
            const FORMAT: Format = $format;
            const DOMAIN: &'static str = $domain;
            type Input = $input;
            type Output = $output;

            $(fn accepts($argument: $input) -> bool {
                $accepts
            })?

            $(fn hard(random: &mut Lcg64) -> $input {
                $hard(random)
            })?
        }
    )+};
}

operations! {
    /// 16:16 times 16:16.
    Multiply "multiply" = Product, LENGTH, "all pairs": (I16F16, I16F16) => I16F16, hard hard::product;
    /// 16:16 times 2:30.
    Scale "multiply 16:16 by 2:30" = Product, LENGTH, "all pairs": (I16F16, I2F30) => I16F16, hard hard::scaled;
    /// 2:30 times 2:30.
    MultiplyUnits "multiply 2:30" = Product, UNIT, "all pairs": (I2F30, I2F30) => I2F30, hard hard::of_units;
    /// A product added to a sum of products.
    Accumulate "multiply and add" = ProductSum, SQUARE, "all": (I32F32, I16F16, I16F16) => I32F32;
    /// A sum of products as a length.
    Round "round 32:32 to 16:16" = Identity, LENGTH, "all": I32F32 => I16F16;
    /// The dot product of 16:16 vectors in 32:32.
    DotProduct "dot product" = Dot, SQUARE, "all pairs": (Vector, Vector) => I32F32;
    /// The dot product of 16:16 vectors in 16:16.
    RoundedDotProduct "dot product in 16:16" = Dot, LENGTH, "components up to 26,754": (Vector, Vector) => I16F16,
        if |(a, b)| a.into_iter().chain(b).all(|x| x.unsigned_abs() <= 26_754);
    /// The dot product of a 16:16 vector and a direction.
    Projection "projection on a direction" = Dot, LENGTH, "all pairs": (Vector, Direction) => I16F16;
    /// The dot product of directions.
    CosineBetween "cosine between directions" = Dot, UNIT, "all pairs": (Direction, Direction) => I2F30;
    /// 16:16 over 16:16.
    Divide "divide" = Quotient, LENGTH, "b != 0": (I16F16, I16F16) => I16F16, if |(_, b)| b != I16F16::ZERO,
        hard hard::quotient;
    /// One over 16:16.
    Reciprocal "reciprocal" = Reciprocal, LENGTH, "x != 0": I16F16 => I16F16, if |x| x != I16F16::ZERO;
    /// The root of 16:16.
    SquareRoot "square root" = SquareRoot, LENGTH, "x >= 0": I16F16 => I16F16, if |x| x >= I16F16::ZERO;
    /// The root of 2:30.
    RootOfUnit "square root 2:30" = SquareRoot, UNIT, "x >= 0": I2F30 => I2F30, if |x| x >= I2F30::ZERO;
    /// The root of 48:16 in 16:16.
    RootOfWide "square root 48:16" = SquareRoot, LENGTH, "x >= 0": I48F16 => I16F16, if |x| x >= I48F16::ZERO,
        hard hard::root_of_wide;
    /// The root of 32:32 in 16:16.
    RootOfSquare "square root 32:32" = SquareRoot, LENGTH, "x >= 0": I32F32 => I16F16, if |x| x >= I32F32::ZERO,
        hard hard::root_of_square;
    /// The root of an integer as an integer.
    RootOfInteger "square root 64:0" = SquareRoot,
        Format { integer_bits: 32, fraction_bits: 0, signed: false }, "all": u64 => u32, hard hard::root_of_integer;
    /// One over the root of 16:16.
    ReciprocalRoot "reciprocal square root" = ReciprocalSquareRoot, LENGTH, "x > 0": I16F16 => I16F16,
        if |x| x > I16F16::ZERO;
    /// The length of a 16:16 vector.
    Length "length" = Length, LENGTH, "all": Vector => I16F16;
    /// The direction of a 16:16 vector.
    NormaliseLengths "normalise 16:16" = UnitVector, UNIT, "v != 0": Vector => [I2F30; 3],
        if |v| v != [I16F16::ZERO; 3];
    /// A vector of 2:30 brought to unit length.
    Normalise "normalise 2:30" = UnitVector, UNIT, "v != 0": [I2F30; 3] => [I2F30; 3], if |v| v != [I2F30::ZERO; 3];
    /// A vector that is of unit length already but for rounding.
    Renormalise "renormalise" = UnitVector, UNIT, "|v| within 2^-15 of 1": Direction => [I2F30; 3];
    /// The sine of an angle in turns.
    Sine "sine" = Sine, LENGTH, "all turns": Turn => I16F16;
    /// The cosine of an angle in turns.
    Cosine "cosine" = Cosine, LENGTH, "all turns": Turn => I16F16;
    /// Cosine and sine of an angle in turns.
    CosineAndSine "sine and cosine" = CosineAndSine, LENGTH, "all turns": Turn => (I2F30, I2F30);
    /// The angle of a vector.
    Angle "angle of a vector" = Angle, format(3, 16), "(x, y) != 0": (I16F16, I16F16) => Turn,
        if |(x, y)| x != I16F16::ZERO || y != I16F16::ZERO;
    /// The exponential function.
    Exponential "exponential" = Exponential, LENGTH, "all": Exponent => I16F16;
    /// The next number of a generator.
    RandomNumber "random number" = RandomNumber, format(0, 32), "all states": u64 => Fraction;
    /// A sample's place under the tent filter.
    Tent "tent filter" = Tent, UNIT, "all": Fraction => I2F30;
    /// A point of the unit sphere.
    Sphere "point of the sphere" = Sphere, UNIT, "all": (Fraction, Turn) => [I2F30; 3];
    /// A direction in proportion to its cosine with a normal.
    DiffuseDirection "cosine-weighted direction" = OffsetSphere, UNIT, "point 2^-6 or more from the normal's antipode":
        (Direction, Fraction, Turn) => [I2F30; 3],
        if |(Direction(normal), Fraction(height), Turn(turn))| {
            // Two unit vectors with cosine c have a sum of length sqrt(2 + 2 c).
            product::cosine(normal, warp::sphere(height, turn)) > I2F30::from_bits((1 << 17) - (1 << 30))
        };
}
