//! An emitter of which a cap can be seen: a point of it is drawn uniform by area.

use bytemuck::{Pod, Zeroable};
use fixedmath::{I16F16, U0F32};

use super::{Aim, Emitter, Light, LightNumbers, Magnitude, Place, drawn};
use crate::arithmetic::vector::sub;
use crate::geometry::Ray;
use crate::random::Random;

/// A cap of a sphere, at most half of it. Twenty-two words.
///
/// With a point `(x, y)` of the unit disc and `s = x^2 + y^2`, its points are `pole + sqrt(1 - height s / 2) (x across[0] + y across[1]) -
/// s down`, and as much of its area as of the disc's is nearer to the pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CapLight {
    /// The sphere's centre.
    pub centre: [I16F16; 3],
    /// The cap's middle.
    pub pole: [I16F16; 3],
    /// At right angles to each other and to the axis, as long as the pole is from the rim.
    pub across: [[I16F16; 3]; 2],
    /// From the pole along the axis to the rim's plane, turned round.
    pub down: [I16F16; 3],
    /// How long that is, over the radius. All ones stand for 1.
    pub height: U0F32,
    /// The area over pi, the radius, and the chance to be chosen.
    pub reach: Magnitude,
    /// What it has in common with others.
    pub emitter: Emitter,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<CapLight>() == 88);

impl CapLight {
    pub(super) fn is_sound(&self) -> bool {
        self.reach.is_sound() && self.reserved == 0
    }

    /// How far the surface is turned towards where `direction` comes from: the cosine there, times the radius.
    #[inline]
    fn turned<N: LightNumbers>(
        &self,
        from: [N::Length; 3],
        direction: [N::Unit; 3],
        distance: N::Length,
    ) -> N::Length {
        let to_centre = sub(self.centre.map(N::length), from);
        let beyond = N::length_of(N::project(to_centre, direction)) - distance;
        if self.emitter.is_hollow() {
            N::NOTHING - beyond
        } else {
            beyond
        }
    }
}

impl Light for CapLight {
    #[inline]
    fn emitter(&self) -> &Emitter {
        &self.emitter
    }

    #[inline]
    fn aim<N: LightNumbers>(&self, place: &Place<N>, random: &mut impl Random) -> Option<Aim<N>> {
        let point = drawn(random, |fraction| N::on_cap(self, fraction));
        let way = sub(point, place.point);
        let direction = N::direction(way)?;
        let cosine = N::cosine(place.normal, direction);
        if cosine <= N::ZERO {
            return None;
        }
        let distance = N::length_of(N::project(way, direction));
        let turned = self.turned::<N>(place.point, direction, distance);
        (turned > N::NOTHING).then(|| Aim {
            direction,
            distance,
            balance: N::balance_of_cap(cosine, turned, self.reach, N::dot(way, way)),
        })
    }

    fn balance<N: LightNumbers>(
        &self,
        ray: &Ray<N>,
        cosine: N::Unit,
        point: [N::Length; 3],
    ) -> Option<N::Balance> {
        let way = sub(point, ray.origin);
        let distance = N::length_of(N::project(way, ray.direction));
        let turned = self.turned::<N>(ray.origin, ray.direction, distance);
        (turned > N::NOTHING).then(|| N::balance_of_cap(cosine, turned, self.reach, N::dot(way, way)))
    }
}
