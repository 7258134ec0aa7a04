//! Looking for light finds what paths find: every scene of the repository, and emitters that are hard to look for.
//!
//! Seeds are fixed, so each of these has one outcome. The bounds are what sampling noise allows, not what was found.

use std::path::PathBuf;

use host::oracle::compare::compare;
use host::scene::{Integrator, Scene};
use tracer::profile::Precise;
use whole_system::{estimate_by, plan, reference, repository};

/// All scene files of the repository.
fn scenes() -> Vec<PathBuf> {
    let folders = ["scenes", "scenes/hard", "scenes/extra", "tests/scenes"].map(repository);
    let files = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).expect("it is there"));
    let mut files: Vec<PathBuf> = files.map(|entry| entry.expect("it can be read").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// One of all scenes may be off by so many standard errors with a chance of 0.2 %.
const SURE: f64 = 4.0;

#[test]
fn all_scenes_are_as_bright_as_they_should() {
    for file in scenes() {
        let scene = Scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
        let found = estimate_by::<Precise>(&scene, &plan::<Precise>(16, 12, 64), Integrator::NextEvent);
        let known = reference(&scene, 16, 12, 512);
        let found = compare(&known.pooled_noise(found, Integrator::NextEvent), &known.estimate).unwrap();
        let (bias, error) = (
            found.bias.unwrap_or(0.0),
            found.bias_standard_error.unwrap_or(0.0),
        );
        let name = &scene.name;
        println!("{name:16} bias {:+.4} % +- {:.4} %", 100.0 * bias, 100.0 * error);
        assert!(bias.abs() <= SURE * error, "{name}: {bias} +- {error}");
    }
}
