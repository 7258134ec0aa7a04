//! The ray.

use core::ptr;

use crate::numbers::Numbers;
use crate::sphere::Sphere;

/// A half-line, and the surface it starts from.
#[derive(Clone, Copy, Debug)]
pub struct Ray<'s, N: Numbers> {
    /// Where it starts.
    pub origin: [N::Length; 3],
    /// Where it goes: a unit vector.
    pub direction: [N::Unit; 3],
    /// The sphere it starts on.
    pub leaves: Option<&'s Sphere<N>>,
    /// That sphere's outward unit normal there: where on the sphere it starts, more finely than `origin` says.
    pub outward: [N::Unit; 3],
}

impl<N: Numbers> Ray<'_, N> {
    /// Whether it starts on `sphere`: the very one, not one like it.
    #[inline]
    pub fn leaves(&self, sphere: &Sphere<N>) -> bool {
        self.leaves.is_some_and(|leaves| ptr::eq(leaves, sphere))
    }
}
