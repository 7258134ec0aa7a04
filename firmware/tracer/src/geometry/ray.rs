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
    /// The surface it starts on, if it does.
    pub departure: Option<Departure<N>>,
}

/// The surface that a ray leaves.
#[derive(Clone, Copy, Debug)]
pub struct Departure<N: Formats> {
    /// Whose it is: a primitive is known by its id, not by its distance.
    pub primitive: PrimitiveId,
    /// Its outward unit normal where the ray starts: where on the surface that is, more finely than the origin says.
    pub normal: [N::Unit; 3],
}

impl<N: Formats> Ray<N> {
    /// Whether it starts on this primitive.
    #[inline]
    pub fn departs_from(&self, primitive: PrimitiveId) -> bool {
        self.departure.map(|departure| departure.primitive) == Some(primitive)
    }
}
