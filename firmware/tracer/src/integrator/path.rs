//! The path integrator: a walk from surface to surface, which looks for light at those that are not specular if the scene says where.

use core::marker::PhantomData;

use fixedmath::U0F32;

use super::{Integrator, Sample};
use crate::aggregate::Aggregate;
use crate::arithmetic::{Formats, Sampling};
use crate::capability::{Capabilities, Capability, Needs};
use crate::geometry::{Interaction, PrimitiveId, Ray};
use crate::light::{Guidance, Lights, MisWeight};
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
        // The surface that the ray comes from has looked for light.
        let mut has_looked = false;
        // The ball that the surface has guided the path to.
        let mut guided_to = PrimitiveId::NONE;
        loop {
            rays += 1;
            let Some(interaction) = scene.aggregate.intersect::<P, F>(&ray, self.epsilon) else {
                break;
            };
            // Scene::view has seen to it that there is one.
            let Some(material) = scene.materials.get(interaction.material.index()) else {
                break;
            };
            if F::NEEDS.has(Capability::Guides) && has_looked {
                match weight::<P, F>(&scene.lights, material, &ray, &interaction, guided_to, random) {
                    MisWeight::One => {}
                    MisWeight::Share(share) => {
                        throughput = throughput.map(|throughput| P::Numbers::attenuate(throughput, share));
                    }
                    MisWeight::Zero => break,
                }
            }
            if material.emits() {
                let share = if has_looked {
                    scene.lights.share::<P::Numbers, F>(&ray, &interaction)
                } else {
                    None
                };
                let arriving = match share {
                    Some(share) => throughput.map(|throughput| P::Numbers::attenuate(throughput, share)),
                    None => throughput,
                };
                add_emission::<P::Numbers>(&mut radiance, arriving, material);
            }
            if material.absorbs_all() {
                break;
            }
            has_looked = F::NEEDS.has(Capability::Lights) && !material.is_specular();
            if has_looked && !self.ends_at(rays) {
                let reflected = attenuated::<P::Numbers>(throughput, &material.reflectance);
                self.look_for_light(scene, &interaction, reflected, &mut radiance, random);
            }
            let Some(share) = self.share(material, rays, random) else {
                break;
            };
            throughput = attenuated::<P::Numbers>(throughput, share);
            let guidance = if F::NEEDS.has(Capability::Guides) && has_looked {
                scene.lights.guide::<P, F>(&interaction, random)
            } else {
                Guidance::Unguided
            };
            // Scene::view refuses what the image lacks.
            let (direction, ball) = match guidance {
                Guidance::Unguided => (
                    material.sample::<P, F>(ray.direction, &interaction, random),
                    PrimitiveId::NONE,
                ),
                Guidance::To(direction, ball) => (Some(direction), ball),
                Guidance::Nowhere => break,
            };
            let Some(direction) = direction else {
                break;
            };
            guided_to = ball;
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

/// What counts of the light that comes along a path which a surface that looks for light has sent on, guided or not.
#[inline]
fn weight<P: Profile, F: Needs>(
    lights: &Lights<'_>,
    material: &MaterialRecord,
    ray: &Ray<P::Numbers>,
    interaction: &Interaction<P::Numbers>,
    guided_to: PrimitiveId,
    random: &mut P::Random,
) -> MisWeight<<P::Numbers as RadianceNumbers>::Weight> {
    if material.is_specular() {
        lights.weight_of_guided::<P, F>(ray, interaction, guided_to, random)
    } else if guided_to == PrimitiveId::NONE {
        MisWeight::One
    } else {
        MisWeight::Zero
    }
}

/// What is left of `throughput` after a reflection.
#[inline]
fn attenuated<N: RadianceNumbers>(throughput: [N::Weight; 3], share: &[U0F32; 3]) -> [N::Weight; 3] {
    [0, 1, 2].map(|channel| N::attenuate(throughput[channel], N::weight(share[channel])))
}

/// Adds what a material emits of what arrives at the camera.
#[inline]
fn add_emission<N: RadianceNumbers>(
    radiance: &mut [N::Radiance; 3],
    arriving: [N::Weight; 3],
    material: &MaterialRecord,
) {
    for channel in 0..3 {
        radiance[channel] = radiance[channel] + N::emitted(arriving[channel], material.emission[channel]);
    }
}

impl<P: Profile, F: Needs> Path<P, F> {
    /// Whether a path ends at its surface number `bounces` for certain.
    #[inline]
    fn ends_at(&self, bounces: u32) -> bool {
        bounces > self.certain
            && (!F::NEEDS.has(Capability::Roulette) || self.termination != Termination::Roulette)
    }

    /// Adds the light that a surface reflects from an emitter, of which `reflected` arrives at the camera.
    #[inline]
    fn look_for_light(
        &self,
        scene: &Scene<'_>,
        interaction: &Interaction<P::Numbers>,
        reflected: [<P::Numbers as RadianceNumbers>::Weight; 3],
        radiance: &mut [<P::Numbers as RadianceNumbers>::Radiance; 3],
        random: &mut P::Random,
    ) {
        let Some(connection) = scene.lights.connect::<P, F>(interaction, random) else {
            return;
        };
        if scene.aggregate.occludes::<P, F>(&connection.sight, self.epsilon) {
            return;
        }
        // Scene::view has seen to it that there is one.
        let Some(emitter) = scene.materials.get(connection.material.index()) else {
            return;
        };
        let arriving = reflected.map(|reflected| P::Numbers::attenuate(reflected, connection.share));
        add_emission::<P::Numbers>(radiance, arriving, emitter);
    }

    /// What is left of each channel after bounce `bounces`, or `None` where the path ends there.
    #[inline]
    fn share<'m>(
        &self,
        material: &'m MaterialRecord,
        bounces: u32,
        random: &mut P::Random,
    ) -> Option<&'m [U0F32; 3]> {
        if bounces <= self.certain {
            return Some(&material.reflectance);
        }
        if self.ends_at(bounces) {
            return None;
        }
        P::Numbers::below(random.fraction(), P::Numbers::unit(material.continuation))
            .then_some(&material.continued)
    }
}
