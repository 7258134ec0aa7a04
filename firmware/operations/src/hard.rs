//! Hard cases: inputs whose exact result lies next to where it is rounded the other way, or next to the format's end.

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16, I32F32, I48F16};

use crate::number::Input;

/// A number of any magnitude, but not 0.
fn word(random: &mut Lcg64) -> i64 {
    loop {
        let word: I16F16 = Input::draw(random);
        if word != I16F16::ZERO {
            return word.to_bits().into();
        }
    }
}

/// -1, 0 or 1.
fn neighbour(random: &mut Lcg64) -> i64 {
    i64::from(random.next_fraction() % 3) - 1
}

fn saturated(value: i64) -> i32 {
    value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// A result in halves of an ulp: any, or the format's end.
fn halves(random: &mut Lcg64) -> i64 {
    match random.next_fraction() % 8 {
        0 => 1 << 32,
        1 => -1 << 32,
        _ => word(random) * 2 + 1,
    }
}

/// Factors whose product, shifted right by `shift`, is next to half an ulp or to the end of 32 bits.
fn factors(random: &mut Lcg64, shift: u32) -> (i32, i32) {
    let a = word(random);
    let product = halves(random) << (shift - 1);
    (a as i32, saturated(product / a + neighbour(random)))
}

/// For 16:16 times 16:16.
pub(crate) fn product(random: &mut Lcg64) -> (I16F16, I16F16) {
    let (a, b) = factors(random, 16);
    (I16F16::from_bits(a), I16F16::from_bits(b))
}

/// For 16:16 times 2:30.
pub(crate) fn scaled(random: &mut Lcg64) -> (I16F16, I2F30) {
    let (a, b) = factors(random, 30);
    (I16F16::from_bits(a), I2F30::from_bits(b))
}

/// For 2:30 times 2:30.
pub(crate) fn of_units(random: &mut Lcg64) -> (I2F30, I2F30) {
    let (a, b) = factors(random, 30);
    (I2F30::from_bits(a), I2F30::from_bits(b))
}

/// For 16:16 over 16:16: the dividend next to a quotient of so many halves.
pub(crate) fn quotient(random: &mut Lcg64) -> (I16F16, I16F16) {
    let b = word(random);
    let a = ((i128::from(halves(random)) * i128::from(b)) >> 17) as i64;
    (
        I16F16::from_bits(saturated(a + neighbour(random))),
        I16F16::from_bits(b as i32),
    )
}

/// An integer next to the square of a root, or of a root and a half.
fn square(random: &mut Lcg64) -> u64 {
    let root: I16F16 = Input::draw(random);
    let root = u64::from(root.to_bits() as u32);
    let square = root * root + root * u64::from(random.next_fraction() % 2);
    square.wrapping_add_signed(neighbour(random))
}

/// For the root of an integer.
pub(crate) fn root_of_integer(random: &mut Lcg64) -> u64 {
    square(random)
}

/// For the root of 32:32.
pub(crate) fn root_of_square(random: &mut Lcg64) -> I32F32 {
    I32F32::from_bits(square(random) as i64)
}

/// For the root of 48:16, which is that of 32:32 with 16 more bits.
pub(crate) fn root_of_wide(random: &mut Lcg64) -> I48F16 {
    I48F16::from_bits((square(random) >> 16) as i64 + neighbour(random))
}
