//! Samples: from uniform random fractions to points distributed as light transport wants them.
//!
//! A fraction is 32 bits that stand for the middle of one of 2^32 equal parts of [0, 1].

use fixed::types::I2F30;

use crate::{angle, product, root, unit};

/// The tent filter's distribution on (-1, 1), by inversion: `1 - sqrt(f)` with the sign of the top bit, where `f` is the
/// rest of the fraction. Within 4 ulp of 2^-30.
///
/// Cost: 27 instructions.
///
/// ```
/// use fixedmath::{warp, I2F30};
/// assert!(warp::tent(0) < -I2F30::ONE + I2F30::from_num(1e-4));
/// assert!((warp::tent(0xa000_0000).to_num::<f64>() - 0.5).abs() < 4e-9);
/// ```
#[inline]
pub const fn tent(fraction: u32) -> I2F30 {
    let offset = (1 << 30) - root::of_share(fraction << 1 | 1) as i32;
    I2F30::from_bits(if fraction >> 31 == 0 { -offset } else { offset })
}

/// A point of the unit sphere, uniform by area: its height uniform in [-1, 1], as Archimedes found, and its angle a turn.
/// Each component within 8 ulp of 2^-30.
///
/// Cost: 73 instructions.
///
/// ```
/// use fixedmath::{warp, I2F30};
/// let [x, y, z] = warp::sphere(1 << 31, 1 << 30);
/// assert!(x.to_num::<f64>().abs() < 1e-8 && (y.to_num::<f64>() - 1.0).abs() < 1e-8);
/// assert_eq!(z, I2F30::ZERO);
/// ```
#[inline]
pub const fn sphere(height: u32, turn: u32) -> [I2F30; 3] {
    let (cosine, sine) = angle::cos_sin(turn);
    // A height of 2 f - 1 leaves 1 - (2 f - 1)^2 = 4 f (1 - f) to the squared radius. With f the middle of its part that is
    // this much and 2^31 - 1/4: one less keeps it below 2^62.
    let quarter = height as u64 * !height as u64 + ((1 << 31) - 1);
    let radius = I2F30::from_bits(root::of_wide_share(quarter) as i32);
    [
        product::wrapping_of_units(cosine, radius),
        product::wrapping_of_units(sine, radius),
        I2F30::from_bits((height ^ 1 << 31) as i32 >> 1),
    ]
}

/// A point of the unit hemisphere round (0, 0, 1), in proportion to its height, by a point of the disc below it (N. Malley): 16 bits
/// of `fraction` for each of its coordinates. `None` where that point of the square is not in the disc, for a chance of
/// 1 - pi/4; then draw again.
///
/// Each component within 8 ulp of 2^-30 of the unit vector over the middle of its 2^32nd part of the square.
///
/// Cost: 40 instructions.
#[inline]
pub const fn checked_hemisphere(fraction: u32) -> Option<[I2F30; 3]> {
    // 1:31, halfway between two multiples of 2^-15.
    let (u, v) = (
        (fraction & 0xffff_0000 | 0x8000) as i32,
        (fraction << 16 | 0x8000) as i32,
    );
    let square = (upper(u, u) + upper(v, v)) as u32;
    if square >= 1 << 30 {
        return None;
    }
    // 1 less the square in 0:32, whose all ones stand for 1.
    let height = root::of_share(!(square << 2));
    Some([
        I2F30::from_bits(u >> 1),
        I2F30::from_bits(v >> 1),
        I2F30::from_bits(height as i32),
    ])
}

const fn upper(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// A direction on the side of the unit vector `normal`, in proportion to its cosine with it: the normal plus a point of
/// the unit [`sphere`], brought to unit length. It needs no basis, and there is no axis where it breaks down.
///
/// Where the sum vanishes the normal itself is the result.
///
/// Cost: 133 instructions.
///
/// ```
/// use fixedmath::{product, warp, I2F30};
/// let up = [I2F30::ZERO, I2F30::ZERO, I2F30::ONE];
/// let direction = warp::cosine_hemisphere(up, 0x1234_5678, 0x9abc_def0);
/// assert!(product::cosine(up, direction) > I2F30::ZERO);
/// ```
#[inline]
pub fn cosine_hemisphere(normal: [I2F30; 3], height: u32, turn: u32) -> [I2F30; 3] {
    match unit::checked_bisector(normal, sphere(height, turn)) {
        Some(direction) => direction,
        None => normal,
    }
}
