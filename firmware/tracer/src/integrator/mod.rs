//! Integrators: radiance along a camera ray, a file each.

mod path;

pub use path::{Path, ROULETTE_FROM};

use crate::capability::Capabilities;
use crate::geometry::Ray;
use crate::material::RadianceNumbers;
use crate::plan::Plan;
use crate::profile::Profile;
use crate::scene::Scene;

/// What one sample found.
#[derive(Clone, Copy, Debug)]
pub struct Sample<N: RadianceNumbers> {
    /// Radiance per channel.
    pub radiance: [N::Radiance; 3],
    /// Rays traced for it.
    pub rays: u32,
}

/// A way to find the radiance that a camera ray brings, by profile `P`.
pub trait Integrator<P: Profile> {
    /// What it can do: no scene that needs more may be given to it.
    const CAPABILITIES: Capabilities;

    /// The integrator that a plan asks for.
    fn new(plan: &Plan) -> Self;

    /// Follows light through `scene` back along `ray`.
    fn sample(&self, scene: &Scene<'_>, ray: Ray<P::Numbers>, random: &mut P::Random) -> Sample<P::Numbers>;
}
