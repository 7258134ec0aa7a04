//! Ways to find the nearest of many primitives: a file each.

mod linear;

pub use linear::Linear;

use crate::arithmetic::Formats;
use crate::capability::Needs;
use crate::geometry::{Bounds, Hit, Interaction, Ray};
use crate::profile::Profile;

/// Primitives, and a way to find the nearest one that a ray meets.
pub trait Aggregate {
    /// The nearest hit of `ray`. Hits nearer than `epsilon` may be the surface it leaves.
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
    ) -> Option<Hit<P::Numbers>>;

    /// Whether `ray` hits anything nearer than `t_max`.
    fn any<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
        t_max: <P::Numbers as Formats>::Length,
    ) -> bool;

    /// The surface at a hit; none where there is no such primitive.
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        hit: Hit<P::Numbers>,
    ) -> Option<Interaction<P::Numbers>>;

    /// The box around all of it; none where there is nothing.
    fn bounds(&self) -> Option<Bounds>;
}
