//! What a core finds in its memory as camera and scene: none makes it panic, and what it accepts it renders.
#![no_main]

use fixedmath::U48F16;
use host::scene::Blob;
use libfuzzer_sys::fuzz_target;
use tracer::aggregate::Aggregate;
use tracer::camera::{Camera, CameraRecord};
use tracer::integrator::{Integrator, Path};
use tracer::profile::{Paper, Precise, Profile};
use tracer::scene::{Capabilities, Needs, Scene};
use tracer::unit::{Plan, SPAN, Termination, render};

/// All capabilities, as a type of this crate's own: functions that are generic over it are compiled here, where numbers wrap as on a
/// core. Of those kept out of line there may else be one in `host` already, which is built to panic.
enum Everything {}

impl Needs for Everything {
    const NEEDS: Capabilities = Capabilities::ALL;
}

/// One unit. By roulette a path in a perfect mirror has no end.
fn draw<P: Profile>(scene: &Scene<'_>, record: &CameraRecord) {
    let plan = Plan {
        width: 4,
        height: 1,
        spp: 4,
        samples_per_unit: 4,
        seed: 1,
        termination: Termination::Depth(6),
        epsilon: P::EPSILON,
    };
    let path = Path::<P, Everything>::new(&plan);
    let mut sums = [[U48F16::ZERO; 3]; SPAN];
    let rays = render(&path, scene, &Camera::new(record), &plan, 0, &mut sums);
    assert!((16..=16 * 6).contains(&rays), "{rays} rays");
}

fuzz_target!(|bytes: &[u8]| {
    let Some((camera, scene)) = bytes.split_at_checked(size_of::<CameraRecord>()) else {
        return;
    };
    let (camera, scene) = (Blob::new(camera), Blob::new(scene));
    let record = CameraRecord::of_bytes(camera.bytes()).expect("aligned, and of its length");
    let Ok(scene) = Scene::view(scene.bytes(), Capabilities::ALL) else {
        return;
    };
    let Ok(scene) = scene.seen_from(record, Capabilities::ALL) else {
        return;
    };
    scene.aggregate.bounds();
    draw::<Precise>(&scene, record);
    draw::<Paper>(&scene, record);
});
