//! The number formats a tracer works in, and the operations it needs of them.
//!
//! Each trait stands beside what needs it: formats, directions and samples here, the film's in [`crate::camera`], light's in
//! [`crate::material`], a shape's or a BSDF's in its own file. [`Numbers`](crate::profile::Numbers) is all of them.

mod mixed;
mod published;
pub mod vector;

pub use mixed::Mixed;
pub use published::Published;

use core::fmt::Debug;
use core::ops::{Add, Neg, Sub};

use fixedmath::{I2F30, I16F16, U0F32};

/// Formats of lengths and of directions' components.
///
/// Conversions are from the scene's formats, so one scene serves every profile and the double-precision oracle. Ranges are the
/// scene compiler's to guarantee: no length, and no difference of a distance and a projection, leaves 16:16.
pub trait Formats: Copy + Debug + 'static {
    /// Positions and distances.
    type Length: Copy
        + Debug
        + Send
        + Sync
        + PartialOrd
        + Add<Output = Self::Length>
        + Sub<Output = Self::Length>;
    /// Components of directions, cosines and probabilities: [-1, 1].
    type Unit: Copy
        + Debug
        + Send
        + Sync
        + PartialOrd
        + Add<Output = Self::Unit>
        + Sub<Output = Self::Unit>
        + Neg<Output = Self::Unit>;

    /// No length.
    const NOTHING: Self::Length;
    /// Longer than any distance in a scene.
    const FAR: Self::Length;
    /// A cosine of 0.
    const ZERO: Self::Unit;
    /// A cosine or probability of 1.
    const ONE: Self::Unit;

    /// A length of the scene.
    fn length(length: I16F16) -> Self::Length;
    /// A direction's component, or a probability.
    fn unit(component: I2F30) -> Self::Unit;
    /// `l u`.
    fn scale(l: Self::Length, u: Self::Unit) -> Self::Length;
}

/// Operations on directions.
pub trait Directions: Formats {
    /// `a . b`.
    fn cosine(a: [Self::Unit; 3], b: [Self::Unit; 3]) -> Self::Unit;
    /// `a b`, cut to its format.
    fn times(a: Self::Unit, b: Self::Unit) -> Self::Unit;
    /// `v` brought to unit length, or `otherwise` where it has next to none. Components lie in [-2, 2).
    fn normalised(v: [Self::Unit; 3], otherwise: [Self::Unit; 3]) -> [Self::Unit; 3];
    /// A nearly unit vector put back to unit length.
    fn renormalised(v: [Self::Unit; 3]) -> [Self::Unit; 3];
}

/// Of a fraction.
const HALF: U0F32 = U0F32::from_bits(1 << 31);

/// Samples from uniform fractions.
pub trait Sampling: Directions {
    /// Cosine and sine of a part of a turn.
    fn cos_sin(turn: U0F32) -> (Self::Unit, Self::Unit);
    /// The root of a fraction.
    fn root_of(fraction: U0F32) -> Self::Unit;
    /// Whether a fraction lies below a probability.
    fn below(fraction: U0F32, probability: Self::Unit) -> bool;

    /// The tent filter's distribution on (-1, 1), by inversion. The top bit of the fraction says which slope, the others how
    /// far up it.
    fn tent(fraction: U0F32) -> Self::Unit {
        let offset = Self::ONE - Self::root_of(fraction << 1 | U0F32::DELTA);
        if fraction < HALF { -offset } else { offset }
    }

    /// A point of the unit hemisphere round the third axis, in proportion to its height; none for one fraction in five.
    fn on_hemisphere(fraction: U0F32) -> Option<[Self::Unit; 3]>;
    /// The unit vector that lies to `axis` as `v` does to the third axis.
    fn around(axis: [Self::Unit; 3], v: [Self::Unit; 3]) -> [Self::Unit; 3];
}
