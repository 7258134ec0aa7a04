//! Pictures of the repository's scenes.

use maud::html;
use tracer::kronecker::Stratified;
use tracer::profile::Precise;
use tracer::unit::{Plan, Termination};

use super::super::part::{Error, Part, Workshop};
use super::super::picture::Image;
use super::super::section::{Figure, Section};
use crate::firmware::arithmetic::Arithmetic;
use crate::image::picture::Picture;
use crate::oracle::direct;
use crate::scene::{Integrator, Scene, compile, samples_per_unit};
use crate::stability::{Effort, scene_files};

/// The part.
pub(super) const PART: Part = Part {
    name: "scenes",
    about: "a small picture of each scene",
    make,
};

/// Folders of scenes, and what they are called.
const FOLDERS: [(&str, &str); 3] = [
    ("scenes", "Standard scenes"),
    ("scenes/extra", "More scenes"),
    ("scenes/hard", "Hard scenes"),
];
/// The radiance that pictures are exposed for, where they are far from it: its square root is a display's middle.
const GREY: f64 = 0.25;
/// Stops from which on a picture is exposed otherwise.
const FAR: i32 = 2;

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let (size, spp) = workshop.either(([96, 72], 256), ([8, 6], 4));
    let mut figures = Vec::new();
    for (folder, title) in FOLDERS {
        let files = scene_files(&[folder])?;
        effort.expect(files.len() as u64);
        let mut images = Vec::new();
        for file in files {
            let scene = Scene::load(&file)?;
            let (stops, picture) = exposed(&picture(&scene, size, spp));
            let exposure = if stops == 0 {
                String::new()
            } else {
                format!(", {stops:+} stops")
            };
            images.push(Image::of(format!("`{}`{exposure}", scene.name), &picture));
            effort.done(1);
        }
        figures.push(Figure::Pictures {
            title: title.to_owned(),
            images,
        });
    }
    Ok(Section {
        name: PART.name,
        title: "Scenes",
        prose: html! {
            p { "Every scene of the repository by " code { "precise" } ", " (size[0]) "x" (size[1]) " pixels of " (spp) " samples, to the bit as the \
                 native backend and emulated cores draw it. What is far too bright or too dark for a display is exposed by whole stops." }
        },
        commands: &["cargo xtask render SCENE --backend native --integrator next-event --sampler kronecker"],
        figures,
    })
}

fn picture(scene: &Scene, [width, height]: [u16; 2], spp: u32) -> Picture {
    let compiled = compile(scene, width, height, Integrator::NextEvent);
    let plan = Plan {
        width,
        height,
        spp,
        samples_per_unit: samples_per_unit(scene, spp, Termination::Roulette),
        seed: 1,
        termination: Termination::Roulette,
        epsilon: Arithmetic::Precise.epsilon(scene.scale().magnification),
    };
    direct::film::<Stratified<Precise>>(&compiled, &plan).picture()
}

/// The picture by the exposure, in whole stops, that a display can show.
fn exposed(picture: &Picture) -> (i32, Picture) {
    let mean = picture.mean().map_or(0.0, |mean| mean.iter().sum::<f64>() / 3.0);
    let stops = if mean > 0.0 {
        (GREY / mean).log2().round() as i32
    } else {
        0
    };
    let stops = if stops.abs() < FAR { 0 } else { stops };
    (stops, picture.exposed(stops))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_far_from_grey_is_exposed() {
        let of = |radiance: f64| exposed(&Picture::new(1, 1, vec![Some([radiance; 3])])).0;
        assert_eq!([of(0.3), of(0.0), of(4.0), of(0.25 / 1024.0)], [0, 0, -4, 10]);
    }
}
