//! What the whole-system tests share: the standard scene, and its picture without a fleet in between.

use std::path::{Path, PathBuf};

use host::film::Film;
use host::lockstep;
use host::picture::Estimate;
use host::scene::{Scene, compile};
use rayon::prelude::*;
use tracer::profile::Profile;
use tracer::scene::All;
use tracer::unit::{Plan, RUN, Termination, render};

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// The nine-sphere Cornell box.
///
/// # Panics
/// If the scene file has a fault.
pub fn cornell() -> Scene {
    Scene::load(&repository("scenes/cornell.toml")).expect("the standard scene is in order")
}

/// A plan with `P`'s own epsilon, roulette and seed 1.
pub fn plan<P: Profile>(width: u16, height: u16, spp: u32) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: spp.min(64) as u16,
        seed: 1,
        termination: Termination::Roulette,
        epsilon: P::EPSILON,
    }
}

/// The film that any fleet must end with, rendered unit by unit in this process.
///
/// # Panics
/// If the compiled scene is refused, or a unit does not fit the film.
pub fn film<P: Profile>(scene: &Scene, plan: &Plan) -> Film {
    let blob = compile(scene, plan.width, plan.height).blob;
    let units = plan.units().expect("unit ids fit 32 bits");
    let sums: Vec<_> = (0..units)
        .into_par_iter()
        .map_init(
            || tracer::scene::Scene::<P::Numbers>::decode::<All>(&blob).expect("a compiled scene is decoded"),
            |scene, id| {
                let mut sums = [[0; 3]; RUN];
                render::<P, All>(scene, plan, id, &mut sums);
                sums
            },
        )
        .collect();
    let mut film = Film::new(plan.width, plan.height);
    for (id, sums) in (0..units).zip(&sums) {
        let extent = plan.extent(id);
        let run = &sums[..usize::from(extent.pixels)];
        film.add(extent.first_pixel, extent.samples.into(), run)
            .expect("units lie within the film");
    }
    film
}

/// `P`'s picture, with the variance that the lockstep oracle measures on the same paths.
///
/// # Panics
/// If the compiled scene is refused.
pub fn estimate<P: Profile>(scene: &Scene, plan: &Plan) -> (Estimate, Estimate) {
    let blob = compile(scene, plan.width, plan.height).blob;
    let lockstep = lockstep::render::<P>(&blob, plan, |_| ()).expect("a compiled scene is decoded");
    let fixed = Estimate {
        picture: film::<P>(scene, plan).picture(),
        ..lockstep.clone()
    };
    (fixed, lockstep)
}
