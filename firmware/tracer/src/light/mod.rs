//! Emitters, and where a diffuse surface looks for their light.
//!
//! A diffuse surface finds light in two ways: by a connection to a point that is drawn here, and by the direction in which its path
//! goes on. Both may find the same light, which counts with the share that the balance heuristic gives (E. Veach, "Robust Monte
//! Carlo Methods for Light Transport Simulation", 1997, section 9.2). For Lambert's BSDF the share of either way times what it
//! divides by is the same number: `own / (own + looked)`, of the densities by which the path's own way and the connection have that
//! direction. So one number, the *balance*, weighs both; it is never above 1, and no distance makes it overflow.
//!
//! The scene compiler finds the emitters and what of each can be seen. What is in no record here is found by paths alone, and counts
//! in full.

mod ball;
mod cap;
mod guide;
mod magnitude;
mod numbers;

pub use ball::BallLight;
pub use cap::CapLight;
pub use guide::{Guidance, Guide, MAX_GUIDES, MisWeight};
pub use magnitude::Magnitude;
pub use numbers::{LEAST_SHARE, LightNumbers, MOST_DOUBLINGS};

use bytemuck::{Pod, Zeroable};
use fixedmath::U0F32;

use crate::aggregate::Sight;
use crate::arithmetic::Formats;
use crate::blob::{BlobError, take_records};
use crate::capability::{Capabilities, Capability, Needs};
use crate::geometry::{Interaction, MaterialId, PrimitiveId, Ray};
use crate::material::RadianceNumbers;
use crate::profile::Profile;
use crate::random::Random;

/// The emitters of a scene that are looked for.
#[derive(Clone, Copy, Debug)]
pub struct Lights<'s> {
    /// Caps of spheres.
    pub caps: &'s [CapLight],
    /// Balls.
    pub balls: &'s [BallLight],
    /// Specular balls that paths are guided to.
    pub guides: &'s [Guide],
}

/// What all kinds of emitters have in their records. Three words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Emitter {
    /// The chance that it or one before it is chosen; of the last all ones.
    pub threshold: U0F32,
    /// Whose surface it is.
    pub primitive: PrimitiveId,
    /// What it is made of.
    pub material: MaterialId,
    /// Its [`Emitter::HOLLOW`] and [`Emitter::CLIPPED`].
    pub flags: u16,
}

impl Emitter {
    /// The sphere is hollow: its light is on the inside.
    pub const HOLLOW: u16 = 1;
    /// Hollow shapes may hide parts of it.
    pub const CLIPPED: u16 = 2;

    /// Whether it is hollow.
    #[inline]
    pub fn is_hollow(&self) -> bool {
        self.flags & Self::HOLLOW != 0
    }

    /// Whether hollow shapes may hide parts of it.
    #[inline]
    pub fn is_clipped(&self) -> bool {
        self.flags & Self::CLIPPED != 0
    }

    fn is_sound(&self, materials: usize) -> bool {
        self.material.index() < materials && self.flags <= Self::HOLLOW | Self::CLIPPED
    }
}

/// A kind of emitter: how it is looked for.
trait Light {
    /// What it has in common with others.
    fn emitter(&self) -> &Emitter;

    /// A direction in which it is, drawn from so that what can be seen of it is found evenly.
    fn aim<N: LightNumbers>(&self, place: &Place<N>, random: &mut impl Random) -> Option<Aim<N>>;

    /// The balance of light that `ray`, which left its surface at this cosine, has met at `point`; none where no connection leads there.
    fn balance<N: LightNumbers>(
        &self,
        ray: &Ray<N>,
        cosine: N::Unit,
        point: [N::Length; 3],
    ) -> Option<N::Balance>;
}

/// Where light is looked for from.
struct Place<N: Formats> {
    point: [N::Length; 3],
    /// On the side from which light comes.
    normal: [N::Unit; 3],
}

impl<N: Formats> Place<N> {
    #[inline]
    fn of(interaction: &Interaction<N>) -> Self {
        Self {
            point: interaction.point,
            normal: interaction.facing(),
        }
    }
}

/// A direction in which an emitter is.
struct Aim<N: LightNumbers> {
    direction: [N::Unit; 3],
    distance: N::Length,
    balance: N::Balance,
}

/// A way to an emitter that nothing need stand in.
#[derive(Clone, Copy, Debug)]
pub struct Connection<N: RadianceNumbers> {
    /// The way.
    pub sight: Sight<N>,
    /// What the emitter is made of.
    pub material: MaterialId,
    /// How much of its light counts.
    pub share: N::Weight,
}

impl<'s> Lights<'s> {
    /// Takes the records of so many of each kind from the front of a scene's bytes.
    pub(crate) fn take(bytes: &mut &'s [u8], [caps, balls, guides]: [u16; 3]) -> Result<Self, BlobError> {
        Ok(Self {
            caps: take_records(bytes, caps)?,
            balls: take_records(bytes, balls)?,
            guides: take_records(bytes, guides)?,
        })
    }

    /// Whether all records are sound, in a scene with so many materials, and of no other kind than it needs.
    #[inline]
    pub(crate) fn is_sound(&self, materials: usize, needs: Capabilities, image: Capabilities) -> bool {
        if !image.has(Capability::Lights) {
            return self.caps.is_empty() && self.balls.is_empty() && self.guides.is_empty();
        }
        fn all<L: Light>(lights: &[L], materials: usize, is_sound: fn(&L) -> bool) -> bool {
            lights
                .iter()
                .all(|light| light.emitter().is_sound(materials) && is_sound(light))
        }
        let none = self.caps.is_empty() && self.balls.is_empty();
        (none || needs.has(Capability::Lights))
            && (self.caps.len() + self.balls.len() < 2 || needs.has(Capability::ManyLights))
            && (needs.has(Capability::ClippedLights) || !self.has_clipped())
            && all(self.caps, materials, CapLight::is_sound)
            && (self.balls.is_empty()
                || image.has(Capability::BallLights)
                    && needs.has(Capability::BallLights)
                    && all(self.balls, materials, BallLight::is_sound))
            && (self.guides.is_empty()
                || image.has(Capability::Guides)
                    && needs.has(Capability::Guides)
                    && self.guides.iter().all(Guide::is_sound))
    }

    /// Whether hollow shapes may hide parts of any.
    fn has_clipped(&self) -> bool {
        let mut emitters = self
            .caps
            .iter()
            .map(Light::emitter)
            .chain(self.balls.iter().map(Light::emitter));
        emitters.any(Emitter::is_clipped)
    }

    /// A connection from a diffuse surface to an emitter, in proportion to what each may give.
    ///
    /// None where there is no emitter, where what is drawn is behind the surface or turned away, and where so little would count that
    /// chance decides whether it is worth the ray.
    #[inline]
    pub fn connect<P: Profile, F: Needs>(
        &self,
        interaction: &Interaction<P::Numbers>,
        random: &mut P::Random,
    ) -> Option<Connection<P::Numbers>> {
        let balls = if F::NEEDS.has(Capability::BallLights) {
            self.balls
        } else {
            &[]
        };
        // The threshold of an only one is above every fraction.
        let is_choice = F::NEEDS.has(Capability::ManyLights) && self.caps.len() + balls.len() > 1;
        let chance = if is_choice { random.fraction() } else { U0F32::ZERO };
        match chosen::<_, F>(self.caps, chance) {
            Some(light) => connect::<P>(light, interaction, random),
            None => connect::<P>(chosen::<_, F>(balls, chance)?, interaction, random),
        }
    }

    /// What counts of the light that `ray`, which a diffuse surface has sent on, has met; none where that is all of it.
    #[cold]
    #[inline(never)]
    pub fn share<N: LightNumbers, F: Needs>(
        &self,
        ray: &Ray<N>,
        interaction: &Interaction<N>,
    ) -> Option<N::Weight> {
        let cosine = departure(ray);
        let balance = if let Some(light) = light_of(self.caps, interaction.primitive) {
            light.balance(ray, cosine, interaction.point)
        } else if F::NEEDS.has(Capability::BallLights)
            && let Some(light) = light_of(self.balls, interaction.primitive)
        {
            light.balance(ray, cosine, interaction.point)
        } else {
            None
        };
        balance.map(N::share)
    }
}

fn chosen<L: Light, F: Needs>(lights: &[L], chance: U0F32) -> Option<&L> {
    if !F::NEEDS.has(Capability::ManyLights) {
        return lights.first();
    }
    lights.get(lights.partition_point(|light| light.emitter().threshold < chance))
}

fn light_of<L: Light>(lights: &[L], primitive: PrimitiveId) -> Option<&L> {
    lights.iter().find(|light| light.emitter().primitive == primitive)
}

#[inline]
fn connect<P: Profile>(
    light: &impl Light,
    interaction: &Interaction<P::Numbers>,
    random: &mut P::Random,
) -> Option<Connection<P::Numbers>> {
    let aim = light.aim(&Place::of(interaction), random)?;
    let share = P::Numbers::thinned(aim.balance, || random.fraction())?;
    Some(Connection {
        sight: Sight {
            ray: Ray {
                origin: interaction.point,
                direction: aim.direction,
                departed: interaction.primitive,
                normal: interaction.normal,
            },
            t_max: aim.distance,
            target: light.emitter().primitive,
            is_within: !light.emitter().is_clipped(),
        },
        material: light.emitter().material,
        share,
    })
}

/// The cosine at which `ray` has left its surface, on whichever side that is.
#[inline]
fn departure<N: LightNumbers>(ray: &Ray<N>) -> N::Unit {
    let cosine = N::cosine(ray.normal, ray.direction);
    if cosine < N::ZERO { -cosine } else { cosine }
}

/// A sample that a fraction in five has not, drawn until there is one.
#[inline]
fn drawn<T>(random: &mut impl Random, sample: impl Fn(U0F32) -> Option<T>) -> T {
    let mut pair = random.pair();
    loop {
        if let Some(found) = sample(pair) {
            return found;
        }
        pair = random.fraction();
    }
}
