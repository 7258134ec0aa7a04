//! Rays and the shapes they meet. Nothing here knows what light is.
//!
//! A shape is a file: its record as it lies in the scene's bytes, the arithmetic it needs of the number formats, and how a ray
//! meets it. It is listed once, at the end of this file; its records are an array of their own, and what handles primitives of
//! all kinds visits one array after the other, so that no call is dynamic and no primitive carries its kind.

mod bounds;
mod grid;
mod primitives;
mod ray;
pub mod sphere;

pub use bounds::Bounds;
pub use grid::Grid;
pub use primitives::{MAX_PRIMITIVES, OnShape, PrimitiveId, PrimitiveSet, Visitor};
pub use ray::Ray;

use bytemuck::{Pod, Zeroable};

use crate::arithmetic::{Formats, vector};
use crate::capability::{Capability, Needs};
use crate::profile::Profile;
use sphere::{HollowSphere, SolidSphere, SphereNumbers, VastNumbers, VastSphere};

/// How a ray stands to a primitive that it may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// It starts on this primitive's surface.
    pub departs: bool,
    /// Rays start within this opaque solid, so that its surface is seen from both sides.
    pub two_sided: bool,
}

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit<N: Formats> {
    /// How far along the ray.
    pub t: N::Length,
    /// Whose surface.
    pub primitive: PrimitiveId,
}

/// A material's place in the scene's table: all that a shape knows of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct MaterialId(u16);

impl MaterialId {
    /// The material at `index`, from 0.
    pub const fn new(index: u16) -> Self {
        Self(index)
    }

    /// Its place, from 0.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where a ray meets a surface: made once a ray, of its nearest hit.
#[derive(Clone, Copy, Debug)]
pub struct Interaction<N: Formats> {
    /// The point, on the surface.
    pub point: [N::Length; 3],
    /// The unit normal there, out of the solid that the shape bounds.
    pub normal: [N::Unit; 3],
    /// The ray comes from the side that the normal does not point to. Not said of what lets light through: see its BSDF.
    pub from_inside: bool,
    /// Whose surface.
    pub primitive: PrimitiveId,
    /// What it is made of.
    pub material: MaterialId,
}

impl<N: Formats> Interaction<N> {
    /// The normal on the ray's side.
    #[inline]
    pub fn facing(&self) -> [N::Unit; 3] {
        if self.from_inside {
            vector::neg(self.normal)
        } else {
            self.normal
        }
    }
}

/// A kind of primitive: a record in the scene's bytes, and how rays meet it.
///
/// `F` is what the image's scene needs; code for the rest is left out.
pub trait Shape: Pod {
    /// What an image must be capable of for it.
    const CAPABILITY: Capability;

    /// Whether the record holds nothing that the shape's arithmetic has no answer for.
    fn is_sound(&self) -> bool;

    /// What it is made of.
    fn material(&self) -> MaterialId;

    /// What its arithmetic wants to know of a ray besides, worked out once.
    type Prepared<N: ShapeNumbers>: Copy;

    /// Prepares a ray, for a scene with this grid.
    fn prepare<P: Profile, F: Needs>(ray: &Ray<P::Numbers>, grid: Grid) -> Self::Prepared<P::Numbers>;

    /// The nearest hit of `ray` that is nearer than `t_max`. One nearer than `epsilon` may be the surface the ray leaves.
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        prepared: &Self::Prepared<P::Numbers>,
        standing: Standing,
        epsilon: <P::Numbers as Formats>::Length,
        t_max: <P::Numbers as Formats>::Length,
    ) -> Option<<P::Numbers as Formats>::Length>;

    /// Whether `ray` hits it nearer than `t_max`.
    fn any<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        prepared: &Self::Prepared<P::Numbers>,
        standing: Standing,
        epsilon: <P::Numbers as Formats>::Length,
        t_max: <P::Numbers as Formats>::Length,
    ) -> bool {
        self.closest::<P, F>(ray, prepared, standing, epsilon, t_max)
            .is_some()
    }

    /// Whether all of the scene is within it, and it is seen from there only.
    #[inline]
    fn encloses(&self) -> bool {
        false
    }

    /// The surface at `t` along `ray`.
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        hit: Hit<P::Numbers>,
    ) -> Interaction<P::Numbers>;

    /// The box around it.
    fn bounds(&self) -> Bounds;
}

primitives::shapes! {
    /// Spheres seen from within: walls and rooms.
    hollow_spheres: HollowSphere, SphereNumbers;
    /// Spheres seen from without.
    solid_spheres: SolidSphere, SphereNumbers;
    /// Spheres of radii that 16:16 has no room for, seen from either side.
    vast_spheres: VastSphere, VastNumbers;
}
