//! How many samples per pixel a work unit takes, so that a unit of any scene is a small piece of work.

use std::cell::Cell;

use tracer::camera::Camera;
use tracer::integrator::{Integrator as _, Path};
use tracer::profile::{Precise, Profile};
use tracer::scene::All;
use tracer::unit::{Plan, Termination, walk};

use super::light::UNIT_SAMPLES;
use super::{CompiledScene, Integrator, Scene, compile};

/// The fewest: one for each sub-pixel.
const FEWEST: u16 = 4;
/// Tests of a ray against a sphere that a pixel of a unit may cost. With 256 spheres that is 7 rays a sample, with one 186; the
/// Cornell box takes 7 of the 107 that it may. On an emulated core such a unit takes a tenth of a second, by profile `paper` one.
const MOST_TESTS: u64 = 1 << 17;
/// What a ray costs beside its tests, in tests: to find where it goes on, mostly.
const TESTS_PER_BOUNCE: u64 = 10;
/// The picture by which the rays of a sample are counted: 12 units at the shape that every scene is checked for.
const PILOT: (u16, u16) = (16, 12);

/// Samples per pixel in one unit of a picture of `scene` with `spp` samples per pixel.
///
/// The unit's cut decides which random numbers a sample gets, so this is part of what a picture is a function of: it must be
/// the same on every host, and 64 wherever that will do.
pub fn samples_per_unit(scene: &Scene, spp: u32, termination: Termination) -> u16 {
    let usual = UNIT_SAMPLES.min(u16::try_from(spp).unwrap_or(UNIT_SAMPLES));
    let spheres = scene.spheres.len() as u64;
    let mut samples = usual;
    let pilot = Pilot::new(scene, termination);
    for unit in 0..pilot.plan.spans() {
        let rays = pilot.rays_a_sample(unit);
        while samples > FEWEST && u64::from(samples) * rays * (spheres + TESTS_PER_BOUNCE) > MOST_TESTS {
            // Half of it, and still a multiple of 4.
            samples = (samples / 8 * 4).max(FEWEST);
        }
        if samples == FEWEST {
            break;
        }
    }
    samples
}

/// A small picture by which rays are counted. Integers all the way, so no host counts others.
struct Pilot {
    compiled: CompiledScene,
    plan: Plan,
}

impl Pilot {
    fn new(scene: &Scene, termination: Termination) -> Self {
        let (width, height) = PILOT;
        Self {
            compiled: compile(scene, width, height, Integrator::Path),
            plan: Plan {
                width,
                height,
                spp: FEWEST.into(),
                samples_per_unit: FEWEST,
                seed: 0,
                termination,
                epsilon: Precise::EPSILON,
            },
        }
    }

    /// Rays that a sample of this unit takes on the average, rounded up.
    fn rays_a_sample(&self, unit: u32) -> u64 {
        let Self { compiled, plan } = self;
        let path = Path::<Precise, All>::new(plan);
        let (rays, samples) = (Cell::new(0), Cell::new(0));
        walk(
            &path,
            &compiled.view(),
            &Camera::new(&compiled.camera),
            plan,
            unit,
            |_, sample| {
                rays.set(rays.get() + u64::from(sample.rays));
                samples.set(samples.get() + 1);
            },
        );
        rays.get().div_ceil(samples.get())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of one reflectance, with balls of glass in it.
    fn room(reflectance: f64, balls: usize) -> Scene {
        let mut text = format!(
            "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n\
             [[sphere]]\nname = \"room\"\nhollow = true\ncentre = [0, 0, 0]\nradius = 10\nemission = [1, 1, 1]\n\
             diffuse = [{reflectance}, {reflectance}, {reflectance}]\n"
        );
        for ball in 0..balls {
            let (x, y) = ((ball % 8) as f64 - 3.5, (ball / 8) as f64 - 3.5);
            text += &format!(
                "[[sphere]]\nname = \"ball {ball}\"\ncentre = [{x}, {y}, -5]\nradius = 0.25\n\
                 glass = [0.999, 0.999, 0.999]\nindex = 1.5\n"
            );
        }
        Scene::parse("room.toml", &text).expect("a sound scene")
    }

    const ROULETTE: Termination = Termination::Roulette;

    #[test]
    fn usual_scenes_keep_their_units() {
        let cornell = Scene::parse("cornell.toml", include_str!("../../../scenes/cornell.toml")).unwrap();
        for (spp, samples) in [(4, 4), (24, 24), (60, 60), (64, 64), (1024, 64), (1 << 20, 64)] {
            assert_eq!(samples_per_unit(&cornell, spp, ROULETTE), samples, "{spp}");
        }
        assert_eq!(samples_per_unit(&room(0.99, 0), 64, ROULETTE), 64);
        assert_eq!(samples_per_unit(&room(0.9, 63), 64, ROULETTE), 64);
    }

    #[test]
    fn long_paths_among_many_spheres_make_small_units() {
        assert_eq!(samples_per_unit(&room(0.999, 0), 64, ROULETTE), 8);
        assert_eq!(samples_per_unit(&room(0.999, 63), 1024, ROULETTE), FEWEST);
        assert_eq!(
            samples_per_unit(&room(0.999, 63), 1024, Termination::Depth(5)),
            64
        );
        for spp in (4..=64).step_by(4) {
            let samples = samples_per_unit(&room(0.999, 0), spp, ROULETTE);
            assert!(samples.is_multiple_of(4) && samples >= FEWEST && u32::from(samples) <= spp);
        }
    }
}
