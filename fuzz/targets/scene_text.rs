//! Scene texts, mutated: none makes the reader or the compiler panic, and what is accepted compiles to what a core can use.
#![no_main]

use host::scene::{Integrator, Scene, compile};
use libfuzzer_sys::fuzz_target;
use tracer::geometry::sphere::SphereRecord;

/// 1/r is right to 2^-28: the stored radius times the stored reciprocal is 2^60, less what its last bit is worth.
fn check(record: &SphereRecord) {
    let product =
        (i64::from(record.radius.to_bits()) << record.shift) * i64::from(record.reciprocal.to_bits());
    assert!(((1 << 60) - product).abs() <= 1 << 32, "{record:?}");
}

fuzz_target!(|text: &str| {
    let Ok(scene) = Scene::parse("fuzz.toml", text) else {
        return;
    };
    for (width, height) in [(64, 48), (1, 1), (48, 64), (1920, 1080)] {
        if scene.check_frame(width, height).is_err() {
            continue;
        }
        let compiled = compile(&scene, width, height, Integrator::NextEvent);
        let primitives = compiled.view().aggregate.primitives;
        primitives
            .hollow_spheres
            .iter()
            .for_each(|sphere| check(&sphere.0));
        primitives
            .solid_spheres
            .iter()
            .for_each(|sphere| check(&sphere.sphere));
    }
});
