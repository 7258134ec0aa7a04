//! The sphere seen from within.

use bytemuck::{Pod, Zeroable};

use super::{Length, SphereNumbers, SphereRecord};
use crate::arithmetic::Formats;
use crate::capability::{Capability, Needs};
use crate::geometry::{Bounds, Grid, Hit, Interaction, MaterialId, Ray, Shape, ShapeNumbers, Standing};
use crate::profile::{Profile, Quadratic};

/// A sphere that everything outside of is solid: a wall or a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct HollowSphere(pub SphereRecord);

impl Shape for HollowSphere {
    const CAPABILITY: Capability = Capability::Hollow;

    fn is_sound(&self) -> bool {
        self.0.is_sound()
    }

    fn material(&self) -> MaterialId {
        self.0.material
    }

    type Prepared<N: ShapeNumbers> = ();

    #[inline]
    fn prepare<P: Profile, F: Needs>(_ray: &Ray<P::Numbers>, _grid: Grid) {}

    /// By [`Quadratic::Power`]: only the far root is a surface, and it is nearer than `t_max` exactly when `t_max > b` and
    /// `(t_max - b)^2 > b^2 + p`, which says without a root whether to take the root.
    #[inline]
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        _prepared: &(),
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        if matches!(P::QUADRATIC, Quadratic::Textbook) {
            return self.0.textbook::<P>(ray, epsilon, t_max);
        }
        let to_centre = self.0.centre_from::<P>(ray);
        let b = P::Numbers::length_of(P::Numbers::project(to_centre, ray.direction));
        if standing.departs {
            // The far end of the chord, exactly 2 b; of none, where rounding has turned the ray out, the hit is at once.
            let t = b + b;
            let t = if t < epsilon { epsilon } else { t };
            return (t < t_max).then_some(t);
        }
        let beyond = t_max - b;
        if beyond <= P::Numbers::NOTHING {
            return None;
        }
        let square = P::Numbers::square(self.0.square);
        let discriminant = P::Numbers::product(b, b) + (square - P::Numbers::dot(to_centre, to_centre));
        if P::Numbers::product(beyond, beyond) <= discriminant {
            return None;
        }
        // Rounding may have put the start an ulp outside: then the hit is at once, and not behind.
        let t = b + P::Numbers::near_root(discriminant);
        Some(if t < P::Numbers::NOTHING {
            P::Numbers::NOTHING
        } else {
            t
        })
    }

    #[inline]
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        hit: Hit<P::Numbers>,
    ) -> Interaction<P::Numbers> {
        let crosses = self.0.has_inside::<F>() && standing.departs;
        Interaction {
            from_inside: true,
            ..self.0.surface::<P>(ray, hit, crosses)
        }
    }

    #[inline]
    fn encloses(&self) -> bool {
        true
    }

    fn bounds(&self) -> Bounds {
        self.0.bounds()
    }
}
