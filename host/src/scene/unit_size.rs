//! How many samples per pixel a work unit takes, so that a unit of any scene is a small piece of work.

use std::cell::Cell;

use tracer::numbers::Mixed;
use tracer::profile::{Precise, Profile};
use tracer::scene::{All, Scene as CoreScene};
use tracer::unit::{Plan, Termination, walk};

use super::{Scene, compile};

/// Samples per pixel in one unit, unless the whole picture has fewer or they take too long.
pub(super) const USUAL: u16 = 64;
/// The fewest: one for each sub-pixel.
const FEWEST: u16 = 4;
/// Tests of a ray against a sphere that a pixel of a unit may cost. With 64 spheres that is 28 rays a sample, with one 186; the
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
    let usual = USUAL.min(u16::try_from(spp).unwrap_or(USUAL));
    let spheres = scene.spheres.len() as u64;
    let mut samples = usual;
    for rays in rays_of_pilot(scene, termination) {
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

/// Rays that a sample takes on the average, in each unit of a small picture. Integers all the way, so no host finds others.
fn rays_of_pilot(scene: &Scene, termination: Termination) -> impl Iterator<Item = u64> {
    let (width, height) = PILOT;
    let plan = Plan {
        width,
        height,
        spp: FEWEST.into(),
        samples_per_unit: FEWEST,
        seed: 0,
        termination,
        epsilon: Precise::EPSILON,
    };
    let compiled = compile(scene, width, height).blob;
    let core = CoreScene::<Mixed>::decode::<All>(&compiled);
    let core = core.expect("the compiler in this very program wrote the blob");
    (0..plan.runs()).map(move |unit| {
        let (rays, samples) = (Cell::new(0), Cell::new(0));
        walk::<Precise, All>(&core, &plan, unit, |_, sample| {
            rays.set(rays.get() + u64::from(sample.rays));
            samples.set(samples.get() + 1);
        });
        rays.get().div_ceil(samples.get())
    })
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
