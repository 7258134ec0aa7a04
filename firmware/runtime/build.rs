//! Chooses what the image can do.
//!
//! An image holds only what its scene needs, and that is said in two environment variables rather than in cargo features, of
//! which every combination would be a different crate graph:
//!
//! - `TRACER_PROFILE`: `precise` (the default) or `paper`;
//! - `TRACER_NEEDS`: a comma-separated list of words of [`tracer::scene::Capability`]; all that paths may need by default.

use std::path::Path;
use std::{env, fs};

use tracer::scene::{Capabilities, Capability};

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    println!("cargo::rerun-if-env-changed=TRACER_PROFILE");
    println!("cargo::rerun-if-env-changed=TRACER_NEEDS");
    let image = profile().and_then(|profile| Ok(image(profile, needs()?)));
    match image {
        Ok(image) => fs::write(Path::new(&out).join("image.rs"), image).expect("OUT_DIR is writable"),
        // Cargo shows this as an error and ends the build.
        Err(message) => println!("cargo::error={message}"),
    }
}

fn profile() -> Result<&'static str, String> {
    match env::var("TRACER_PROFILE").as_deref() {
        Err(_) | Ok("precise") => Ok("Precise"),
        Ok("paper") => Ok("Paper"),
        Ok(other) => Err(format!(
            "TRACER_PROFILE is `{other}`; it must be `precise` or `paper`"
        )),
    }
}

fn needs() -> Result<Capabilities, String> {
    let Ok(list) = env::var("TRACER_NEEDS") else {
        return Ok(Capabilities::PATHS);
    };
    let words = list.split(',').map(str::trim).filter(|word| !word.is_empty());
    words
        .map(capability)
        .try_fold(Capabilities::NONE, |needs, found| Ok(needs.with(found?)))
}

fn capability(word: &str) -> Result<Capability, String> {
    let all = Capability::ALL;
    all.iter()
        .copied()
        .find(|capability| capability.word() == word)
        .ok_or_else(|| {
            let words: Vec<&str> = all.iter().map(|capability| capability.word()).collect();
            format!(
                "TRACER_NEEDS has the word `{word}`; it must be a comma-separated list of {}",
                words.join(", ")
            )
        })
}

fn image(profile: &str, needs: Capabilities) -> String {
    let profile = format!("tracer::profile::{profile}");
    let profile = if needs.has(Capability::Kronecker) {
        format!("tracer::kronecker::Stratified<{profile}>")
    } else {
        profile
    };
    let needs: Vec<String> = needs
        .iter()
        .map(|capability| format!("Capability::{capability:?}"))
        .collect();
    format!(
        "use tracer::scene::{{Capabilities, Capability, Needs}};\n\n\
         /// The arithmetic and the samples this image was built with.\n\
         pub type ImageProfile = {profile};\n\n\
         /// The integrator, capable of what this image's scene needs.\n\
         pub type ImageIntegrator = tracer::integrator::Path<ImageProfile, ImageNeeds>;\n\n\
         /// What this image's scene needs of the tracer.\n\
         #[derive(Clone, Copy, Debug)]\n\
         pub enum ImageNeeds {{}}\n\n\
         impl Needs for ImageNeeds {{\n    \
             const NEEDS: Capabilities = Capabilities::of(&[{}]);\n\
         }}\n",
        needs.join(", ")
    )
}
