//! Looking for light finds what is there, in every scene of the repository.
//!
//! Seeds are fixed, so each of these has one outcome. The bounds are what sampling noise allows, not what was found.

use std::path::Path;

use host::bench::reference::plain::Plain;
use host::image::picture::Estimate;
use host::oracle::compare::compare;
use host::oracle::reference::{Job, Rendered, Termination};
use host::scene::{Integrator, Scene};
use host::stability::{SCENE_FOLDERS, scene_files};
use tracer::profile::Precise;
use whole_system::{estimate_by, gxx, plan, reference, repository};

/// One of all scenes may be off by so many standard errors with a chance of 0.2 %.
const SURE: f64 = 4.0;

/// What is found of a scene is as bright as what is known of it.
#[track_caller]
fn is_as_bright(scene: &Scene, found: Estimate, by: Integrator, known: &Rendered) {
    let found = compare(&known.pooled_noise(found, by), &known.estimate).unwrap();
    let (bias, error) = (
        found.bias.unwrap_or(0.0),
        found.bias_standard_error.unwrap_or(0.0),
    );
    let name = &scene.name;
    println!("{name:16} bias {:+.4} % +- {:.4} %", 100.0 * bias, 100.0 * error);
    assert!(bias.abs() <= SURE * error, "{name}: {bias} +- {error}");
}

fn load(file: &Path) -> Scene {
    Scene::load(file).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn all_scenes_are_as_bright_as_they_should() {
    for file in scene_files(&SCENE_FOLDERS).unwrap() {
        let scene = load(&file);
        let found = estimate_by::<Precise>(&scene, &plan::<Precise>(16, 12, 64), Integrator::NextEvent);
        is_as_bright(
            &scene,
            found,
            Integrator::NextEvent,
            &reference(&scene, 16, 12, 256),
        );
    }
}

/// The reference and the C++ program that its efficiency is measured against: another language, another generator, no light looked for. The
/// compiler makes what is best for this machine, so another may have another outcome.
#[test]
fn a_plain_path_tracer_in_another_language_finds_scenes_as_bright() {
    let plain = Plain::build(&gxx()).unwrap_or_else(|error| panic!("{error}"));
    for file in [
        "scenes/cornell.toml",
        "tests/scenes/cut-open.toml",
        "tests/scenes/open.toml",
    ] {
        let scene = load(&repository(file));
        let job = Job {
            // Of smaller ones, many rays start in a wall, and this program sees through it.
            width: 64,
            height: 48,
            spp: 64,
            termination: Termination::Roulette,
            seed: 2,
        };
        let found = plain
            .render(&scene, &job)
            .unwrap_or_else(|error| panic!("{error}"));
        is_as_bright(
            &scene,
            found.estimate,
            Integrator::Path,
            &reference(&scene, job.width, job.height, job.spp),
        );
    }
}
