//! Kinds of scene that once came out wrong without a word, each at its hardest.
//!
//! Seeds are fixed, so each of these has one outcome. The bounds are what sampling noise allows, not what was found.

#![expect(clippy::print_stdout, reason = "figures of tests, by helpers of theirs")]

mod light;

use fixedmath::U48F16;
use host::oracle::compare::{Comparison, compare};
use host::oracle::direct;
use host::oracle::lockstep::Paired;
use host::scene::{Integrator, Scene, compile};
use tracer::camera::Camera;
use tracer::integrator::{Integrator as _, Path};
use tracer::profile::Precise;
use tracer::scene::{All, Capability};
use tracer::unit::{Plan, SPAN, render};
use whole_system::{estimate, film, pair, plan, reference, repository};
use wire::SUM_MAX;

fn compared(scene: &Scene, width: u16, height: u16, spp: u32) -> Comparison {
    let reference = reference(scene, width, height, spp);
    let precise = estimate::<Precise>(scene, &plan::<Precise>(width, height, spp));
    compare(
        &reference.pooled_noise(precise, Integrator::Path),
        &reference.estimate,
    )
    .unwrap()
}

fn no_tile_is_off(name: &str, found: &Comparison) {
    let (worst, bound) = (found.tiles.max_z(), found.tiles.threshold_z);
    println!("{name}: largest z {worst:.2} of {bound:.2}");
    assert_eq!(found.tiles.failed().count(), 0, "{name}: {worst} beyond {bound}");
}

/// A sphere around the origin that emits `emission` and is a `material` of this reflectance.
fn room(emission: f64, material: &str, reflectance: f64) -> Scene {
    let text = format!(
        "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n\
         [[sphere]]\nname = \"room\"\nhollow = true\ncentre = [0, 0, 0]\nradius = 10\n\
         emission = [{emission:e}, {emission:e}, {emission:e}]\n{material} = [{reflectance}, {reflectance}, {reflectance}]\n"
    );
    Scene::parse("room.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// Balls that are cut open where camera rays start are seen from inside.
#[test]
fn balls_that_rays_start_in() {
    let scene = Scene::load(&repository("tests/scenes/cut-open.toml")).unwrap();
    let compiled = compile(&scene, 64, 48, Integrator::Path);
    assert!(compiled.needs.has(Capability::TwoSided));
    no_tile_is_off("cut open", &compared(&scene, 64, 48, 256));
    // One-sided, the balls that are cut are not seen: the test can fail.
    let mut blind = scene.clone();
    blind.spheres.retain(|sphere| sphere.name != "black");
    let seen = estimate::<Precise>(&scene, &plan::<Precise>(64, 48, 16));
    let unseen = estimate::<Precise>(&blind, &plan::<Precise>(64, 48, 16));
    assert!(compare(&unseen, &seen).unwrap().tiles.failed().count() > 0);
}

/// A furnace is as bright as its lamp times a constant, whatever the unit of light.
#[test]
fn light_has_no_unit() {
    let mean = |emission: f64| {
        let found = compared(&room(emission, "diffuse", 0.5), 16, 12, 64);
        no_tile_is_off(&format!("emission {emission:e}"), &found);
        found.mean[0] / emission
    };
    let one = mean(1.0);
    for emission in [1e-30, 1e-6, 2e-5, 1e-4, 0.01, 4095.0] {
        let ratio = mean(emission) / one - 1.0;
        // The paths are the same; emission is rounded by 2^-14 of itself at most, sums by less.
        assert!(ratio.abs() < 2f64.powi(-14), "{emission:e}: {ratio:e}");
    }
}

/// Light that crosses an empty room for hundreds of bounces is not lost, and not in double precision: there, how far a path was off the room's
/// surface once doubled with each bounce, and after some fifty it was in the open.
#[test]
fn rooms_lose_no_light() {
    for (material, reflectance) in [("diffuse", 0.9), ("diffuse", 0.999), ("mirror", 0.999)] {
        let pair = pair::<Precise>(&room(1.0, material, reflectance), &plan::<Precise>(16, 12, 64));
        let [fixed, exact] = [pair.picture, pair.double].map(|it| it.picture.mean().unwrap()[0]);
        println!("{material} {reflectance}: {fixed}, {exact}");
        // Nothing but roulette ends a path, and both draw alike; a bounce rounds what is left by 2^-32.
        assert!(
            (fixed / exact - 1.0).abs() < 1e-6,
            "{material} {reflectance}: {fixed}, {exact}"
        );
    }
}

/// Paths of a thousand bright mirrors: what they bring together fits a packet.
#[test]
fn sums_of_bright_mirrors_fit() {
    for emission in [200.0, 4095.0] {
        let scene = room(emission, "mirror", 0.999);
        let compiled = compile(&scene, 8, 8, Integrator::Path);
        let plan = plan::<Precise>(8, 8, 64);
        let (path, camera) = (Path::<Precise, All>::new(&plan), Camera::new(&compiled.camera));
        for id in 0..plan.units().unwrap() {
            let mut sums = [[U48F16::ZERO; 3]; SPAN];
            render(&path, &compiled.view(), &camera, &plan, id, &mut sums);
            let largest = sums.as_flattened().iter().max().unwrap();
            assert!(largest.to_bits() < SUM_MAX, "{emission}: {largest}");
        }
        // A sample is emission / (1 - 0.999) in the mean and about as much off; the mean of 4,096 is 1/64 of that off.
        let film = direct::film::<Precise>(&compiled, &plan);
        let mean = film.picture().mean().unwrap()[0] / emission / 1000.0;
        assert!((mean - 1.0).abs() < 5.0 / 64.0, "{emission}: {mean}");
    }
}

/// A glass ball alone under a white sky is white but for what it absorbs, to its very edge, however small it is beside the sky: for a
/// core, from a radius of 2,048 down to 1/2.
#[test]
fn glass_balls_of_any_radius() {
    for sky in [5.0, 20.0, 200.0, 1000.0, 5000.0, 20_000.0] {
        let text = format!(
            "format = 1\n[camera]\nposition = [0, 0, 4]\ndirection = [0, 0, -1]\nplane_height = 0.6\n\
             [[sphere]]\nname = \"sky\"\nhollow = true\ncentre = [0, 0, 0]\nradius = {sky}\n\
             emission = [1, 1, 1]\ndiffuse = [0, 0, 0]\n\
             [[sphere]]\nname = \"ball\"\ncentre = [0, 0, 0]\nradius = 1\n\
             glass = [0.999, 0.999, 0.999]\nindex = 1.5\n",
        );
        let scene = Scene::parse("ring.toml", &text).unwrap();
        no_tile_is_off(&format!("sky {sky}"), &compared(&scene, 64, 64, 64));
        let Paired { picture, double, .. } = pair::<Precise>(&scene, &plan::<Precise>(64, 64, 64));
        let [fixed, exact] = [picture, double].map(|it| it.picture.mean().unwrap()[0]);
        // Five of the 262,144 paths may be black on one side only, by chance: roulette ends one in a thousand of those that
        // rounding has parted. Of a ball of 0.1 for a core, forty were.
        assert!(
            (fixed - exact).abs() < 5.0 / 262_144.0,
            "sky {sky}: {fixed} instead of {exact}"
        );
    }
}

fn named(path: &str) -> Scene {
    Scene::load(&repository(path)).unwrap_or_else(|error| panic!("{error}"))
}

/// The scene with all its lengths times `factor`.
fn times(mut scene: Scene, factor: f64) -> Scene {
    scene.camera.position = scene.camera.position.map(|c| c * factor);
    scene.camera.near *= factor;
    for sphere in &mut scene.spheres {
        sphere.centre = sphere.centre.map(|c| c * factor);
        sphere.radius *= factor;
    }
    scene
}

/// Walls of radius 1e4 that are proved to be a room, walls of 1e5 that are vast, and a ball inside a ball of glass: in millimetres and in
/// light years they are one picture; in feet, one but for noise.
#[test]
fn lengths_have_no_unit() {
    for path in [
        "scenes/cornell.toml",
        "scenes/smallpt.toml",
        "scenes/hard/overlap.toml",
    ] {
        let scene = named(path);
        let plan = plan::<Precise>(32, 24, 16);
        let hash = film::<Precise>(&scene, &plan).sha256();
        for power in [-50, -8, -1, 1, 8, 40] {
            let scaled = times(scene.clone(), 2f64.powi(power));
            assert_eq!(
                film::<Precise>(&scaled, &plan).sha256(),
                hash,
                "{path} times 2^{power}"
            );
        }
        for factor in [0.3048, 1000.0 / 3.0] {
            let scaled = estimate::<Precise>(&times(scene.clone(), factor), &plan);
            let original = estimate::<Precise>(&scene, &Plan { seed: 2, ..plan });
            let found = compare(&scaled, &original).unwrap();
            no_tile_is_off(&format!("{path} times {factor}"), &found);
        }
    }
}

/// Scenes as people have them, with radii of 1e4 to 1.1e5 beside balls of 5: grounds, skies, and a pool that is vast and of glass.
#[test]
fn smallpt_and_its_extra_scenes() {
    let mut paths = vec!["scenes/smallpt.toml".to_owned()];
    let names = ["forest", "island", "nightsky", "sky", "vista", "wada", "wada2"];
    paths.extend(names.map(|name| format!("scenes/extra/{name}.toml")));
    for path in paths {
        no_tile_is_off(&path, &compared(&named(&path), 32, 24, 256));
    }
}
