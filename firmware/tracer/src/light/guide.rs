//! Light that specular balls send on, which no connection finds: diffuse surfaces *guide* a part of their paths to where on such a ball
//! it may come from.
//!
//! A path goes on in a direction of its own with the chance `1 - q`, and with the chance `q` to a point of a cap of the ball, uniform by area. Either
//! way may end at the same point of the cap, which counts with the balance heuristic (E. Veach, "Robust Monte Carlo Methods for Light Transport
//! Simulation", 1997, section 9.2); a guided path that ends elsewhere counts for nothing. The factor 1 / (1 - q) that all other paths need
//! is in the reflectances that the scene compiler writes.

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I16F16, U0F32};

use super::{LightNumbers, Lights, Magnitude, Place, departure, drawn};
use crate::arithmetic::Formats;
use crate::arithmetic::vector::sub;
use crate::capability::Needs;
use crate::geometry::{Interaction, PrimitiveId, Ray};
use crate::material::RadianceNumbers;
use crate::profile::Profile;
use crate::random::Random;

/// The most balls that paths are guided to.
pub const MAX_GUIDES: usize = 4;

/// A ball that diffuse surfaces guide paths to. Fourteen words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Guide {
    /// The ball's centre.
    pub centre: [I16F16; 3],
    /// Its radius.
    pub radius: I16F16,
    /// The middle of the emitter that it reflects.
    pub emitter: [I16F16; 3],
    /// The root of twice one minus `edge`.
    pub spread: I2F30,
    /// The cosine of the cap's half angle, at the ball's centre.
    pub edge: I2F30,
    /// The chance that a path is guided by it or one before it.
    pub threshold: U0F32,
    /// The cap's area over pi and the radius, times `1 - q`, over the chance that a path is guided by it.
    pub reach: Magnitude,
    /// Whose surface it is.
    pub primitive: PrimitiveId,
    /// Steps towards the point that reflects the emitter. Without any, the cap is the one next to the surface.
    pub steps: u16,
    /// Zero.
    pub reserved: u16,
}

const _: () = assert!(size_of::<Guide>() == 56);

/// Where a diffuse surface sends its path on.
#[derive(Clone, Copy, Debug)]
pub enum Guidance<N: Formats> {
    /// Wherever its BSDF does.
    Unguided,
    /// In this direction, to this ball.
    To([N::Unit; 3], PrimitiveId),
    /// Nowhere.
    Nowhere,
}

/// What counts of the light that comes along a path which one of several ways has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisWeight<W> {
    /// All of it.
    One,
    /// This share.
    Share(W),
    /// Nothing.
    Zero,
}

impl Lights<'_> {
    /// Whether a path is guided from a diffuse surface, and where to.
    #[inline]
    pub fn guide<P: Profile, F: Needs>(
        &self,
        interaction: &Interaction<P::Numbers>,
        random: &mut P::Random,
    ) -> Guidance<P::Numbers> {
        // A scene without guides has the same samples in every image.
        if self.guides.is_empty() {
            return Guidance::Unguided;
        }
        let chance = random.fraction();
        let Some(guide) = self.guides.iter().find(|guide| chance <= guide.threshold) else {
            return Guidance::Unguided;
        };
        match guide.aim::<P::Numbers, F, _>(&Place::of(interaction), random) {
            Some(direction) => Guidance::To(direction, guide.primitive),
            None => Guidance::Nowhere,
        }
    }

    /// What counts of the light that comes along a path that a diffuse surface has sent on along `ray`, guided `to` a ball or to none,
    /// and that has met a specular surface.
    #[cold]
    #[inline(never)]
    pub fn weight_of_guided<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        interaction: &Interaction<P::Numbers>,
        to: PrimitiveId,
        random: &mut P::Random,
    ) -> MisWeight<<P::Numbers as RadianceNumbers>::Weight> {
        let is_elsewhere = to != PrimitiveId::NONE && to != interaction.primitive;
        let mut guides = self.guides.iter();
        let guide = guides.find(|guide| guide.primitive == interaction.primitive);
        match guide.and_then(|guide| guide.balance(ray, interaction)) {
            Some(balance) if !is_elsewhere => {
                P::Numbers::thinned(balance, || random.fraction()).map_or(MisWeight::Zero, MisWeight::Share)
            }
            None if to == PrimitiveId::NONE => MisWeight::One,
            _ => MisWeight::Zero,
        }
    }
}

impl Guide {
    /// The most steps of a sound record.
    pub const MOST_STEPS: u16 = 8;

    pub(super) fn is_sound(&self) -> bool {
        self.radius > I16F16::ZERO
            && self.spread > I2F30::ZERO
            && self.reach.is_sound()
            && self.steps <= Self::MOST_STEPS
            && self.reserved == 0
    }

    /// A direction to the cap; none where what is drawn is behind the surface, or turned away from it.
    #[inline(never)]
    #[expect(
        clippy::extra_unused_type_parameters,
        reason = "what has the type of a program's own is compiled with that program's checks"
    )]
    fn aim<N: LightNumbers, F: Needs, R: Random>(
        &self,
        place: &Place<N>,
        random: &mut R,
    ) -> Option<[N::Unit; 3]> {
        let axis = self.axis::<N>(place.point)?;
        let cone = N::stored_cone(self.spread);
        let normal = N::around(axis, drawn(random, |fraction| N::in_cone(cone, fraction)));
        let direction = N::direction(sub(self.at::<N>(normal), place.point))?;
        let is_seen = N::cosine(place.normal, direction) > N::ZERO && N::cosine(normal, direction) < N::ZERO;
        is_seen.then_some(direction)
    }

    /// The balance of a path that goes on along `ray` and has met the ball; none where no guided one goes.
    fn balance<N: LightNumbers>(&self, ray: &Ray<N>, interaction: &Interaction<N>) -> Option<N::Balance> {
        let axis = self.axis::<N>(ray.origin)?;
        let facing = -N::cosine(interaction.normal, ray.direction);
        if N::cosine(axis, interaction.normal) < N::unit(self.edge) || facing <= N::ZERO {
            return None;
        }
        let way = sub(interaction.point, ray.origin);
        let turned = N::scale(N::length(self.radius), facing);
        Some(N::balance_of_cap(
            departure(ray),
            turned,
            self.reach,
            N::dot(way, way),
        ))
    }

    /// To the middle of the cap. The normal of the point that reflects the emitter halves the angle between the ways to either: it is
    /// approached by steps from the ball's nearest point.
    fn axis<N: LightNumbers>(&self, point: [N::Length; 3]) -> Option<[N::Unit; 3]> {
        let radius = N::length(self.radius);
        let mut axis = N::direction(sub(point, self.centre.map(N::length)))?;
        for _ in 0..self.steps {
            let pole = self.at::<N>(axis);
            let here = N::direction(sub(point, pole))?;
            let there = N::direction(sub(self.emitter.map(N::length), pole))?;
            axis = N::direction([0, 1, 2].map(|i| N::scale(radius, here[i]) + N::scale(radius, there[i])))?;
        }
        Some(axis)
    }

    /// The point of the ball that has this normal.
    fn at<N: LightNumbers>(&self, normal: [N::Unit; 3]) -> [N::Length; 3] {
        let radius = N::length(self.radius);
        [0, 1, 2].map(|i| N::length(self.centre[i]) + N::scale(radius, normal[i]))
    }
}
