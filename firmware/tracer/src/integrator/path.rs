//! The path integrator: a walk from surface to surface.

use core::marker::PhantomData;

use super::{Integrator, Sample};
use crate::aggregate::Aggregate;
use crate::arithmetic::{Formats, Sampling};
use crate::capability::{Capabilities, Capability, Needs};
use crate::geometry::Ray;
use crate::material::{MaterialRecord, RadianceNumbers};
use crate::plan::{Plan, Termination};
use crate::profile::Profile;
use crate::random::Random;
use crate::scene::Scene;

/// Bounces before roulette may end a path.
pub const ROULETTE_FROM: u32 = 5;

/// The path integrator for profile `P` and a scene that needs `F`.
#[derive(Debug)]
pub struct Path<P: Profile, F> {
    termination: Termination,
    /// Bounces that do not end a path.
    certain: u32,
    epsilon: <P::Numbers as Formats>::Length,
    needs: PhantomData<F>,
}

impl<P: Profile, F: Needs> Integrator<P> for Path<P, F> {
    const CAPABILITIES: Capabilities = F::NEEDS;

    fn new(plan: &Plan) -> Self {
        Self {
            termination: plan.termination,
            certain: match plan.termination {
                Termination::Roulette => ROULETTE_FROM,
                Termination::Depth(limit) => u32::from(limit).saturating_sub(1),
            },
            epsilon: P::Numbers::length(plan.epsilon),
            needs: PhantomData,
        }
    }

    /// Follows one path and gathers what the surfaces on it emit.
    #[inline]
    fn sample(
        &self,
        scene: &Scene<'_>,
        mut ray: Ray<P::Numbers>,
        random: &mut P::Random,
    ) -> Sample<P::Numbers> {
        let mut radiance = [P::Numbers::DARK; 3];
        let mut throughput = [P::Numbers::FULL; 3];
        let mut rays = 0;
        loop {
            rays += 1;
            let Some(interaction) = scene.aggregate.intersect::<P, F>(&ray, self.epsilon) else {
                break;
            };
            // Scene::view has seen to it that there is one.
            let Some(material) = scene.materials.get(interaction.material.index()) else {
                break;
            };
            if material.emits() {
                for channel in 0..3 {
                    radiance[channel] = radiance[channel]
                        + P::Numbers::emitted(throughput[channel], material.emission[channel]);
                }
            }
            if material.absorbs_all() {
                break;
            }
            let Some(share) = self.share(material, rays, random) else {
                break;
            };
            for channel in 0..3 {
                throughput[channel] = P::Numbers::attenuate(throughput[channel], share[channel]);
            }
            // Scene::view refuses what the image lacks.
            let Some(direction) = material.sample::<P, F>(ray.direction, &interaction, random) else {
                break;
            };
            ray = Ray {
                origin: interaction.point,
                direction,
                departed: interaction.primitive,
                normal: interaction.normal,
            };
        }
        Sample { radiance, rays }
    }
}

impl<P: Profile, F: Needs> Path<P, F> {
    /// What is left of each channel after bounce `bounces`, or `None` where the path ends there.
    #[inline]
    fn share(
        &self,
        material: &MaterialRecord,
        bounces: u32,
        random: &mut P::Random,
    ) -> Option<[<P::Numbers as RadianceNumbers>::Weight; 3]> {
        let mut share = &material.reflectance;
        if bounces > self.certain {
            if !F::NEEDS.has(Capability::Roulette) || self.termination != Termination::Roulette {
                return None;
            }
            if !P::Numbers::below(random.fraction(), P::Numbers::unit(material.continuation)) {
                return None;
            }
            share = &material.continued;
        }
        Some(share.map(P::Numbers::weight))
    }
}
