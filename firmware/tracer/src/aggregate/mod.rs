//! Ways to find the nearest of many primitives: a file each.

mod linear;
mod room;

pub use linear::Linear;
pub use room::{Exit, FLAT, Room, RoomNumbers, Wall, exit_by};

use crate::arithmetic::Formats;
use crate::capability::Needs;
use crate::geometry::{Bounds, Interaction, PrimitiveId, Ray};
use crate::profile::Profile;

/// A straight way to a point of a primitive's surface.
#[derive(Clone, Copy, Debug)]
pub struct Sight<N: Formats> {
    /// Where it starts, and which way.
    pub ray: Ray<N>,
    /// How far it goes.
    pub t_max: N::Length,
    /// Whose surface it ends at, on the side that is seen from there; none for whoever's.
    pub target: PrimitiveId,
    /// Both ends lie within all shapes that enclose the scene, which are convex: none of those stands in it.
    pub is_within: bool,
}

/// Primitives, and a way to find the nearest one that a ray meets.
pub trait Aggregate {
    /// The nearest surface that `ray` meets. Hits nearer than `epsilon` may be the surface it leaves.
    fn intersect<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
    ) -> Option<Interaction<P::Numbers>>;

    /// Whether anything stands in a sight. What is nearer than `epsilon` may be the surface that it starts from.
    fn occludes<P: Profile, F: Needs>(
        &self,
        sight: &Sight<P::Numbers>,
        epsilon: <P::Numbers as Formats>::Length,
    ) -> bool;

    /// The box around all of it; none where there is nothing.
    fn bounds(&self) -> Option<Bounds>;
}
