//! The sphere seen from without; and from within, where light goes through it or rays start in it.

use bytemuck::{Pod, Zeroable};

use super::{CoarseSphere, Length, SphereNumbers, SphereRecord};
use crate::arithmetic::{Directions, Formats};
use crate::capability::{Capability, Needs};
use crate::geometry::{Bounds, Grid, Hit, Interaction, MaterialId, Ray, Shape, ShapeNumbers, Standing};
use crate::profile::{Profile, Quadratic};

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SolidSphere {
    /// The sphere, roughly: what most rays are known by to miss it.
    pub coarse: CoarseSphere,
    /// The sphere.
    pub sphere: SphereRecord,
}

impl Shape for SolidSphere {
    const CAPABILITY: Capability = Capability::Solid;

    fn is_sound(&self) -> bool {
        self.sphere.is_sound()
    }

    fn material(&self) -> MaterialId {
        self.sphere.material
    }

    type Prepared<N: ShapeNumbers> = (Grid, N::Coarse);

    #[inline]
    fn prepare<P: Profile, F: Needs>(ray: &Ray<P::Numbers>, grid: Grid) -> Self::Prepared<P::Numbers> {
        (grid, P::Numbers::coarse(grid, ray.origin, ray.direction))
    }

    /// By [`Quadratic::Power`]: only the near root is a surface, and only where `p < 0 < b`, unless the ball has an inside. A ray
    /// misses a ball with an inside where half its chord is no longer than the hit point's rounding: its normal could lie on
    /// either side.
    #[inline]
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        prepared: &Self::Prepared<P::Numbers>,
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        if matches!(P::QUADRATIC, Quadratic::Textbook) {
            return self.sphere.textbook::<P>(ray, epsilon, t_max);
        }
        if !F::NEEDS.has(Capability::Coarse) {
            return self.closely::<P, F>(ray, standing, epsilon, t_max);
        }
        if P::Numbers::may_meet(&self.coarse, prepared.0, &prepared.1, t_max) {
            return self.closely_apart::<P, F>(ray, standing, epsilon, t_max);
        }
        None
    }

    #[inline]
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        hit: Hit<P::Numbers>,
    ) -> Interaction<P::Numbers> {
        let crosses = (self.sphere.has_inside::<F>() || standing.two_sided) && standing.departs;
        let surface = self.sphere.surface::<P>(ray, hit, crosses);
        let from_inside =
            standing.two_sided && P::Numbers::cosine(ray.direction, surface.normal) > P::Numbers::ZERO;
        Interaction {
            from_inside,
            ..surface
        }
    }

    fn bounds(&self) -> Bounds {
        self.sphere.bounds()
    }
}

impl SolidSphere {
    /// Where a ray hits it, by [`Quadratic::Power`].
    #[inline]
    fn closely<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        let to_centre = self.sphere.centre_from::<P>(ray);
        let projection = P::Numbers::project(to_centre, ray.direction);
        let b = P::Numbers::length_of(projection);
        // Asked where it matters: kept from here on, it would cost each ball a register.
        let has_inside = || self.sphere.has_inside::<F>() || standing.two_sided;
        if b <= P::Numbers::NOTHING && !has_inside() {
            return None;
        }
        if standing.departs {
            return if has_inside() {
                // The far end of the chord, exactly 2 b; one that has no length starts no ray within.
                let t = b + b;
                (t > epsilon && t < t_max).then_some(t)
            } else {
                None
            };
        }
        let projection = P::Numbers::on_unit(projection, ray.direction, self.sphere.radius);
        let b = P::Numbers::length_of(projection);
        let power = P::Numbers::square(self.sphere.square) - P::Numbers::dot(to_centre, to_centre);
        let discriminant = P::Numbers::squared(projection) + power;
        if discriminant < P::Numbers::NO_SQUARE {
            return None;
        }
        let inside = power >= P::Numbers::NO_SQUARE;
        if inside && !has_inside() {
            // Rounding has put the start under it, where it meets another surface, and the ray goes deeper: the hit is at once.
            return (epsilon < t_max).then_some(epsilon);
        }
        if !inside && b <= P::Numbers::NOTHING {
            return None;
        }
        let root = P::Numbers::root(discriminant);
        if has_inside() && root <= P::Numbers::GRAZING {
            return None;
        }
        let t = if inside { b + root } else { b - root };
        (t >= epsilon && t < t_max).then_some(t)
    }

    /// The same, kept apart from what happens more often.
    #[cold]
    #[inline(never)]
    fn closely_apart<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        self.closely::<P, F>(ray, standing, epsilon, t_max)
    }
}
