//! Sine and cosine of an angle in turns.
//!
//! A turn is a 32-bit fraction, so the reduction to one period is the wrap of an integer and costs nothing.

use fixed::types::{I2F30, I16F16};

/// Sine of `turn` / 2^32 turns by the published parabola `8 t (1 - 2 |t|)` in 16:16, |t| <= 1/2.
///
/// Error up to 0.0562 (3,678 ulp): the shape is right at the zeros and the peaks, and nowhere between.
pub const fn parabolic_sine(turn: u32) -> I16F16 {
    // 0:16 turns in [-1/2, 1/2), and the parabola's two factors in 16:16.
    let t = (turn as i32) >> 16;
    I16F16::from_bits((t * (0x8000 - t.abs())) >> 12)
}

/// [`parabolic_sine`] refined once by `y + 0.225 (y |y| - y)`.
///
/// Error up to 0.00122 (80 ulp), a tenth of it from dropping the turn's lower 16 bits.
pub const fn refined_parabolic_sine(turn: u32) -> I16F16 {
    /// 0.225 in 0:16.
    const BEND: i32 = 14_746;
    let y = parabolic_sine(turn).to_bits();
    let squared = (y * (y.abs() >> 2)) >> 14;
    I16F16::from_bits(y + (((squared - y) * BEND) >> 16))
}

const fn upper(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// Cosine and sine of `turn` / 2^32 turns, each within 5 ulp of 2^-30.
///
/// The angle is reduced to an eighth of a turn on either side of an axis and both values come from minimax
/// polynomials of degree 7 and 8 there (Remez exchange; 2.4e-9 and 4.8e-11 before rounding).
///
/// ```
/// use fixedmath::{angle, I2F30};
/// let (cosine, sine) = angle::cos_sin(1 << 30);
/// assert_eq!((cosine, sine), (I2F30::ZERO, I2F30::ONE));
/// ```
pub const fn cos_sin(turn: u32) -> (I2F30, I2F30) {
    // Horner's scheme in the upper halves of products: each step by w (2:30) moves the binary point two places down.
    const S: [i32; 4] = [1_686_629_708, -693_598_004, 85_555_993, -4_941_550];
    const C: [i32; 5] = [1 << 30, -1_324_675_869, 272_375_234, -22_398_331, 970_267];
    let shifted = turn.wrapping_add(1 << 29);
    // z in [-1, 1) as 0:31 stands for an eighth of a turn either side.
    let z = ((shifted << 2) ^ (1 << 31)) as i32;
    let w = upper(z, z);
    let s = upper(z, S[0] + upper(S[1] + upper(S[2] + upper(S[3], w), w), w));
    let c = C[0] + upper(C[1] + upper(C[2] + upper(C[3] + upper(C[4], w), w), w), w);
    let (cosine, sine) = match shifted >> 30 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    };
    (I2F30::from_bits(cosine), I2F30::from_bits(sine))
}
