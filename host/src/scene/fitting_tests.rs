//! How the parts of a scene fit together: light, the start of rays, the shape of the picture, and what is compiled of them.

use super::tests::{CORNELL, GOOD, messages};
use super::*;

#[test]
fn cameras_inside_solids() {
    let found = messages(&GOOD.replace("position = [0, 0, 5]", "position = [0, 0, -4]"));
    assert!(
        found[0].contains("inside the solid of sphere \"lamp\" (line 12)"),
        "{found:?}"
    );
    let found = messages(&GOOD.replace("position = [0, 0, 5]", "position = [0, 0, 25]"));
    assert!(
        found[0].contains("inside the solid of sphere \"room\" (line 6)"),
        "{found:?}"
    );
    assert!(found[0].contains("move the camera or change `near`"), "{found:?}");
    // The camera itself is free, and so is the middle ray's start, but the corners' are not.
    let wide = GOOD.replace("plane_height = 0.5", "plane_height = 8\nnear = 16.5");
    let found = messages(&wide.replace("position = [0, 0, 5]", "position = [0, 12, 8]"));
    assert!(found[0].contains("the top ray"), "{found:?}");
    // smallpt's camera stands outside its box and is saved by `near`.
    let outside = messages(&CORNELL.replace("near = 140", "near = 100"));
    assert!(outside[0].contains("sphere \"front\""), "{outside:?}");
}

/// The Cornell box as it was before cameras had a `plane_width`.
fn cornell_of_any_width() -> Scene {
    let mut scene = Scene::parse("cornell.toml", CORNELL).unwrap();
    scene.camera.plane_width = None;
    scene
}

#[test]
fn balls_and_rooms_that_reach_across_the_start_of_rays() {
    let near = GOOD.replace("plane_height = 0.5", "plane_height = 1\nnear = 5");
    // A ball off the middle, the edges and the corners, where rays of a fifth of the picture start.
    let cut = near.replace(
        "centre = [0, 0, -5]\nradius = 2",
        "centre = [1.2, 1.2, 0]\nradius = 0.7",
    );
    let scene = Scene::parse("cut.toml", &cut).unwrap();
    let compiled = compile(&scene, 64, 48, Integrator::Path);
    assert_eq!(compiled.needs.to_string(), "hollow,solid,coarse,twosided,diffuse");
    // The same out of the picture, and behind where rays start.
    for centre in ["[9, 1.2, 0]", "[1.2, 1.2, -8]"] {
        let free = near.replace(
            "centre = [0, 0, -5]\nradius = 2",
            &format!("centre = {centre}\nradius = 0.7"),
        );
        let free = compile(
            &Scene::parse("free.toml", &free).unwrap(),
            64,
            48,
            Integrator::Path,
        );
        assert_eq!(free.needs.to_string(), "hollow,solid,coarse,diffuse");
    }
    // A room that ends between the middle and the edge, to the left.
    let second = "[[sphere]]\nname = \"alcove\"\nhollow = true\ncentre = [9, 0, 0]\nradius = 10.8\ndiffuse = [0, 0, 0]\n";
    let found = messages(&format!("{near}{second}"));
    assert!(
        found[0].contains("the left ray starts inside the solid of sphere \"alcove\" (line 19)"),
        "{found:?}"
    );
}

#[test]
fn light_that_a_core_would_lose() {
    // Alone, any light will do.
    for emission in ["1e-6", "1e-30", "4095"] {
        let text = GOOD.replace("[4, 4, 4]", &format!("[{emission}, 0, {emission}]"));
        Scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    }
    spoiled_sphere(
        "emission = [4, 4, 1e-7]",
        "an emission of 0.0000001 is lost beside",
    );
    spoiled_sphere("emission = [4, 4, 1e-31]", "use 0, or at least 1e-30");
    let found = messages(&GOOD.replace("diffuse = [0.5, 0.5, 0.5]", "diffuse = [0.5, 0.5, 1e-8]"));
    assert!(found[0].starts_with("test.toml:6:"), "{found:?}");
    assert!(
        found[0].contains("a reflectance of 0.00000001 is lost"),
        "{found:?}"
    );
}

/// The lamp with other emission must fail, at the lamp's line.
fn spoiled_sphere(emission: &str, words: &str) {
    let found = messages(&GOOD.replace("emission = [4, 4, 4]", emission));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].starts_with("test.toml:12:") && found[0].contains(words),
        "{found:?}"
    );
}

#[test]
fn solids_as_large_as_the_reach() {
    for radius in ["16384", "20000", "20000.00001525879", "21000"] {
        let centre = format!("[0, 0, {}]", -10.0 - radius.parse::<f64>().unwrap());
        let text = GOOD.replace("radius = 20\n", "radius = 200\n").replace(
            "centre = [0, 0, -5]\nradius = 2",
            &format!("centre = {centre}\nradius = {radius}"),
        );
        check_compiled(&Scene::parse("large.toml", &text).unwrap());
    }
}

/// What the compiler makes of any accepted scene is what a core can work with.
pub(super) fn check_compiled(scene: &Scene) {
    let compiled = compile(scene, 64, 48, Integrator::Path);
    let primitives = compiled.view().aggregate.primitives;
    let hollow = primitives.hollow_spheres.iter().map(|sphere| sphere.0);
    for record in hollow.chain(primitives.solid_spheres.iter().map(|sphere| sphere.sphere)) {
        let found = record.reciprocal.to_num::<f64>() * 2f64.powi(i32::from(record.shift) - 13);
        let exact = 1.0 / record.radius.to_num::<f64>();
        assert!((found / exact - 1.0).abs() < 2f64.powi(-28), "{record:?}");
    }
}

#[test]
fn wider_pictures_than_the_scene_allows() {
    let scene = cornell_of_any_width();
    for (width, height) in [
        (256, 192),
        (64, 48),
        (4, 3),
        (33, 25),
        (1024, 768),
        (48, 64),
        (512, 512),
    ] {
        scene.check_frame(width, height).unwrap();
    }
    let message = scene.check_frame(1920, 800).unwrap_err().to_string();
    for said in ["1920x800", "ray starts inside the solid", "`plane_width`"] {
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn a_plane_width_lets_the_cornell_box_have_any_shape_and_leaves_its_own_as_it_was() {
    let scene = Scene::parse("cornell.toml", CORNELL).unwrap();
    for (width, height) in [
        (1920, 1080),
        (16, 9),
        (64, 36),
        (2560, 1080),
        (4000, 2),
        (1080, 1920),
    ] {
        scene.check_frame(width, height).unwrap();
        let plane_height = scene.camera.height_for(width, height);
        let plane_width = plane_height * f64::from(width) / f64::from(height);
        assert!(
            plane_height <= 0.5135 && plane_width < 0.72 + 1e-12,
            "{width}x{height}"
        );
    }
    for (width, height) in [(256, 192), (64, 48), (512, 512), (7, 5), (3, 4)] {
        assert_eq!(
            compile(&scene, width, height, Integrator::Path),
            compile(&cornell_of_any_width(), width, height, Integrator::Path),
            "{width}x{height}"
        );
    }
}
