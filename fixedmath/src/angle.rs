//! Sine and cosine of an angle in turns, and the angle of a vector.
//!
//! A turn is a 32-bit fraction, so the reduction to one period is the wrap of an integer and costs nothing.
//!
//! Of the published sines, [`parabolic_sine`] is one parabola a half turn, and [`refined_parabolic_sine`] bends it once
//! more. Ours start from the nearest of 128 nodes of a 1 KiB table and turn on from there by the small angle d that is left:
//! [`linear_cos_sin`] by (1, d), [`quadratic_cos_sin`] by (1 - d^2/2, d). [`cos_sin`] needs no table: polynomials,
//! to nearly the last bit of 2:30.

use fixed::types::{I2F30, I16F16};

use crate::division;

/// Sine of `turn` / 2^32 turns by the published parabola `8 t (1 - 2 |t|)` in 16:16, |t| <= 1/2.
///
/// Error up to 0.0562 (3,678 ulp): the shape is right at the zeros and the peaks, and nowhere between.
///
/// Cost: 6 instructions.
#[doc(alias = "sin")]
pub const fn parabolic_sine(turn: u32) -> I16F16 {
    // 0:16 turns in [-1/2, 1/2), and the parabola's two factors in 16:16.
    let t = (turn as i32) >> 16;
    I16F16::from_bits((t * (0x8000 - t.abs())) >> 12)
}

/// [`parabolic_sine`] refined once by `y + 0.225 (y |y| - y)`.
///
/// Error up to 0.00122 (80 ulp), a tenth of it from dropping the turn's lower 16 bits.
///
/// Cost: 15 instructions.
#[doc(alias = "sin")]
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

const fn whole(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
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
/// Cost: 10 instructions.
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
/// Cost: 20 instructions.
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
/// Cost: 15 instructions.
///
/// ```
/// use fixedmath::{angle, I16F16};
/// assert_eq!(angle::sine(1 << 30), I16F16::ONE);
/// assert_eq!(angle::sine(1 << 31), I16F16::ZERO);
/// ```
#[doc(alias = "sin")]
#[inline]
pub const fn sine(turn: u32) -> I16F16 {
    I16F16::from_bits((quadratic_cos_sin(turn).1.to_bits() + (1 << 13)) >> 14)
}

/// Cosine of `turn` / 2^32 turns in 16:16: within 0.67 ulp, as [`sine`].
///
/// Cost: 16 instructions.
#[doc(alias = "cos")]
#[inline]
pub const fn cosine(turn: u32) -> I16F16 {
    I16F16::from_bits((quadratic_cos_sin(turn).0.to_bits() + (1 << 13)) >> 14)
}

/// Cosine and sine of `turn` / 2^32 turns, each within 5 ulp of 2^-30.
///
/// The angle is reduced to an eighth of a turn on either side of an axis and both values come from minimax
/// polynomials of degree 7 and 8 there (Remez exchange; 2.4e-9 and 4.8e-11 before rounding).
///
/// Cost: 30 instructions.
///
/// ```
/// use fixedmath::{angle, I2F30};
/// let (cosine, sine) = angle::cos_sin(1 << 30);
/// assert_eq!((cosine, sine), (I2F30::ZERO, I2F30::ONE));
/// ```
#[doc(alias("sin_cos", "sincos"))]
pub const fn cos_sin(turn: u32) -> (I2F30, I2F30) {
    // Horner's scheme in the upper halves of products: each step by w (2:30) moves the binary point two places down. These
    // are magnitudes of alternating signs: what is known to be positive, LLVM multiplies badly as a signed number.
    const S: [u32; 4] = [1_686_629_708, 693_598_004, 85_555_993, 4_941_550];
    const C: [u32; 5] = [1 << 30, 1_324_675_869, 272_375_234, 22_398_331, 970_267];
    let shifted = turn.wrapping_add(1 << 29);
    // z in [-1, 1) as 0:31 stands for an eighth of a turn either side.
    let z = ((shifted << 2) ^ (1 << 31)) as i32;
    let w = upper(z, z) as u32;
    let s = upper(
        z,
        (S[0] - whole(S[1] - whole(S[2] - whole(S[3], w), w), w)) as i32,
    );
    let c = (C[0] - whole(C[1] - whole(C[2] - whole(C[3] - whole(C[4], w), w), w), w)) as i32;
    let (cosine, sine) = match shifted >> 30 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    };
    (I2F30::from_bits(cosine), I2F30::from_bits(sine))
}

/// The angle of the vector (x, y) in 2^-32 turns, counted from the x axis towards the y axis: within 0.003 ulp of 2^-16
/// radians. The zero vector has angle 0.
///
/// The smaller component over the larger, and a minimax polynomial of degree 15 over that eighth of a turn (3.8e-8
/// radians).
///
/// Cost: 63 instructions.
///
/// ```
/// use fixedmath::{angle, I16F16};
/// let (one, none) = (I16F16::ONE, I16F16::ZERO);
/// assert_eq!(angle::of_vector(one, none), 0);
/// assert_eq!(angle::of_vector(none, one), 1 << 30);
/// assert_eq!(angle::of_vector(-one, none), 1 << 31);
/// ```
#[doc(alias = "atan2")]
#[inline]
pub const fn of_vector(x: I16F16, y: I16F16) -> u32 {
    let (width, height) = (x.to_bits().unsigned_abs(), y.to_bits().unsigned_abs());
    let steep = height > width;
    let (short, long) = if steep { (width, height) } else { (height, width) };
    if long == 0 {
        return 0;
    }
    let shift = long.leading_zeros();
    let inverse = division::reciprocal_of_normal(long << shift);
    // Their ratio in 0:31, below 1 because the reciprocal is.
    let ratio = (((short << shift) as u64 * inverse as u64) >> 32) as u32;
    let eighth = arctangent(ratio);
    let quarter = if steep { (1 << 30) - eighth } else { eighth };
    let half = if x.to_bits() < 0 {
        (1 << 31) - quarter
    } else {
        quarter
    };
    if y.to_bits() < 0 {
        half.wrapping_neg()
    } else {
        half
    }
}

/// [`of_vector`], or `None` for the zero vector.
pub const fn checked_of_vector(x: I16F16, y: I16F16) -> Option<u32> {
    if x.to_bits() == 0 && y.to_bits() == 0 {
        None
    } else {
        Some(of_vector(x, y))
    }
}

/// The angle in 2^-32 turns whose tangent is `ratio` in 0:31.
#[inline]
const fn arctangent(ratio: u32) -> u32 {
    // Magnitudes of alternating signs; each step by the square (1:31) moves the binary point one place down.
    const A: [u32; 8] = [
        1_367_129_643,
        911_325_420,
        1_090_782_396,
        1_521_193_234,
        2_109_144_044,
        2_446_065_746,
        1_912_933_705,
        709_522_199,
    ];
    let w = whole(ratio << 1, ratio);
    let high = whole(A[4] - whole(A[5] - whole(A[6] - whole(A[7], w), w), w), w);
    let sum = A[0] - whole(A[1] - whole(A[2] - whole(A[3] - high, w), w), w);
    whole(sum, ratio)
}
