//! The number formats a tracer works in, and the operations it needs of them.

mod mixed;
mod published;

pub use mixed::Mixed;
pub use published::Published;

use core::fmt::Debug;
use core::ops::{Add, Neg, Sub};

/// A set of number formats.
///
/// Constructors take the scene blob's formats (16:16, 2:30, 4:28, 32:32), so one blob serves every profile and the
/// double-precision oracle. Ranges are the scene compiler's to guarantee: no ray starts 2^15 / 3 or more from the centre of
/// a hollow sphere, or twice that from any other, and no hollow or glass sphere's radius reaches 2^15 / 3. Then neither a
/// length nor the difference of a distance and a projection leaves 16:16, and no square leaves 32:32.
pub trait Numbers: Copy + Debug + 'static {
    /// Positions and distances.
    type Length: Copy + Debug + PartialOrd + Add<Output = Self::Length> + Sub<Output = Self::Length>;
    /// Components of directions, cosines and probabilities: [-1, 1].
    type Unit: Copy
        + Debug
        + PartialOrd
        + Add<Output = Self::Unit>
        + Sub<Output = Self::Unit>
        + Neg<Output = Self::Unit>;
    /// Squares of lengths.
    type Square: Copy + Debug + PartialOrd + Add<Output = Self::Square> + Sub<Output = Self::Square>;
    /// A length along a direction before it is rounded.
    type Projection: Copy + Debug;
    /// Ratios of refractive indices, up to 4, and their squares.
    type Ratio: Copy + Debug;
    /// Throughput and reflectance: [0, 1].
    type Weight: Copy + Debug;
    /// Radiance of one sample, and sums of it.
    type Radiance: Copy + Debug + Add<Output = Self::Radiance>;
    /// What a radius is divided by.
    type Reciprocal: Copy + Debug;

    /// No length.
    const NOTHING: Self::Length;
    /// How far rounding can move a hit along the ray.
    const GRAZING: Self::Length;
    /// Longer than any distance in a scene.
    const FAR: Self::Length;
    /// A cosine or probability of 1.
    const ONE: Self::Unit;
    /// A cosine of 0.
    const ZERO: Self::Unit;
    /// No square.
    const NO_SQUARE: Self::Square;
    /// Nothing absorbed yet.
    const FULL: Self::Weight;
    /// No light.
    const DARK: Self::Radiance;

    /// From 16:16.
    fn length(bits: i32) -> Self::Length;
    /// From 2:30.
    fn unit(bits: i32) -> Self::Unit;
    /// From 32:32.
    fn square(bits: i64) -> Self::Square;
    /// From 4:28.
    fn ratio(bits: i32) -> Self::Ratio;
    /// The square of a ratio.
    fn ratio_squared(ratio: Self::Ratio) -> Self::Ratio;
    /// From 0:32, where all ones stand for 1.
    fn weight(bits: u32) -> Self::Weight;
    /// The reciprocal of a radius in 16:16.
    fn reciprocal(radius: i32, reciprocal: i32, shift: u8) -> Self::Reciprocal;

    /// `a . b`, rounded once where it is rounded at all.
    fn dot(a: [Self::Length; 3], b: [Self::Length; 3]) -> Self::Square;
    /// `a b`.
    fn product(a: Self::Length, b: Self::Length) -> Self::Square;
    /// The root of a square; 0 for a negative one.
    fn root(square: Self::Square) -> Self::Length;
    /// `v . d`.
    fn project(v: [Self::Length; 3], d: [Self::Unit; 3]) -> Self::Projection;
    /// A projection as a length, cut to its format.
    fn length_of(projection: Self::Projection) -> Self::Length;
    /// A projection's square.
    fn squared(projection: Self::Projection) -> Self::Square;
    /// `l u`.
    fn scale(l: Self::Length, u: Self::Unit) -> Self::Length;
    /// `p / r` for a point `p` relative to the centre of the sphere it lies on: a unit vector.
    fn normal(p: [Self::Length; 3], r: Self::Reciprocal) -> [Self::Unit; 3];

    /// `a . b` of directions.
    fn cosine(a: [Self::Unit; 3], b: [Self::Unit; 3]) -> Self::Unit;
    /// `a b`, cut to its format.
    fn times(a: Self::Unit, b: Self::Unit) -> Self::Unit;
    /// `v` brought to unit length, or `otherwise` where it has next to none. Components lie in [-2, 2).
    fn normalised(v: [Self::Unit; 3], otherwise: [Self::Unit; 3]) -> [Self::Unit; 3];
    /// Half the sum of two unit vectors brought to unit length, or `otherwise`.
    fn bisector(a: [Self::Unit; 3], b: [Self::Unit; 3], otherwise: [Self::Unit; 3]) -> [Self::Unit; 3];
    /// A nearly unit vector put back to unit length.
    fn renormalised(v: [Self::Unit; 3]) -> [Self::Unit; 3];

    /// Cosine and sine of `turn` / 2^32 turns.
    fn cos_sin(turn: u32) -> (Self::Unit, Self::Unit);
    /// `fraction` / 2^31 - 1: uniform in [-1, 1).
    fn signed(fraction: u32) -> Self::Unit;
    /// The root of `fraction` / 2^32.
    fn root_of(fraction: u32) -> Self::Unit;
    /// `sqrt(1 - z^2)`.
    fn complement(z: Self::Unit) -> Self::Unit;
    /// The tent filter's distribution on (-1, 1), by inversion. The top bit of the fraction says which slope, the others how
    /// far up it.
    fn tent(fraction: u32) -> Self::Unit {
        let offset = Self::ONE - Self::root_of(fraction << 1 | 1);
        if fraction >> 31 == 0 { -offset } else { offset }
    }
    /// A point of the unit sphere, uniform by area.
    fn sphere(height: u32, turn: u32) -> [Self::Unit; 3] {
        let height = Self::signed(height);
        let (cosine, sine) = Self::cos_sin(turn);
        let radius = Self::complement(height);
        [Self::times(cosine, radius), Self::times(sine, radius), height]
    }
    /// Whether `fraction` / 2^32 lies below a probability.
    fn below(fraction: u32, probability: Self::Unit) -> bool;

    /// `ratio^2 (1 - cosine^2)` taken from 1: the squared cosine of the refracted ray, negative past the critical angle.
    fn refracted_square(cosine: Self::Unit, ratio_squared: Self::Ratio) -> Self::Ratio;
    /// Whether there is a refracted ray.
    fn is_refracted(square: Self::Ratio) -> bool;
    /// The root of [`Numbers::refracted_square`].
    fn root_of_ratio(square: Self::Ratio) -> Self::Unit;
    /// `ratio d + (ratio cosine - refracted) n`: Snell's law.
    fn refract(
        ratio: Self::Ratio,
        d: [Self::Unit; 3],
        cosine: Self::Unit,
        refracted: Self::Unit,
        n: [Self::Unit; 3],
    ) -> [Self::Unit; 3];

    /// Sub-pixel `k`'s centre plus a jitter of sub-pixels, across a film of `subpixels`: [-1/2, 1/2] and a little more.
    /// `reciprocal` is 2^45 / `subpixels`.
    fn across(k: u32, jitter: Self::Unit, subpixels: u32, reciprocal: u64) -> Self::Unit;
    /// `forward + a right + b up`.
    fn combine(
        forward: [Self::Unit; 3],
        a: Self::Unit,
        right: [Self::Unit; 3],
        b: Self::Unit,
        up: [Self::Unit; 3],
    ) -> [Self::Unit; 3];

    /// What is left of `throughput` after a reflection.
    fn attenuate(throughput: Self::Weight, reflectance: Self::Weight) -> Self::Weight;
    /// `throughput` of an emission in 16:16.
    fn emitted(throughput: Self::Weight, emission: u32) -> Self::Radiance;
    /// A sum of radiance in 32:32.
    fn radiance_bits(sum: Self::Radiance) -> u64;
}
