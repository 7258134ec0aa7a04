//! Chooses what the image can do.
//!
//! An image holds only what its scene needs, and that is said in two environment variables rather than in cargo features, of
//! which every combination would be a different crate graph:
//!
//! - `TRACER_PROFILE`: `precise` (the default) or `paper`;
//! - `TRACER_NEEDS`: a comma-separated list of `diffuse`, `mirror`, `glass`, `twosided` and `roulette`; all of them by default.

use std::path::Path;
use std::{env, fs};

const NEEDS: [&str; 5] = ["diffuse", "mirror", "glass", "twosided", "roulette"];

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    println!("cargo::rerun-if-env-changed=TRACER_PROFILE");
    println!("cargo::rerun-if-env-changed=TRACER_NEEDS");
    let image = profile().and_then(|profile| Ok(image(profile, &needs()?)));
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

fn needs() -> Result<Vec<String>, String> {
    let Ok(list) = env::var("TRACER_NEEDS") else {
        return Ok(NEEDS.map(String::from).to_vec());
    };
    let words: Vec<String> = list
        .split(',')
        .map(str::trim)
        .filter(|word| !word.is_empty())
        .map(String::from)
        .collect();
    match words.iter().find(|word| !NEEDS.contains(&word.as_str())) {
        None => Ok(words),
        Some(word) => Err(format!(
            "TRACER_NEEDS has the word `{word}`; it must be a comma-separated list of {}",
            NEEDS.join(", ")
        )),
    }
}

fn image(profile: &str, needs: &[String]) -> String {
    let mut image = format!(
        "/// The arithmetic this image was built with.\n\
         pub type ImageProfile = tracer::profile::{profile};\n\n\
         /// What this image's scene needs of the tracer.\n\
         #[derive(Clone, Copy, Debug)]\n\
         pub enum ImageNeeds {{}}\n\n\
         impl tracer::scene::Needs for ImageNeeds {{\n"
    );
    for need in NEEDS {
        let needed = needs.iter().any(|word| word == need);
        image += &format!("    const {}: bool = {needed};\n", need.to_uppercase());
    }
    image + "}\n"
}
