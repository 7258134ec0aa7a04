//! Which emitters are looked for, and what of them.

use std::fmt::Write as _;

use tracer::light::{CapLight, Emitter, Lights};
use tracer::scene::Capability;

use crate::scene::{CompiledScene, Integrator, Scene, compile};

const CAMERA: &str = "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n";

pub(super) fn sphere(name: &str, centre: [f64; 3], radius: f64, more: &str) -> String {
    format!("[[sphere]]\nname = \"{name}\"\ncentre = {centre:?}\nradius = {radius}\n{more}\n")
}

pub(super) fn compiled(spheres: &[String]) -> CompiledScene {
    let text = format!("{CAMERA}{}", spheres.concat());
    let scene = Scene::parse("lights.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    compile(&scene, 64, 48, Integrator::NextEvent)
}

fn counts(compiled: &CompiledScene) -> (usize, usize) {
    let Lights { caps, balls, .. } = compiled.view().lights;
    assert_eq!(
        compiled.needs.has(Capability::Lights),
        !(caps.is_empty() && balls.is_empty())
    );
    assert_eq!(compiled.needs.has(Capability::BallLights), !balls.is_empty());
    (caps.len(), balls.len())
}

const ROOM: &str = "hollow = true\ndiffuse = [0.5, 0.5, 0.5]";
pub(super) const LAMP: &str = "emission = [9, 9, 9]\ndiffuse = [0, 0, 0]";
pub(super) const GLASS: &str = "glass = [0.9, 0.9, 0.9]\nindex = 1.5";

fn room() -> String {
    sphere("room", [0.0; 3], 10.0, ROOM)
}

fn number(cap: &CapLight) -> (f64, f64) {
    let (mantissa, exponent) = cap.reach.parts();
    (f64::from(mantissa) * 2f64.powi(exponent), cap.height.to_num())
}

/// The Cornell light dips 0.27 below the ceiling, of which the ceiling leaves a cap: about that high, and 2 r h over.
#[test]
fn of_the_cornell_light_the_cap_below_the_ceiling_is_looked_for() {
    let scene = Scene::load(&crate::platform::workspace::scene(None).unwrap()).unwrap();
    let compiled = compile(&scene, 64, 48, Integrator::NextEvent);
    assert_eq!(counts(&compiled), (1, 0));
    let cap = compiled.view().lights.caps[0];
    let (reach, height) = number(&cap);
    // Two circles of radii 600 and 10,000, 10,599.73 apart: the sagitta is 0.27 (10000 / 10599.73).
    assert!(
        (600.0 * height - 0.27 * 10000.0 / 10599.73).abs() < 1e-4,
        "{height}"
    );
    // A share of all paths is guided to the two balls.
    let own = 1.0 - 0.055;
    assert!(
        (reach - 2.0 * 600.0 * height * own).abs() < 1e-3 * reach,
        "{reach}"
    );
    assert_eq!(cap.emitter.flags, 0, "no other wall hides any of it");
    let plain = compile(&scene, 64, 48, Integrator::Path);
    assert!(!plain.needs.has(Capability::Lights) && plain.view().lights.caps.is_empty());
}

#[test]
fn a_ball_in_the_room_is_looked_for_as_a_whole() {
    assert_eq!(
        counts(&compiled(&[room(), sphere("lamp", [0.0, 3.0, -5.0], 1.0, LAMP)])),
        (0, 1)
    );
}

/// Half in the wall, it is a cap; less than half of it, a ball that the wall hides a part of.
#[test]
fn a_lamp_in_the_wall_is_a_cap_or_a_ball() {
    let lamp = |place: f64| compiled(&[room(), sphere("lamp", [0.0, place, 0.0], 1.0, LAMP)]);
    let sunk = lamp(10.3);
    assert_eq!(counts(&sunk), (1, 0));
    assert_eq!(sunk.view().lights.caps[0].emitter.flags, 0);
    let hangs = lamp(9.5);
    assert_eq!(counts(&hangs), (0, 1));
    assert_eq!(hangs.view().lights.balls[0].emitter.flags, Emitter::CLIPPED);
    assert_eq!(lamp(8.9).view().lights.balls[0].emitter.flags, 0);
    // It touches the wall from within, and from without.
    assert_eq!(counts(&lamp(9.0)), (0, 1));
}

#[test]
fn what_cannot_be_seen_is_not_looked_for() {
    let shines = sphere("seen", [3.0, 0.0, -5.0], 0.5, LAMP);
    let beside = |spheres: &[String]| counts(&compiled(&[&[room(), shines.clone()], spheres].concat()));
    let lamp = |centre: [f64; 3]| sphere("lamp", centre, 0.5, LAMP);
    assert_eq!(beside(&[]), (0, 1));
    assert_eq!(beside(&[lamp([0.0, 12.0, 0.0])]), (0, 1), "beyond the wall");
    let shell = |material: &str| sphere("shell", [-3.0, 0.0, -5.0], 1.0, material);
    let inside = [-3.0, 0.2, -5.0];
    assert_eq!(
        beside(&[shell("diffuse = [0.5, 0.5, 0.5]"), lamp(inside)]),
        (0, 1),
        "in a ball"
    );
    assert_eq!(beside(&[shell(GLASS), lamp(inside)]), (0, 1), "in glass");
    assert_eq!(
        beside(&[shell(GLASS), lamp([-3.0, 0.8, -5.0])]),
        (0, 2),
        "half in glass"
    );
}

/// Any direction finds what is all around.
#[test]
fn a_sky_is_not_looked_for() {
    let sky = sphere(
        "sky",
        [0.0; 3],
        100.0,
        "hollow = true\nemission = [1, 1, 1]\ndiffuse = [0, 0, 0]",
    );
    let ball = sphere("ball", [0.0, 0.0, -5.0], 1.0, "diffuse = [0.5, 0.5, 0.5]");
    assert_eq!(counts(&compiled(&[sky, ball])), (0, 0));
}

/// A window: what a wall leaves of a hollow emitter.
#[test]
fn a_hollow_emitter_that_bulges_into_another_room_is_a_cap() {
    let window = sphere(
        "window",
        [0.0, -18.0, 0.0],
        20.0,
        "hollow = true\nemission = [1, 1, 1]\ndiffuse = [0, 0, 0]",
    );
    let compiled = compiled(&[sphere("room", [0.0; 3], 3.0, ROOM), window]);
    assert_eq!(counts(&compiled), (1, 0));
    assert_eq!(compiled.view().lights.caps[0].emitter.flags, Emitter::HOLLOW);
}

/// A lamp in a corner: each wall leaves half of it, and the cap around what both leave is cut by them.
#[test]
fn a_lamp_in_a_corner_is_cut_by_both_walls() {
    let wall = |name: &str, centre: [f64; 3]| sphere(name, centre, 1000.0, ROOM);
    let lamp = sphere("lamp", [8.0, 8.0, 0.0], 1.0, LAMP);
    let compiled = compiled(&[
        wall("right", [-992.0, 0.0, 0.0]),
        wall("top", [0.0, -992.0, 0.0]),
        lamp,
    ]);
    assert_eq!(counts(&compiled), (1, 0));
    let cap = compiled.view().lights.caps[0];
    assert_eq!(cap.emitter.flags, Emitter::CLIPPED);
    // A quarter of a ball reaches a right angle from its middle; the walls bend, and leave a bit less.
    assert!((0.9..1.0).contains(&number(&cap).1), "{cap:?}");
}

/// Each has its share of all fractions, by brightness and area, and together they have all.
#[test]
fn hundreds_of_emitters_share_the_chances() {
    let mut spheres = vec![room()];
    let mut weights = Vec::new();
    for lamp in 0..200 {
        let (x, y) = (f64::from(lamp % 20) * 0.5 - 5.0, f64::from(lamp / 20) * 0.5 - 2.0);
        let brightness = f64::from(lamp % 7 + 1);
        let mut name = String::new();
        write!(name, "lamp {lamp}").unwrap();
        let material = format!("emission = [{brightness}, 0, 0]\ndiffuse = [0, 0, 0]");
        spheres.push(sphere(&name, [x, y, -6.0], 0.2, &material));
        weights.push(brightness);
    }
    let compiled = compiled(&spheres);
    assert_eq!(counts(&compiled), (0, 200));
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    for (light, weight) in compiled.view().lights.balls.iter().zip(&weights) {
        sum += weight;
        assert!((f64::from(light.emitter.threshold.to_bits()) / 2f64.powi(32) - sum / total).abs() < 1e-9);
        let (mantissa, exponent) = light.reach.parts();
        let chance = 2.0 / (f64::from(mantissa) * 2f64.powi(exponent));
        assert!((chance - weight / total).abs() < 1e-9);
    }
    assert_eq!(
        compiled.view().lights.balls[199].emitter.threshold.to_bits(),
        u32::MAX
    );
}

/// Light that is next to nothing beside the rest is left to paths, which it would cost more than it gives.
#[test]
fn more_caps_than_there_is_room_for_are_the_strongest() {
    let mut spheres = vec![room()];
    for lamp in 0..240 {
        let turn = f64::from(lamp) * std::f64::consts::TAU / 240.0;
        let brightness = if lamp < 120 { 1.0 } else { 2.0 };
        let material = format!("emission = [{brightness}, 0, 0]\ndiffuse = [0, 0, 0]");
        let centre = [10.05 * turn.cos(), 10.05 * turn.sin(), 0.0];
        spheres.push(sphere(&format!("lamp {lamp}"), centre, 0.1, &material));
    }
    let compiled = compiled(&spheres);
    let (caps, balls) = counts(&compiled);
    assert_eq!((caps, balls), (116, 0));
    let lights = compiled.view().lights.caps;
    let of: Vec<usize> = lights
        .iter()
        .map(|light| light.emitter.primitive.index())
        .collect();
    assert!(of.iter().all(|&index| index > 120), "the brighter half: {of:?}");
}
