//! The path integrator: radiance along one camera ray, by a walk from surface to surface.

use core::marker::PhantomData;

use crate::intersect::Intersection;
use crate::material::{Bsdf, Diffuse, mirrored};
use crate::numbers::Numbers;
use crate::profile::Profile;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{Needs, Scene};
use crate::sphere::Sphere;
use crate::vector;

/// Bounces before roulette may end a path.
pub const ROULETTE_FROM: u32 = 5;

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// By Russian roulette, once it has bounced five times.
    Roulette,
    /// At this many surfaces.
    Depth(u8),
}

/// What one sample found.
#[derive(Clone, Copy, Debug)]
pub struct Sample<N: Numbers> {
    /// Radiance per channel.
    pub radiance: [N::Radiance; 3],
    /// Rays traced for it.
    pub rays: u32,
}

/// The path integrator for profile `P` and a scene that needs `F`.
#[derive(Debug)]
pub struct Path<'s, P: Profile, F> {
    scene: &'s Scene<P::Numbers>,
    termination: Termination,
    epsilon: <P::Numbers as Numbers>::Length,
    needs: PhantomData<F>,
}

impl<'s, P: Profile, F: Needs> Path<'s, P, F> {
    /// An integrator over `scene`; `epsilon` is in 16:16.
    pub fn new(scene: &'s Scene<P::Numbers>, termination: Termination, epsilon: i32) -> Self {
        Self {
            scene,
            termination,
            epsilon: P::Numbers::length(epsilon),
            needs: PhantomData,
        }
    }

    /// Follows one path from `ray` and gathers what the surfaces on it emit.
    #[inline]
    pub fn sample(&self, mut ray: Ray<'s, P::Numbers>, random: &mut P::Random) -> Sample<P::Numbers> {
        let mut radiance = [P::Numbers::DARK; 3];
        let mut throughput = [P::Numbers::FULL; 3];
        let mut rays = 0;
        loop {
            rays += 1;
            let Some(hit) = P::Intersection::nearest::<_, F>(self.scene, &ray, self.epsilon) else {
                break;
            };
            let surface = &hit.sphere.surface;
            if surface.emits {
                for channel in 0..3 {
                    radiance[channel] = radiance[channel]
                        + P::Numbers::emitted(throughput[channel], surface.emission[channel]);
                }
            }
            if surface.absorbs_all() {
                break;
            }
            let Some(share) = self.share(hit.sphere, rays, random) else {
                break;
            };
            for channel in 0..3 {
                throughput[channel] = P::Numbers::attenuate(throughput[channel], share[channel]);
            }
            let from_inside = F::TWOSIDED
                && hit.sphere.two_sided
                && P::Numbers::cosine(ray.direction, hit.outward) > P::Numbers::ZERO;
            let facing = if hit.sphere.hollow || from_inside {
                vector::neg(hit.outward)
            } else {
                hit.outward
            };
            let direction = match &surface.bsdf {
                Bsdf::Mirror if F::MIRROR => mirrored::<P::Numbers>(ray.direction, facing),
                Bsdf::Glass(glass) if F::GLASS => glass.direction(ray.direction, hit.outward, random),
                Bsdf::Diffuse if F::DIFFUSE => P::Diffuse::direction::<P::Numbers, _>(facing, random),
                // Scene::decode refuses what the image lacks.
                _ => break,
            };
            ray = Ray {
                origin: hit.point,
                direction,
                leaves: Some(hit.sphere),
                outward: hit.outward,
            };
        }
        Sample { radiance, rays }
    }

    /// What is left of each channel after bounce `bounces`, or `None` where the path ends there.
    fn share(
        &self,
        sphere: &Sphere<P::Numbers>,
        bounces: u32,
        random: &mut P::Random,
    ) -> Option<[<P::Numbers as Numbers>::Weight; 3]> {
        let surface = &sphere.surface;
        match self.termination {
            Termination::Roulette if F::ROULETTE => {
                if bounces <= ROULETTE_FROM {
                    Some(surface.reflectance)
                } else {
                    P::Numbers::below(random.fraction(), surface.survival).then_some(surface.survivor)
                }
            }
            Termination::Depth(limit) if bounces < u32::from(limit) => Some(surface.reflectance),
            _ => None,
        }
    }
}
