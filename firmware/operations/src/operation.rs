//! What an operation is.

use fixedmath::random::Lcg64;

use crate::number::{Input, Number};

/// What an operation approaches. The host has a truth for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// `a b`.
    Product,
    /// `a . b` of two vectors.
    Dot,
    /// `a + b c`.
    ProductSum,
    /// `x` itself, in another format.
    Identity,
    /// `a / b`.
    Quotient,
    /// `1 / x`.
    Reciprocal,
    /// `sqrt(x)`.
    SquareRoot,
    /// `1 / sqrt(x)`.
    ReciprocalSquareRoot,
    /// `sin(x)`.
    Sine,
    /// `cos(x)`.
    Cosine,
    /// `cos(x)` and `sin(x)`.
    CosineAndSine,
    /// The angle of the vector `(x, y)` from the x axis, in radians and but for whole turns.
    Angle,
    /// `e^x`.
    Exponential,
    /// `|v|`.
    Length,
    /// `v / |v|`.
    UnitVector,
    /// The tent filter's point for a uniform number: the upper half of numbers rises from 0 to 1, the lower from -1 to 0.
    Tent,
    /// A point of the unit sphere: height from a uniform number, and angle.
    Sphere,
    /// A direction about a normal, through a point of the unit sphere set on its tip: normal, height from a uniform number, angle.
    OffsetSphere,
    /// A direction about a normal, lifted from the unit disc in smallpt's basis: normal, squared radius, angle.
    LiftedDisc,
    /// No function of real numbers.
    RandomNumber,
}

/// A fixed-point format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Magnitudes stay below 2 to this power.
    pub integer_bits: i32,
    /// An ulp is 2 to minus this power.
    pub fraction_bits: i32,
    /// Whether there are negative numbers.
    pub signed: bool,
}

/// What is to be computed: a function, its formats, its domain.
pub trait Operation: 'static {
    /// The name in tables and files.
    const NAME: &'static str;
    /// The function, of which the host knows the truth.
    const FUNCTION: Function;
    /// The output's format, which says what an ulp is and where the output ends.
    const FORMAT: Format;
    /// The inputs that errors and prices are for, in words.
    const DOMAIN: &'static str;
    /// An input.
    type Input: Input;
    /// An output.
    type Output: Number;

    /// Whether an input lies in [`Operation::DOMAIN`].
    fn accepts(_input: Self::Input) -> bool {
        true
    }

    /// An input next to where the result is rounded the other way or leaves its format, if such are known.
    fn hard(random: &mut Lcg64) -> Self::Input {
        Input::draw(random)
    }
}
