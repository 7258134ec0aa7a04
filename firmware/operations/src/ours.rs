//! Rows of ours and of the published system: no float, and no way to panic.

use fixedmath::random::{Lcg32, Lcg64};
use fixedmath::{I2F30, I16F16, U0F32, angle, division, exponential, product, root, unit, warp};
use tracer::arithmetic::{Directions, Published, Sampling};
use tracer::material::{HemisphereSampling, MalleyDisc};
use tracer::random::Random;

use crate::number::{Direction, Exponent, Fraction, Turn};
use crate::operation::Function;
use crate::row::{converted_rows, rows};
use crate::variant::Visitor;

/// Products, quotients, exponentials and random numbers.
pub(crate) fn arithmetic(visitor: &mut impl Visitor) {
    products(visitor);
    quotients(visitor);
    exponentials(visitor);
    random_numbers(visitor);
}

fn products(visitor: &mut impl Visitor) {
    rows!(visitor, Multiply:
        Published "product::truncated" |(a, b)| product::truncated(a, b);
        Ours "product::wrapping_truncated" |(a, b)| product::wrapping_truncated(a, b), { const SATURATES: bool = false; };
        Ours "product::wrapping_nearest" |(a, b)| product::wrapping_nearest(a, b), { const SATURATES: bool = false; };
        Ours "product::nearest" |(a, b)| product::nearest(a, b);
    );
    rows!(visitor, Scale:
        Ours "product::truncated_scaled" |(length, component)| product::truncated_scaled(length, component);
        Ours "product::wrapping_scaled" |(length, component)| product::wrapping_scaled(length, component), {
            const SATURATES: bool = false;
        };
        Ours "product::scaled" |(length, component)| product::scaled(length, component);
    );
    rows!(visitor, MultiplyUnits:
        Ours "product::wrapping_of_units" |(a, b)| product::wrapping_of_units(a, b), { const SATURATES: bool = false; };
        Ours "product::of_units" |(a, b)| product::of_units(a, b);
    );
    rows!(visitor, Accumulate:
        Ours "product::wrapping_accumulate" |(sum, a, b)| product::wrapping_accumulate(sum, a, b), {
            const SATURATES: bool = false;
        };
        Ours "product::accumulate" |(sum, a, b)| product::accumulate(sum, a, b);
    );
    rows!(visitor, Round:
        Ours "product::rounded" |sum| product::rounded(sum);
    );
}

/// Dot products.
pub(crate) fn dot_products(visitor: &mut impl Visitor) {
    rows!(visitor, DotProduct:
        Ours "product::wrapping_dot" |(a, b)| product::wrapping_dot(a, b), { const SATURATES: bool = false; };
        Ours "product::dot" |(a, b)| product::dot(a, b);
    );
    rows!(visitor, RoundedDotProduct:
        Ours "product::rounded_dot" |(a, b)| product::rounded_dot(a, b);
    );
    rows!(visitor, Projection:
        Ours "product::projection" |(v, Direction(d))| product::projection(v, d);
    );
    rows!(visitor, CosineBetween:
        Ours "product::cosine" |(Direction(a), Direction(b))| product::cosine(a, b);
    );
}

fn quotients(visitor: &mut impl Visitor) {
    rows!(visitor, Divide:
        Published "division::restoring" |(a, b)| division::restoring(a, b);
        Ours "division::nearest" |(a, b)| division::nearest(a, b);
    );
    rows!(visitor, Reciprocal:
        Published "division::restoring" |x| division::restoring(I16F16::ONE, x);
        Ours "division::reciprocal" |x| division::reciprocal(x);
    );
}

/// Square roots and their reciprocals.
pub(crate) fn roots(visitor: &mut impl Visitor) {
    rows!(visitor, SquareRoot:
        Published "root::restoring" |x| root::restoring(x);
        Ours "root::of_length" |x| root::of_length(x);
    );
    rows!(visitor, RootOfUnit:
        Ours "root::of_fraction" |x| root::of_fraction(x);
    );
    rows!(visitor, RootOfWide:
        Published "root::split" |x| root::split(x);
        Ours "root::of_wide" |x| root::of_wide(x);
    );
    rows!(visitor, RootOfSquare:
        Ours "root::of_square" |x| root::of_square(x);
        Ours "root::near_square" |x| root::near_square(x);
    );
    rows!(visitor, RootOfInteger:
        Ours "root::nearest" |x| root::nearest(x);
        Ours "root::floor" |x| root::floor(x);
    );
    rows!(visitor, ReciprocalRoot:
        Published "division::restoring of root::restoring" |x| {
            division::restoring(I16F16::ONE, root::restoring(x))
        };
        Ours "root::reciprocal_of_length" |x| root::reciprocal_of_length(x);
    );
}

/// Functions of angles.
pub(crate) fn angles(visitor: &mut impl Visitor) {
    rows!(visitor, Angle:
        Ours "angle::of_vector" |(x, y)| Turn(angle::of_vector(x, y));
    );
    rows!(visitor, Sine:
        Published "angle::parabolic_sine" |Turn(turn)| angle::parabolic_sine(turn);
        Published "angle::refined_parabolic_sine" |Turn(turn)| angle::refined_parabolic_sine(turn);
        Ours "angle::sine" |Turn(turn)| angle::sine(turn);
        Ours "angle::cos_sin, its sine" |Turn(turn)| angle::cos_sin(turn).1, I2F30;
    );
    rows!(visitor, Cosine:
        Published "angle::parabolic_sine" |Turn(turn)| angle::parabolic_sine(turn.wrapping_add(1 << 30));
        Ours "angle::cosine" |Turn(turn)| angle::cosine(turn);
        Ours "angle::cos_sin, its cosine" |Turn(turn)| angle::cos_sin(turn).0, I2F30;
    );
    rows!(visitor, CosineAndSine:
        Published "angle::parabolic_sine, twice" |Turn(turn)| Published::cos_sin(U0F32::from_bits(turn)), (I16F16, I16F16);
        Ours "angle::linear_cos_sin" |Turn(turn)| angle::linear_cos_sin(turn);
        Ours "angle::quadratic_cos_sin" |Turn(turn)| angle::quadratic_cos_sin(turn);
        Ours "angle::cos_sin" |Turn(turn)| angle::cos_sin(turn);
    );
}

/// Lengths, and vectors of unit length.
pub(crate) fn directions(visitor: &mut impl Visitor) {
    rows!(visitor, Length:
        Ours "unit::length" |v| unit::length(v);
    );
    rows!(visitor, NormaliseLengths:
        Published "division::restoring by root::split" |v| Published::normalised(v, v), [I16F16; 3], {
            const DOMAIN: &'static str = "2^-8 <= |v| < 2^15";
            fn accepts(v: [I16F16; 3]) -> bool {
                has_published_length(v)
            }
        };
        Ours "unit::of_vector" |v| unit::of_vector(v);
    );
    converted_rows!(visitor, Normalise:
        Published "division::restoring by root::split" |v| v.map(narrow) => [I16F16; 3],
        |v| Published::normalised(v, v) => [I16F16; 3], {
            const DOMAIN: &'static str = "2^-8 <= |v|";
            fn accepts(v: [I2F30; 3]) -> bool {
                has_published_length(v.map(narrow))
            }
        };
    );
    rows!(visitor, Normalise:
        Ours "unit::normalised" |v| unit::normalised(v);
    );
    converted_rows!(visitor, Renormalise:
        Published "division::restoring by root::split" |Direction(v)| v.map(narrow) => [I16F16; 3],
        |v| Published::renormalised(v) => [I16F16; 3];
    );
    rows!(visitor, Renormalise:
        Ours "unit::renormalised" |Direction(v)| unit::renormalised(v);
    );
}

fn exponentials(visitor: &mut impl Visitor) {
    rows!(visitor, Exponential:
        Ours "exponential::natural" |Exponent(x)| exponential::natural(x);
    );
}

/// Points drawn from distributions.
pub(crate) fn warps(visitor: &mut impl Visitor) {
    rows!(visitor, Tent:
        Published "tracer::arithmetic::Published::tent" |Fraction(fraction)| Published::tent(U0F32::from_bits(fraction)), I16F16;
        Ours "warp::tent" |Fraction(fraction)| warp::tent(fraction);
    );
    rows!(visitor, Sphere:
        Ours "warp::sphere" |(Fraction(height), Turn(turn))| warp::sphere(height, turn);
    );
    converted_rows!(visitor, DiffuseDirection:
        Published "tracer::material::MalleyDisc" |(Direction(normal), square, turn)| {
            (normal.map(narrow), square, turn)
        } => ([I16F16; 3], Fraction, Turn),
        |(normal, Fraction(square), Turn(turn))| {
            let mut drawn = Drawn(U0F32::from_bits(turn), U0F32::from_bits(square));
            MalleyDisc::direction::<Published, _>(normal, &mut drawn)
        } => [I16F16; 3], {
            const FUNCTION: Function = Function::LiftedDisc;
        };
    );
    rows!(visitor, DiffuseDirection:
        Ours "warp::cosine_hemisphere" |(Direction(normal), Fraction(height), Turn(turn))| {
            warp::cosine_hemisphere(normal, height, turn)
        };
    );
}

/// 2:30 in 16:16, as the published system would have it.
fn narrow(component: I2F30) -> I16F16 {
    I16F16::from_bits(component.to_bits() >> 14)
}

/// Whether a vector's squared length in 48:16 is neither nothing nor beyond the square of 16:16.
fn has_published_length(v: [I16F16; 3]) -> bool {
    let squares = v.map(|component| {
        let bits = u64::from(component.to_bits().unsigned_abs());
        bits * bits
    });
    (1 << 16..1 << 62).contains(&squares.iter().sum::<u64>())
}

/// Two numbers drawn beforehand.
struct Drawn(U0F32, U0F32);

impl Random for Drawn {
    fn for_unit(seed: u64, id: u32) -> Self {
        Self(U0F32::from_bits(seed as u32), U0F32::from_bits(id))
    }

    #[inline(always)]
    fn fraction(&mut self) -> U0F32 {
        let Self(first, second) = *self;
        self.0 = second;
        first
    }
}

fn random_numbers(visitor: &mut impl Visitor) {
    rows!(visitor, RandomNumber:
        Published "random::Lcg32::low_bits" |state| Fraction(u32::from(Lcg32::new(state as u32).low_bits()) << 16);
        Ours "random::Lcg64::next_fraction" |state| Fraction(Lcg64::new(state).next_fraction());
    );
}
