//! Rows of what users might pick from elsewhere, in its natural types and units: the fixed-point crates on 16:16, and
//! single precision in software.

use fixedmath::I16F16;
use micromath::F32;

use crate::number::{Exponent, Turn};
use crate::row::converted_rows;
use crate::variant::Visitor;

fn float(x: I16F16) -> f32 {
    x.to_num()
}

fn floats((a, b): (I16F16, I16F16)) -> (f32, f32) {
    (a.to_num(), b.to_num())
}

fn radians(Turn(turn): Turn) -> f64 {
    f64::from(turn) * (core::f64::consts::TAU / 4_294_967_296.0)
}

/// Crates that work on 16:16.
pub(crate) fn fixed_point(visitor: &mut impl Visitor) {
    converted_rows!(visitor, Multiply:
        Rival("fixed") "*" |pair| pair => (I16F16, I16F16), |(a, b)| a.wrapping_mul(b) => I16F16;
        Rival("fixed") "saturating_mul" |pair| pair => (I16F16, I16F16), |(a, b)| a.saturating_mul(b) => I16F16, {
            const SATURATES: bool = true;
        };
    );
    converted_rows!(visitor, Divide:
        Rival("fixed") "/" |pair| pair => (I16F16, I16F16), |(a, b)| a.wrapping_div(b) => I16F16;
    );
    converted_rows!(visitor, Reciprocal:
        Rival("fixed") "recip" |x| x => I16F16, |x| x.wrapping_recip() => I16F16;
    );
    converted_rows!(visitor, SquareRoot:
        Rival("fixed") "sqrt" |x| x => I16F16, |x| x.sqrt() => I16F16;
        Rival("cordic") "sqrt" |x| x => I16F16, |x| cordic::sqrt(x) => I16F16, {
            const DOMAIN: &'static str = "0 <= x < 2^14";
            fn accepts(x: I16F16) -> bool {
                x < I16F16::from_bits(1 << 30)
            }
        };
    );
    converted_rows!(visitor, Sine:
        Rival("cordic") "sin" |turn| I16F16::from_num(radians(turn)) => I16F16, |x| cordic::sin(x) => I16F16;
    );
    converted_rows!(visitor, Angle:
        Rival("cordic") "atan2" |pair| pair => (I16F16, I16F16), |(x, y)| cordic::atan2(y, x) => I16F16;
    );
    converted_rows!(visitor, Exponential:
        Rival("cordic") "exp" |Exponent(x)| x => I16F16, |x| cordic::exp(x) => I16F16, {
            const DOMAIN: &'static str = "|x| < 16";
            fn accepts(Exponent(x): Exponent) -> bool {
                x.unsigned_abs() < 16
            }
        };
    );
    converted_rows!(visitor, Cosine:
        Rival("cordic") "cos" |turn| I16F16::from_num(radians(turn)) => I16F16, |x| cordic::cos(x) => I16F16;
    );
    converted_rows!(visitor, CosineAndSine:
        Rival("cordic") "sin_cos" |turn| I16F16::from_num(radians(turn)) => I16F16, |x| {
            let (sine, cosine) = cordic::sin_cos(x);
            (cosine, sine)
        } => (I16F16, I16F16);
    );
}

/// Single precision in software: the compiler's own routines, and the mathematical library over them.
pub(crate) fn soft_float(visitor: &mut impl Visitor) {
    converted_rows!(visitor, Multiply:
        Rival("f32") "*" |pair| floats(pair) => (f32, f32), |(a, b)| a * b => f32;
    );
    converted_rows!(visitor, Divide:
        Rival("f32") "/" |pair| floats(pair) => (f32, f32), |(a, b)| a / b => f32;
    );
    converted_rows!(visitor, Reciprocal:
        Rival("f32") "1 / x" |x| float(x) => f32, |x| 1.0 / x => f32;
    );
    converted_rows!(visitor, SquareRoot:
        Rival("libm") "sqrtf" |x| float(x) => f32, |x| libm::sqrtf(x) => f32;
    );
    converted_rows!(visitor, ReciprocalRoot:
        Rival("libm") "1 / sqrtf" |x| float(x) => f32, |x| 1.0 / libm::sqrtf(x) => f32;
    );
    converted_rows!(visitor, Angle:
        Rival("libm") "atan2f" |pair| floats(pair) => (f32, f32), |(x, y)| libm::atan2f(y, x) => f32;
    );
    converted_rows!(visitor, Exponential:
        Rival("libm") "expf" |Exponent(x)| float(x) => f32, |x| libm::expf(x) => f32;
    );
}

/// Functions of angles in single precision, by the mathematical library.
pub(crate) fn float_angles(visitor: &mut impl Visitor) {
    converted_rows!(visitor, Sine:
        Rival("libm") "sinf" |turn| radians(turn) as f32 => f32, |x| libm::sinf(x) => f32;
    );
    converted_rows!(visitor, Cosine:
        Rival("libm") "cosf" |turn| radians(turn) as f32 => f32, |x| libm::cosf(x) => f32;
    );
    converted_rows!(visitor, CosineAndSine:
        Rival("libm") "sincosf" |turn| radians(turn) as f32 => f32, |x| {
            let (sine, cosine) = libm::sincosf(x);
            (cosine, sine)
        } => (f32, f32);
    );
}

/// Approximations in single precision.
pub(crate) fn rough_float(visitor: &mut impl Visitor) {
    converted_rows!(visitor, Reciprocal:
        Rival("micromath") "inv" |x| float(x) => f32, |x| F32(x).inv().0 => f32;
    );
    converted_rows!(visitor, SquareRoot:
        Rival("micromath") "sqrt" |x| float(x) => f32, |x| F32(x).sqrt().0 => f32;
    );
    converted_rows!(visitor, ReciprocalRoot:
        Rival("micromath") "invsqrt" |x| float(x) => f32, |x| F32(x).invsqrt().0 => f32;
    );
    converted_rows!(visitor, Sine:
        Rival("micromath") "sin" |turn| radians(turn) as f32 => f32, |x| F32(x).sin().0 => f32;
    );
    converted_rows!(visitor, Angle:
        Rival("micromath") "atan2" |pair| floats(pair) => (f32, f32), |(x, y)| F32(y).atan2(F32(x)).0 => f32;
    );
    converted_rows!(visitor, Exponential:
        Rival("micromath") "exp" |Exponent(x)| float(x) => f32, |x| F32(x).exp().0 => f32;
    );
    converted_rows!(visitor, Cosine:
        Rival("micromath") "cos" |turn| radians(turn) as f32 => f32, |x| F32(x).cos().0 => f32;
    );
    converted_rows!(visitor, CosineAndSine:
        Rival("micromath") "sin_cos" |turn| radians(turn) as f32 => f32, |x| {
            let (sine, cosine) = F32(x).sin_cos();
            (cosine.0, sine.0)
        } => (f32, f32);
    );
}
