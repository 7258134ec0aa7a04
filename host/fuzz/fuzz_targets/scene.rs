//! Scene texts, mutated: none makes the reader or the compiler panic, and what is accepted compiles to what a core can use.
#![no_main]

use host::scene::{Scene, compile};
use libfuzzer_sys::fuzz_target;
use tracer::numbers::Mixed;
use tracer::scene::{All, HEADER_BYTES, SPHERE_BYTES, SphereRecord};

/// 1/r is right to 2^-28: the stored radius times the stored reciprocal is 2^60, less what its last bit is worth.
fn check(record: &SphereRecord) {
    let product = (i64::from(record.radius) << record.shift) * i64::from(record.reciprocal);
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
        let compiled = compile(&scene, width, height);
        tracer::scene::Scene::<Mixed>::decode::<All>(&compiled.blob).expect("what was compiled decodes");
        for bytes in compiled.blob[HEADER_BYTES..].chunks(SPHERE_BYTES) {
            check(&SphereRecord::decode(bytes).expect("a record"));
        }
    }
});
