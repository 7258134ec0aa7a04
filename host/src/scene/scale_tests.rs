//! Scenes in other units of length, and such as no unit fits.

use proptest::prelude::*;

use super::tests::{CORNELL, GOOD, messages};
use super::*;

const SMALLPT: &str = include_str!("../../../scenes/smallpt.toml");

/// A ground and a sky of radius 1e5 that nothing encloses, with balls of different materials between them.
const OPEN: &str = "format = 1
[camera]
position = [0, 3, 20]
direction = [0, -0.1, -1]
plane_height = 0.5
[[sphere]]
name = \"ground\"
centre = [0, -100000, 0]
radius = 100000
diffuse = [0.5, 0.5, 0.5]
[[sphere]]
name = \"sky\"
centre = [0, 100130, 0]
radius = 100000
emission = [1, 1, 1]
diffuse = [0, 0, 0]
[[sphere]]
name = \"ball\"
centre = [0, 2, 0]
radius = 2
glass = [0.9, 0.9, 0.9]
index = 1.5
";

/// The scene with all its lengths times `factor`.
fn times(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.camera.position = scene.camera.position.map(|c| c * factor);
    scene.camera.near *= factor;
    for sphere in &mut scene.spheres {
        sphere.centre = sphere.centre.map(|c| c * factor);
        sphere.radius *= factor;
    }
    scene
}

fn scenes() -> [Scene; 4] {
    [GOOD, CORNELL, SMALLPT, OPEN].map(|text| Scene::parse("scene.toml", text).expect("a sound scene"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// From a thousandth of a millimetre to the orbit of Jupiter: the bytes are the same, and so is the picture.
    #[test]
    fn a_scene_in_another_unit_is_the_same_for_a_core(which in 0..4usize, power in -40..40i32) {
        let scene = &scenes()[which];
        let there = compile(&times(scene, 2f64.powi(power)), 64, 48, Integrator::Path);
        let here = compile(scene, 64, 48, Integrator::Path);
        prop_assert_eq!(there.scale.exponent, here.scale.exponent - power);
        prop_assert_eq!(there.scale.magnification, here.scale.magnification);
        prop_assert_eq!(CompiledScene { scale: here.scale, ..there }, here);
    }

    /// Other factors round other digits, and choose the scale that leaves as much room.
    #[test]
    fn no_factor_leaves_a_core_less_than_half_of_its_room(which in 0..4usize, factor in 1e-6..1e6f64) {
        let scene = &scenes()[which];
        let (there, here) = (times(scene, factor).scale().exponent, scene.scale().exponent);
        let room = f64::from(there - here) + factor.log2();
        prop_assert!((-1.0..=1.0).contains(&room), "{} at {}", here, there);
    }
}

#[test]
fn the_cornell_box_is_as_it_is_written() {
    let compiled = compile(&scenes()[1], 64, 48, Integrator::Path);
    assert_eq!((compiled.scale.exponent, compiled.scale.magnification), (0, 0));
    assert!(compiled.is_room());
}

#[test]
fn walls_that_would_leave_too_little_of_the_rest_are_vast() {
    for (scene, vast) in scenes().iter().zip([0, 0, 6, 2]) {
        let compiled = compile(scene, 64, 48, Integrator::Path);
        let primitives = compiled.view().aggregate.primitives;
        assert_eq!(primitives.vast_spheres.len(), vast, "{scene:?}");
        let smallest = scene
            .spheres
            .iter()
            .map(|sphere| sphere.radius)
            .fold(f64::INFINITY, f64::min);
        assert!(
            smallest * 2f64.powi(compiled.scale.exponent) >= 2.0,
            "{:?}",
            compiled.scale
        );
    }
}

#[test]
fn a_scene_far_from_the_origin_is_moved_there() {
    let mut scene = scenes()[0].clone();
    let away = [3e6, -5e7, 1e5];
    scene.camera.position = [0, 1, 2].map(|i| scene.camera.position[i] + away[i]);
    for sphere in &mut scene.spheres {
        sphere.centre = [0, 1, 2].map(|i| sphere.centre[i] + away[i]);
    }
    let (there, here) = (
        compile(&scene, 64, 48, Integrator::Path),
        compile(&scenes()[0], 64, 48, Integrator::Path),
    );
    assert_eq!((there.id, there.camera), (here.id, here.camera));
}

#[test]
fn what_is_lost_beside_something_else_is_named_with_it() {
    let found = messages(&GOOD.replace("radius = 2\n", "radius = 1e-6\n"));
    assert_eq!(found.len(), 1, "{found:?}");
    for said in [
        "test.toml:12:1",
        "sphere \"lamp\": a radius of 0.000001 is lost beside \"room\"",
        "make it at least 7.7e-6",
    ] {
        assert!(found[0].contains(said), "{found:?}");
    }
    let enough = GOOD.replace("radius = 2\n", "radius = 7.7e-6\n");
    assert!(Scene::parse("test.toml", &enough).is_ok());
    // Where nothing encloses the scene, it reaches as far as the camera.
    let far = OPEN.replace("[0, 3, 20]", "[0, 3, 2e10]");
    let found = messages(&far);
    assert!(
        found.iter().any(|message| message.contains("\"ball\"")),
        "{found:?}"
    );
}
