//! Sine and cosine of an angle in turns.
//!
//! A turn is a 32-bit fraction, so the reduction to one period is the wrap of an integer and costs nothing.
//!
//! Of the published sines, [`parabolic_sine`] is one parabola a half turn, and [`refined_parabolic_sine`] bends it once
//! more. Ours start from the nearest of 128 nodes of a 1 KiB table and turn on from there by the small angle d that is left:
//! [`linear_cos_sin`] by (1, d), [`quadratic_cos_sin`] by (1 - d^2/2, d). [`cos_sin`] needs no table: polynomials,
//! to nearly the last bit of 2:30.

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

/// Cosine and sine in 2:30 at the middle of each 128th of a turn, 7.5e-5 short of the unit circle: half of what turning
/// by (1, d) adds at the ends, (pi / 128)^2 / 2, which halves the error of [`linear_cos_sin`].
static NODES: [[i32; 2]; 128] = nodes();

/// How short the nodes fall, (pi / 128)^2 / 4, in 0:32.
const SHORT: i32 = 646_814;

const fn nodes() -> [[i32; 2]; 128] {
    let mut nodes = [[0; 2]; 128];
    let mut i = 0;
    while i < 128 {
        let (cosine, sine) = cos_sin((2 * i as u32 + 1) << 24);
        nodes[i] = [shortened(cosine.to_bits()), shortened(sine.to_bits())];
        i += 1;
    }
    nodes
}

const fn shortened(v: i32) -> i32 {
    v - upper(v, SHORT)
}

/// The node next to `turn`, and the angle from there in radians, 4:28 with three bits more: 2^-35.
#[inline]
const fn from_node(turn: u32) -> ([i32; 2], i32) {
    /// pi / 4 in 0:31.
    const EIGHTH: i32 = 1_686_629_713;
    let part = (turn << 7 ^ 1 << 31) as i32;
    (NODES[(turn >> 25) as usize], upper(part, EIGHTH))
}

/// Cosine and sine of `turn` / 2^32 turns in 2:30, fast: each within 1.6e-4 (10 ulp of 2^-16).
///
/// ```
/// use fixedmath::angle;
/// let (cosine, sine) = angle::linear_cos_sin(1 << 29);
/// assert!((cosine.to_num::<f64>() - 0.5f64.sqrt()).abs() < 1.6e-4);
/// assert!((sine.to_num::<f64>() - 0.5f64.sqrt()).abs() < 1.6e-4);
/// ```
#[inline]
pub const fn linear_cos_sin(turn: u32) -> (I2F30, I2F30) {
    let ([cosine, sine], angle) = from_node(turn);
    (
        I2F30::from_bits(cosine - (upper(sine, angle) >> 3)),
        I2F30::from_bits(sine + (upper(cosine, angle) >> 3)),
    )
}

/// Cosine and sine of `turn` / 2^32 turns in 2:30: each within 2.6e-6 (0.17 ulp of 2^-16).
///
/// ```
/// use fixedmath::angle;
/// let (cosine, sine) = angle::quadratic_cos_sin(1 << 29);
/// assert!((cosine.to_num::<f64>() - 0.5f64.sqrt()).abs() < 2.6e-6);
/// assert!((sine.to_num::<f64>() - 0.5f64.sqrt()).abs() < 2.6e-6);
/// ```
#[inline]
pub const fn quadratic_cos_sin(turn: u32) -> (I2F30, I2F30) {
    let ([cosine, sine], angle) = from_node(turn);
    // d^2 / 2 in 2^-39, less what the nodes are short.
    let loss = upper(angle, angle) - (SHORT << 7);
    (
        I2F30::from_bits(cosine - (upper(sine, angle) >> 3) - (upper(cosine, loss) >> 7)),
        I2F30::from_bits(sine + (upper(cosine, angle) >> 3) - (upper(sine, loss) >> 7)),
    )
}

/// Sine of `turn` / 2^32 turns in 16:16, to the nearest but for ties too close to tell: within 0.67 ulp.
///
/// ```
/// use fixedmath::{angle, I16F16};
/// assert_eq!(angle::sine(1 << 30), I16F16::ONE);
/// assert_eq!(angle::sine(1 << 31), I16F16::ZERO);
/// ```
#[inline]
pub const fn sine(turn: u32) -> I16F16 {
    I16F16::from_bits((quadratic_cos_sin(turn).1.to_bits() + (1 << 13)) >> 14)
}

/// Cosine of `turn` / 2^32 turns in 16:16: within 0.67 ulp, as [`sine`].
#[inline]
pub const fn cosine(turn: u32) -> I16F16 {
    I16F16::from_bits((quadratic_cos_sin(turn).0.to_bits() + (1 << 13)) >> 14)
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
