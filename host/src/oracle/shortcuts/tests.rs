use super::*;
use crate::platform::workspace;
use crate::scene::{Integrator, Scene, compile};

/// Rays of each scene; `cargo xtask verify --shortcuts` takes many more.
const RAYS: u64 = 1 << 17;

#[test]
fn scenes_that_nobody_made_are_met_alike_by_the_short_way() {
    let (mut rooms, mut coarse) = (0, 0);
    for scene in random_scenes(1).take(60) {
        let compiled = compile(&scene, 64, 48, Integrator::Path);
        rooms += u32::from(compiled.is_room());
        coarse += u32::from(compiled.has_coarse_solids());
        if let Err(disagreement) = compare(&compiled, RAYS / 4, 7) {
            panic!("scene {}: {disagreement}\n{scene:?}", scene.name);
        }
    }
    assert!(
        (10..=50).contains(&rooms) && (10..=57).contains(&coarse),
        "some can be proved and some cannot: {rooms} rooms, {coarse} with a rough look"
    );
}

#[test]
fn the_standard_scene_is_met_alike_by_the_short_way() {
    let scene = Scene::load(&workspace::scene(None).unwrap()).unwrap();
    let compiled = compile(&scene, 64, 48, Integrator::Path);
    assert!(compiled.is_room() && compiled.has_coarse_solids());
    assert!(compare(&compiled, RAYS, 1).unwrap() >= RAYS);
}

/// The comparison can fail: a box that claims too much is found out.
#[test]
fn a_proof_that_does_not_hold_is_found_out() {
    let scene = Scene::load(&workspace::scene(None).unwrap()).unwrap();
    let mut compiled = compile(&scene, 64, 48, Integrator::Path);
    let room = size_of::<tracer::scene::Header>();
    let mut bytes = compiled.blob.bytes().to_vec();
    let claimed: &mut tracer::aggregate::Room =
        bytemuck::from_bytes_mut(&mut bytes[room..][..size_of::<tracer::aggregate::Room>()]);
    for wall in claimed.walls.as_flattened_mut() {
        for i in 0..3 {
            wall.low[i] -= I16F16::ONE;
            wall.extent[i] += I16F16::ONE;
        }
    }
    compiled.blob = crate::scene::Blob::new(&bytes);
    let disagreement = compare(&compiled, RAYS, 1).expect_err("walls are taken for others near the edges");
    assert!(disagreement.to_string().contains("when all primitives are asked"));
}
