//! The sphere.

use crate::material::Surface;
use crate::numbers::Numbers;

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
    /// Its surface.
    pub surface: Surface<N>,
}
