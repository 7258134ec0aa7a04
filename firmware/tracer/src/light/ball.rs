//! An emitter of which a whole ball can be seen: a direction is drawn uniform by solid angle in the cone that it fills (P. Shirley
//! and C. Wang, "Monte Carlo techniques for direct lighting calculations", 1996).

use bytemuck::{Pod, Zeroable};
use fixedmath::I16F16;

use super::{Aim, Emitter, Light, LightNumbers, Magnitude, Place, drawn};
use crate::arithmetic::vector::sub;
use crate::geometry::Ray;
use crate::random::Random;

/// A ball. Ten words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct BallLight {
    /// Its centre.
    pub centre: [I16F16; 3],
    /// Its radius.
    pub radius: I16F16,
    /// 2 over the chance to be chosen: what makes the solid angle over pi of a cone's height.
    pub reach: Magnitude,
    /// What it has in common with others.
    pub emitter: Emitter,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<BallLight>() == 40);

impl BallLight {
    pub(super) fn is_sound(&self) -> bool {
        self.radius > I16F16::ZERO && self.reach.is_sound() && !self.emitter.is_hollow() && self.reserved == 0
    }

    fn weigh<N: LightNumbers>(&self, cosine: N::Unit, cone: N::Cone) -> N::Balance {
        N::balance_of_cone(cosine, cone, self.reach)
    }

    /// The way to its centre, and the cone that it fills; none from within.
    fn cone<N: LightNumbers>(&self, point: [N::Length; 3]) -> Option<([N::Length; 3], N::Cone)> {
        let to_centre = sub(self.centre.map(N::length), point);
        let cone = N::cone(N::length(self.radius), N::dot(to_centre, to_centre))?;
        Some((to_centre, cone))
    }
}

impl Light for BallLight {
    #[inline]
    fn emitter(&self) -> &Emitter {
        &self.emitter
    }

    fn aim<N: LightNumbers>(&self, place: &Place<N>, random: &mut impl Random) -> Option<Aim<N>> {
        let (to_centre, cone) = self.cone::<N>(place.point)?;
        let axis = N::direction(to_centre)?;
        let direction = N::around(axis, drawn(random, |fraction| N::in_cone(cone, fraction)));
        let cosine = N::cosine(place.normal, direction);
        if cosine <= N::ZERO {
            return None;
        }
        let along = N::length_of(N::project(to_centre, direction));
        let radius = N::length(self.radius);
        let discriminant =
            N::product(radius, radius) + (N::product(along, along) - N::dot(to_centre, to_centre));
        // A cone may be too large by a bit, and then what it has too much misses the ball.
        (discriminant >= N::NO_SQUARE).then(|| Aim {
            direction,
            distance: along - N::root(discriminant),
            balance: self.weigh::<N>(cosine, cone),
        })
    }

    fn balance<N: LightNumbers>(
        &self,
        ray: &Ray<N>,
        cosine: N::Unit,
        _point: [N::Length; 3],
    ) -> Option<N::Balance> {
        let (_, cone) = self.cone::<N>(ray.origin)?;
        Some(self.weigh::<N>(cosine, cone))
    }
}
