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

/// A room of radius 10 around a camera that looks at a diffuse ball, and what else is in it.
fn room_with(name: &str, spheres: &str) -> Scene {
    let text = format!(
        "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n\
         {}{}{spheres}",
        sphere("room", [0.0; 3], 10.0, "hollow = true\ndiffuse = [0.5, 0.5, 0.5]"),
        sphere("ball", [0.5, -0.5, -5.0], 1.0, "diffuse = [0.7, 0.5, 0.3]"),
    );
    Scene {
        name: name.to_owned(),
        ..Scene::parse("lights.toml", &text).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

fn sphere(name: &str, centre: [f64; 3], radius: f64, more: &str) -> String {
    format!("[[sphere]]\nname = \"{name}\"\ncentre = {centre:?}\nradius = {radius:?}\n{more}\n")
}

fn lamp(name: &str, centre: [f64; 3], radius: f64) -> String {
    sphere(name, centre, radius, "emission = [9, 9, 9]\ndiffuse = [0, 0, 0]")
}

/// Emitters that are easily got wrong, each with what is known of it by a reference that finds light in another way.
#[test]
fn odd_emitters_are_as_bright_as_they_should() {
    let seen = lamp("seen", [3.0, 2.0, -5.0], 0.5);
    let glass = |centre| sphere("glass", centre, 1.0, "glass = [0.9, 0.9, 0.9]\nindex = 1.5");
    let hundreds: String = (0..200)
        .map(|number| {
            let place = [
                f64::from(number % 20) * 0.5 - 5.0,
                f64::from(number / 20) * 0.5 - 2.0,
                -7.0,
            ];
            lamp(&format!("lamp {number}"), place, 0.05)
        })
        .collect();
    let around = sphere(
        "sky",
        [0.0; 3],
        9.9,
        "hollow = true\nemission = [0.5, 0.5, 0.5]\ndiffuse = [0.3, 0.3, 0.3]",
    );
    let scenes = [
        (
            "beyond the wall",
            seen.clone() + &lamp("unseen", [0.0, 12.0, 0.0], 0.5),
        ),
        (
            "in a ball",
            seen.clone() + &lamp("unseen", [0.5, -0.5, -5.0], 0.5),
        ),
        ("hundreds", hundreds),
        ("all around", around.clone()),
        ("all around, and a lamp", around + &seen),
        (
            "as small as can be",
            seen.clone() + &lamp("dot", [-1.0, 0.0, -4.0], 1e-5),
        ),
        (
            "in glass",
            glass([-1.0, 0.0, -4.0]) + &lamp("lamp", [-1.0, 0.2, -4.0], 0.5),
        ),
        (
            "half in glass",
            glass([-1.0, 0.0, -4.0]) + &lamp("lamp", [-1.0, 0.8, -4.0], 0.5),
        ),
        ("touching the wall", lamp("lamp", [0.0, 9.0, 0.0], 1.0)),
        ("half in the wall", lamp("lamp", [0.0, 10.0, 0.0], 1.0)),
        ("a cap of the wall", lamp("lamp", [0.0, 10.9, 0.0], 1.0)),
        ("touching the ball", lamp("lamp", [0.5, 0.75, -5.0], 0.25)),
    ];
    for (name, spheres) in scenes {
        let scene = room_with(name, &spheres);
        let found = estimate_by::<Precise>(&scene, &plan::<Precise>(16, 12, 64), Integrator::NextEvent);
        let known = reference(&scene, 16, 12, 256);
        is_as_bright(&scene, found, Integrator::NextEvent, &known);
    }
}

/// What is smaller than a core can tell is refused, with what would do.
#[test]
fn an_emitter_of_a_few_ulp_is_refused_with_a_remedy() {
    let text = format!(
        "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n{}{}",
        sphere("room", [0.0; 3], 10.0, "hollow = true\ndiffuse = [0.5, 0.5, 0.5]"),
        lamp("dot", [0.0, 0.0, -5.0], 1e-7),
    );
    let error = Scene::parse("dot.toml", &text)
        .expect_err("it is too small")
        .to_string();
    assert!(
        error.contains("\"dot\"") && error.contains("make it at least"),
        "{error}"
    );
}
