//! The sphere.

use crate::material::Surface;
use crate::numbers::Numbers;
use crate::scene::Needs;

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere<N: Numbers> {
    /// Centre.
    pub centre: [N::Length; 3],
    /// Radius squared.
    pub square: N::Square,
    /// Radius.
    pub radius: N::Length,
    /// What divides by the radius.
    pub reciprocal: N::Reciprocal,
    /// Whether it is seen from inside, everything outside being solid.
    pub hollow: bool,
    /// Whether rays start within this solid, so that its surface is seen from both sides. What lets light through always is.
    pub two_sided: bool,
    /// Its surface.
    pub surface: Surface<N>,
}

impl<N: Numbers> Sphere<N> {
    /// Whether a solid is seen from inside, too. `F` is what the scene needs.
    #[inline]
    pub fn has_inside<F: Needs>(&self) -> bool {
        (F::GLASS && self.surface.transmits()) || (F::TWOSIDED && self.two_sided)
    }
}
