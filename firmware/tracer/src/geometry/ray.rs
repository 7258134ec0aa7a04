//! The ray.

use super::PrimitiveId;
use crate::arithmetic::Formats;

/// A half-line, and the surface it starts from.
#[derive(Clone, Copy, Debug)]
pub struct Ray<N: Formats> {
    /// Where it starts.
    pub origin: [N::Length; 3],
    /// Where it goes: a unit vector.
    pub direction: [N::Unit; 3],
    /// The primitive on whose surface it starts, known by its id and not by its distance; [`PrimitiveId::NONE`] if on none.
    pub departed: PrimitiveId,
    /// The outward unit normal where it starts: where on the surface that is, more finely than the origin says. Anything if it
    /// starts on none.
    pub normal: [N::Unit; 3],
}

impl<N: Formats> Ray<N> {
    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: N::Length) -> [N::Length; 3] {
        [0, 1, 2].map(|i| self.origin[i] + N::scale(t, self.direction[i]))
    }

    /// Whether it starts on this primitive.
    #[inline]
    pub fn departs_from(&self, primitive: PrimitiveId) -> bool {
        self.departed == primitive
    }
}
