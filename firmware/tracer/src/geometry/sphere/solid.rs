//! The sphere seen from without; and from within, where light goes through it or rays start in it.

use bytemuck::{Pod, Zeroable};

use super::{Length, SphereNumbers, SphereRecord, chord};
use crate::arithmetic::{Directions, Formats};
use crate::capability::{Capability, Needs};
use crate::geometry::{Bounds, Hit, Interaction, MaterialId, Ray, Shape, Standing};
use crate::profile::{Profile, Quadratic};

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct SolidSphere(pub SphereRecord);

impl Shape for SolidSphere {
    const CAPABILITY: Capability = Capability::Solid;

    fn is_sound(&self) -> bool {
        self.0.is_sound()
    }

    fn material(&self) -> MaterialId {
        self.0.material
    }

    /// By [`Quadratic::Power`]: only the near root is a surface, and only where `p < 0 < b`, unless the ball has an inside. A ray
    /// misses a ball with an inside where half its chord is no longer than the hit point's rounding: its normal could lie on
    /// either side.
    #[inline]
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        if matches!(P::QUADRATIC, Quadratic::Textbook) {
            return self.0.textbook::<P>(ray, epsilon, t_max);
        }
        let to_centre = self.0.centre_from::<P>(ray);
        let projection = P::Numbers::project(to_centre, ray.direction);
        let b = P::Numbers::length_of(projection);
        // Asked where it matters: kept from here on, it would cost each ball a register.
        let has_inside = || self.0.has_inside::<F>() || standing.two_sided;
        if b <= P::Numbers::NOTHING && !has_inside() {
            return None;
        }
        if standing.departs {
            return if has_inside() {
                chord::<P>(b, epsilon, t_max)
            } else {
                None
            };
        }
        let power = P::Numbers::square(self.0.square) - P::Numbers::dot(to_centre, to_centre);
        let discriminant = P::Numbers::squared(projection) + power;
        if discriminant < P::Numbers::NO_SQUARE {
            return None;
        }
        let inside = power >= P::Numbers::NO_SQUARE;
        let hidden = if inside {
            !has_inside()
        } else {
            b <= P::Numbers::NOTHING
        };
        if hidden {
            return None;
        }
        let root = P::Numbers::root(discriminant);
        if has_inside() && root <= P::Numbers::GRAZING {
            return None;
        }
        let t = if inside { b + root } else { b - root };
        (t > epsilon && t < t_max).then_some(t)
    }

    #[inline]
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        hit: Hit<P::Numbers>,
    ) -> Interaction<P::Numbers> {
        let crosses = (self.0.has_inside::<F>() || standing.two_sided) && standing.departs;
        let surface = self.0.surface::<P>(ray, hit, crosses);
        let from_inside =
            standing.two_sided && P::Numbers::cosine(ray.direction, surface.normal) > P::Numbers::ZERO;
        Interaction {
            from_inside,
            ..surface
        }
    }

    fn bounds(&self) -> Bounds {
        self.0.bounds()
    }
}
