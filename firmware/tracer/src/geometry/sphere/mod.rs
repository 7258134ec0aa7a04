//! Spheres, of three kinds: hollow ones are seen from within, solid ones from without, and vast ones are next to planes.
//!
//! With `b = (c - o) . d` and the power of the origin turned round, `p = r^2 - |c - o|^2` (positive inside), a ray meets a sphere
//! at `b - sqrt(b^2 + p)` and `b + sqrt(b^2 + p)`. How the profile solves that is [`Quadratic`].

mod coarse;
mod hollow;
mod numbers;
mod solid;
mod vast;

pub use coarse::{CoarseRay, CoarseSphere};
pub use hollow::HollowSphere;
pub use numbers::SphereNumbers;
pub use solid::SolidSphere;
pub use vast::{Bend, VastNumbers, VastSphere};

use bytemuck::{Pod, Zeroable};
use fixedmath::{I1F31, I16F16, I32F32};

use super::{Bounds, Hit, Interaction, MaterialId, Ray};
use crate::arithmetic::Formats;
use crate::arithmetic::vector::{reflected, sub};
use crate::capability::{Capability, Needs};
use crate::profile::{Profile, Quadratic};

/// 1 / r as `mantissa` 2^(`shift` - 13): a point of the sphere shifted left by `shift` and multiplied has no more than 62 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reciprocal {
    /// (1/2, 1].
    pub mantissa: I1F31,
    /// Below 32.
    pub shift: u8,
}

/// A sphere's record, eight words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SphereRecord {
    /// Centre.
    pub centre: [I16F16; 3],
    /// Radius.
    pub radius: I16F16,
    /// Radius squared, exactly.
    pub square: I32F32,
    /// The mantissa of 1 / r.
    pub reciprocal: I1F31,
    /// See [`Reciprocal`].
    pub shift: u8,
    /// 1 where light goes through the surface, so that rays are within, too; else 0.
    pub has_inside: u8,
    /// What it is made of.
    pub material: MaterialId,
}

const _: () = assert!(size_of::<SphereRecord>() == 32);

type Length<P> = <<P as Profile>::Numbers as Formats>::Length;

impl SphereRecord {
    fn is_sound(&self) -> bool {
        self.shift < 32 && self.has_inside <= 1
    }

    fn reciprocal(&self) -> Reciprocal {
        Reciprocal {
            mantissa: self.reciprocal,
            shift: self.shift,
        }
    }

    /// Whether rays are within, for an image that is capable of that.
    #[inline]
    fn has_inside<F: Needs>(&self) -> bool {
        F::NEEDS.has(Capability::Inside) && self.has_inside != 0
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(self.centre, self.radius)
    }

    #[inline]
    fn centre_from<P: Profile>(&self, ray: &Ray<P::Numbers>) -> [Length<P>; 3] {
        sub(self.centre.map(P::Numbers::length), ray.origin)
    }

    /// smallpt's: `b - sqrt(b^2 - |c - o|^2 + r^2)`, else the other root, whichever first exceeds epsilon.
    #[inline]
    fn textbook<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        let to_centre = self.centre_from::<P>(ray);
        let b = P::Numbers::project(to_centre, ray.direction);
        let discriminant =
            P::Numbers::squared(b) - P::Numbers::dot(to_centre, to_centre) + P::Numbers::square(self.square);
        if discriminant < P::Numbers::NO_SQUARE {
            return None;
        }
        let (b, root) = (P::Numbers::length_of(b), P::Numbers::root(discriminant));
        let (near, far) = (b - root, b + root);
        let t = if near > epsilon { near } else { far };
        (t > epsilon && t < t_max).then_some(t)
    }

    /// The surface at a hit; whether the ray comes from inside is the kind's to say.
    ///
    /// By [`Quadratic::Power`] the point is put back on its sphere. Where a ray crosses the inside from one end of a chord to the
    /// other, the normal where it arrives is the normal where it left, mirrored in the plane across the ray: that is taken from
    /// directions alone, and so the angle with the surface is the same at both ends to 2^-29, however coarse the positions are
    /// beside the radius. Were it taken from positions, light that grazed a small glass ball could find itself past the critical
    /// angle within, and stay there.
    #[inline(always)]
    fn surface<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
        hit: Hit<P::Numbers>,
        crosses: bool,
    ) -> Interaction<P::Numbers> {
        let centre = self.centre.map(P::Numbers::length);
        let on_ray = ray.at(hit.t);
        let from_centre = || P::Numbers::normal(sub(on_ray, centre), self.radius, self.reciprocal());
        let (point, normal) = match P::QUADRATIC {
            Quadratic::Textbook => (on_ray, from_centre()),
            Quadratic::Power => {
                let normal = if crosses {
                    reflected::<P::Numbers>(ray.normal, ray.direction)
                } else {
                    from_centre()
                };
                let radius = P::Numbers::length(self.radius);
                let point = [0, 1, 2].map(|i| centre[i] + P::Numbers::scale(radius, normal[i]));
                (point, normal)
            }
        };
        Interaction {
            point,
            normal,
            from_inside: false,
            primitive: hit.primitive,
            material: self.material,
        }
    }
}
