//! The tracer's path, one bounce at a time, with what was decided at each.
//!
//! It is [`tracer::integrator::Path`] taken apart; a test holds the two together to the bit.

use fixedmath::{U0F32, U32F32};
use tracer::aggregate::Aggregate;
use tracer::arithmetic::{Directions, Formats, Sampling};
use tracer::geometry::{Interaction, PrimitiveId, Ray};
use tracer::integrator::ROULETTE_FROM;
use tracer::material::{Kind, MaterialRecord, RadianceNumbers};
use tracer::profile::Profile;
use tracer::random::Random;
use tracer::scene::{All, Scene};
use tracer::unit::{Plan, Termination};

use super::observed::{Counted, Explicable, Framed, Observed, Readable};

/// How a dielectric sends a ray on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Branch {
    /// There is no refracted ray.
    Total,
    /// By the random number, as most rays.
    Refracted,
    /// By the random number, with the chance of its reflectance.
    Reflected,
}

/// What was decided at one bounce. Each is as if all before it were decided alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Decisions {
    /// The surface met, if any.
    pub(super) surface: Option<PrimitiveId>,
    /// The path did not end by roulette or depth.
    pub(super) survives: bool,
    /// The ray comes from the side that the normal does not point to.
    pub(super) from_inside: bool,
    /// At a dielectric.
    pub(super) branch: Option<Branch>,
    /// At a diffuse surface: whether its normal has the second frame.
    pub(super) is_turned: bool,
    /// Random numbers drawn.
    pub(super) drawn: u32,
}

/// A quantity of rays that may be rounded where nothing else is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Where a ray starts, to 2^-16 of a unit of length.
    Start,
    /// The components of its direction, to 2^-30.
    Direction,
    /// The components of the normal that it leaves with, to 2^-30.
    Normal,
}

/// A path that is being walked.
#[derive(Clone, Debug)]
pub(super) struct Walk<P: Profile> {
    pub(super) ray: Ray<P::Numbers>,
    pub(super) random: Counted<P::Random>,
    radiance: [<P::Numbers as RadianceNumbers>::Radiance; 3],
    throughput: [<P::Numbers as RadianceNumbers>::Weight; 3],
    /// Rays traced for it.
    pub(super) rays: u32,
    /// There is no next bounce.
    pub(super) is_over: bool,
    rounded: Option<Quantity>,
}

impl<P: Explicable> Walk<P> {
    /// A path along a camera's ray.
    pub(super) fn new(ray: Ray<P::Numbers>, random: Counted<P::Random>) -> Self {
        Self {
            ray,
            random,
            radiance: [P::Numbers::DARK; 3],
            throughput: [P::Numbers::FULL; 3],
            rays: 0,
            is_over: false,
            rounded: None,
        }
    }

    /// The same path, of whose rays one quantity is rounded.
    pub(super) fn rounding(mut self, rounded: Option<Quantity>) -> Self {
        self.rounded = rounded;
        self.round();
        self
    }

    fn round(&mut self) {
        let Ray {
            origin,
            direction,
            normal,
            ..
        } = &mut self.ray;
        match self.rounded {
            Some(Quantity::Start) => *origin = origin.map(P::Numbers::rounded_length),
            Some(Quantity::Direction) => *direction = direction.map(P::Numbers::rounded_component),
            Some(Quantity::Normal) => *normal = normal.map(P::Numbers::rounded_component),
            None => {}
        }
    }

    /// The radiance found so far, as the film would add it up.
    pub(super) fn sums(&self) -> [U32F32; 3] {
        self.radiance.map(P::Numbers::film_sum)
    }

    /// Walks to the next surface and says what was decided there.
    pub(super) fn step(&mut self, scene: &Scene<'_>, plan: &Plan) -> Decisions {
        let mut decisions = Decisions::default();
        let drawn = self.random.drawn;
        self.is_over = self.bounce(scene, plan, &mut decisions).is_none();
        decisions.drawn = self.random.drawn.wrapping_sub(drawn);
        decisions
    }

    /// None where the path ends.
    fn bounce(&mut self, scene: &Scene<'_>, plan: &Plan, decisions: &mut Decisions) -> Option<()> {
        self.rays += 1;
        let epsilon = P::Numbers::length(plan.epsilon);
        let interaction = scene.aggregate.intersect::<P, All>(&self.ray, epsilon)?;
        decisions.surface = Some(interaction.primitive);
        let material = scene.materials.get(interaction.material.index())?;
        if material.emits() {
            for channel in 0..3 {
                self.radiance[channel] = self.radiance[channel]
                    + P::Numbers::emitted(self.throughput[channel], material.emission[channel]);
            }
        }
        if material.absorbs_all() {
            return None;
        }
        let share = self.share(material, plan.termination)?;
        decisions.survives = true;
        for (throughput, share) in self.throughput.iter_mut().zip(share) {
            *throughput = P::Numbers::attenuate(*throughput, P::Numbers::weight(share));
        }
        let drawn = self.random.drawn;
        let direction =
            material.sample::<Observed<P>, All>(self.ray.direction, &interaction, &mut self.random)?;
        let drew = self.random.drawn != drawn;
        self.observe(material, &interaction, direction, drew, decisions);
        self.ray = Ray {
            origin: interaction.point,
            direction,
            departed: interaction.primitive,
            normal: interaction.normal,
        };
        self.round();
        Some(())
    }

    /// What is left of each channel, unless the path ends.
    fn share(&mut self, material: &MaterialRecord, termination: Termination) -> Option<[U0F32; 3]> {
        match termination {
            Termination::Depth(limit) if self.rays >= u32::from(limit) => None,
            Termination::Roulette if self.rays > ROULETTE_FROM => {
                let chance = P::Numbers::unit(material.continuation);
                P::Numbers::below(self.random.fraction(), chance).then_some(material.continued)
            }
            _ => Some(material.reflectance),
        }
    }

    /// What the way that light went on says of how that was decided.
    fn observe(
        &self,
        material: &MaterialRecord,
        interaction: &Interaction<P::Numbers>,
        direction: [<P::Numbers as Formats>::Unit; 3],
        drew: bool,
        decisions: &mut Decisions,
    ) {
        decisions.from_inside = interaction.from_inside;
        match material.kind() {
            Some(Kind::Dielectric) => {
                let against = |d| P::Numbers::cosine(d, interaction.normal) < P::Numbers::ZERO;
                let enters = against(self.ray.direction);
                decisions.from_inside = !enters;
                decisions.branch = Some(if !drew {
                    Branch::Total
                } else if enters == against(direction) {
                    Branch::Refracted
                } else {
                    Branch::Reflected
                });
            }
            Some(Kind::Diffuse) => {
                decisions.is_turned = P::Hemisphere::is_turned::<P::Numbers>(interaction.facing());
            }
            Some(Kind::Mirror) | None => {}
        }
    }
}

/// The same path in double precision, as if exact arithmetic had brought it to where it is.
pub(super) fn taken_over<P, D>(walk: &Walk<P>) -> Walk<D>
where
    P: Explicable,
    D: Explicable<Numbers = floating::Floating<f64>, Random = P::Random>,
{
    let Ray {
        origin,
        direction,
        departed,
        normal,
    } = walk.ray;
    let ray = Ray {
        origin: origin.map(P::Numbers::length_of),
        direction: direction.map(P::Numbers::component),
        departed,
        normal: normal.map(P::Numbers::component),
    };
    Walk {
        rays: walk.rays,
        ..Walk::new(ray, walk.random.clone())
    }
}
