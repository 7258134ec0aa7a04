//! Ways to find the nearest of many primitives: a file each.

mod linear;
mod room;

pub use linear::Linear;
pub use room::{Exit, FLAT, Room, RoomNumbers, Wall};

use crate::arithmetic::Formats;
use crate::capability::Needs;
use crate::geometry::{Bounds, Interaction, Ray};
use crate::profile::Profile;

/// Primitives, and a way to find the nearest one that a ray meets.
pub trait Aggregate {
    /// The nearest surface that `ray` meets. Hits nearer than `epsilon` may be the surface it leaves.
    fn intersect<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
    ) -> Option<Interaction<P::Numbers>>;

    /// Whether `ray` hits anything nearer than `t_max`.
    fn any<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
        t_max: <P::Numbers as Formats>::Length,
    ) -> bool;

    /// The box around all of it; none where there is nothing.
    fn bounds(&self) -> Option<Bounds>;
}
