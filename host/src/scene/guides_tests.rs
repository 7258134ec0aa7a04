//! Which balls paths are guided to, how often, and what makes up for it.

use tracer::light::{Guide, MAX_GUIDES};
use tracer::material::{Kind, MaterialRecord};
use tracer::scene::Capability;

use super::emitters_tests::{GLASS, LAMP, compiled, sphere};
use crate::scene::{CompiledScene, Integrator, Scene, compile};

const MIRROR: &str = "mirror = [0.9, 0.9, 0.9]";

fn room(albedo: f64) -> String {
    let more = format!("hollow = true\ndiffuse = [0.1, {albedo}, 0.2]");
    sphere("room", [0.0; 3], 10.0, &more)
}

/// Sunk in the ceiling: a cap.
fn lamp() -> String {
    sphere("lamp", [0.0, 10.5, 0.0], 1.0, LAMP)
}

fn guides(compiled: &CompiledScene) -> Vec<Guide> {
    let guides = compiled.view().lights.guides.to_vec();
    assert_eq!(compiled.needs.has(Capability::Guides), !guides.is_empty());
    guides
}

fn share(compiled: &CompiledScene) -> f64 {
    guides(compiled)
        .last()
        .map_or(0.0, |guide| guide.threshold.to_num())
}

/// What is reflected is more by as much as paths of a surface's own are fewer, and no channel changes its hue.
#[test]
fn diffuse_surfaces_make_up_for_guided_paths() {
    let ball = sphere("ball", [3.0, 0.0, -5.0], 1.0, MIRROR);
    let (with, without) = (
        compiled(&[room(0.5), lamp(), ball]),
        compiled(&[room(0.5), lamp()]),
    );
    let own = 1.0 - share(&with);
    assert!((0.95..0.99).contains(&own), "{own}");
    assert!(guides(&without).is_empty());
    for known in without
        .view()
        .materials
        .iter()
        .filter(|known| known.bsdf == Kind::Diffuse as u8)
    {
        let same = |found: &&MaterialRecord| found.emission == known.emission && found.bsdf == known.bsdf;
        let found = with
            .view()
            .materials
            .iter()
            .find(same)
            .expect("the same material");
        for channel in 0..3 {
            let [known, found] = [known, found].map(|material| material.reflectance[channel].to_num::<f64>());
            assert!((found * own - known).abs() < 1e-8, "{found} {known}");
        }
        let [known, found] = [known, found].map(|material| material.continuation.to_num::<f64>());
        assert!((found * own - known).abs() < 1e-8, "{found} {known}");
    }
    let reach = |compiled: &CompiledScene| {
        let (mantissa, exponent) = compiled.view().lights.caps[0].reach.parts();
        f64::from(mantissa) * 2f64.powi(exponent)
    };
    assert!((reach(&with) / reach(&without) - own).abs() < 1e-8);
}

/// Each guided path takes something of what ends paths: never more than a quarter.
#[test]
fn paths_still_end_between_bright_walls() {
    let ball = || sphere("ball", [3.0, 0.0, -5.0], 1.0, GLASS);
    let of = |albedo| share(&compiled(&[room(albedo), lamp(), ball()]));
    assert!((of(0.5) - 0.03).abs() < 1e-6);
    assert!((of(0.96) - 0.01).abs() < 1e-6, "{}", of(0.96));
    assert!(of(0.999) == 0.0);
}

#[test]
fn the_largest_balls_nearest_to_the_light_are_guided_to() {
    let mut spheres = vec![room(0.5), lamp()];
    for ball in 0..9 {
        let place = f64::from(ball) - 4.0;
        let material = if ball % 2 == 0 { MIRROR } else { GLASS };
        spheres.push(sphere(
            &format!("ball {ball}"),
            [place * 1.5, place * 0.5, -5.0],
            0.4,
            material,
        ));
    }
    let found = guides(&compiled(&spheres));
    assert_eq!(found.len(), MAX_GUIDES);
    let primitives: Vec<usize> = found.iter().map(|guide| guide.primitive.index()).collect();
    assert!(primitives.iter().all(|&index| index >= 5), "{primitives:?}");
    let ascending = found.windows(2).all(|pair| pair[0].threshold < pair[1].threshold);
    assert!(ascending, "{found:?}");
}

/// Where there is nothing to be gained, or no room for the code.
#[test]
fn some_scenes_have_no_guides() {
    let ball = || sphere("ball", [3.0, 0.0, -5.0], 1.0, MIRROR);
    let none = |what: &str, spheres: &[String]| {
        assert!(guides(&compiled(spheres)).is_empty(), "{what}");
    };
    let sky = "hollow = true\nemission = [1, 1, 1]\ndiffuse = [0.5, 0.5, 0.5]";
    none(
        "no light to be looked for",
        &[sphere("sky", [0.0; 3], 10.0, sky), ball()],
    );
    none(
        "no diffuse surface",
        &[
            sphere("room", [0.0; 3], 10.0, "hollow = true\nmirror = [0.5, 0.5, 0.5]"),
            lamp(),
            ball(),
        ],
    );
    none(
        "a lamp that is a ball",
        &[room(0.5), sphere("lamp", [0.0, 5.0, 0.0], 1.0, LAMP), ball()],
    );
    none(
        "the lamp is in the ball",
        &[room(0.5), lamp(), sphere("ball", [0.0, 9.0, 0.0], 2.0, GLASS)],
    );
    let scene = Scene::load(&crate::platform::workspace::scene(None).unwrap()).unwrap();
    assert_eq!(guides(&compile(&scene, 64, 48, Integrator::NextEvent)).len(), 2);
    assert!(guides(&compile(&scene, 64, 48, Integrator::Path)).is_empty());
}
