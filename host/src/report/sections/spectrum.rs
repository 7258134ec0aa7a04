//! Whether a sampler leaves a structure in the noise of a picture.

use maud::html;
use tracer::unit::{Plan, Termination};

use super::super::part::{Error, Part, SCENE, Workshop};
use super::super::picture::Image;
use super::super::plot::{Along, Axis, Plot, Point, Rule, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::image::picture::Picture;
use crate::oracle::direct;
use crate::oracle::spectrum::Spectrum;
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile};
use crate::stability::Effort;

/// The part.
pub(super) const PART: Part = Part {
    name: "spectrum",
    about: "the spectrum of each sampler's error: whether its noise has a structure",
    make,
};

/// Few samples, where structure would be seen best.
const SPP: u32 = 16;

/// A sampler's noise.
struct Found {
    sampler: Sampler,
    spectrum: Spectrum,
    picture: Picture,
}

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let scene = Scene::load(&workspace::file(SCENE)?)?;
    let (size, pictures) = workshop.either(([64, 48], 64), ([40, 30], 8));
    let compiled = compile(&scene, size[0], size[1], Integrator::NextEvent);
    let samples = u64::from(size[0]) * u64::from(size[1]) * u64::from(SPP) * pictures;
    effort.expect(2 * samples);
    let mut all = Vec::new();
    for sampler in [Sampler::Independent, Sampler::Kronecker] {
        all.push(found(&scene, &compiled, sampler, size, pictures)?);
        effort.done(samples);
    }
    let mut figures = vec![Figure::Plot(radial(&all)), Figure::Table(strongest(&all))];
    figures.push(Figure::Pictures {
        title: "Power by direction: the lowest frequency in the middle, 1 is mid-grey".to_owned(),
        images: all.iter().map(image).collect(),
    });
    figures.push(Figure::Pictures {
        title: format!("A picture of {SPP} samples a pixel"),
        images: all
            .iter()
            .map(|found| Image::of(format!("{}", found.sampler), &found.picture))
            .collect(),
    });
    Ok(Section {
        name: PART.name,
        title: "Spectrum of the error",
        prose: html! {
            p { "What " (pictures) " pictures of " (SPP) " samples a pixel, each with other random numbers, are off from their mean, every pixel in units of its own standard \
                 deviation, by spatial frequency. Noise without a structure has power 1 at every frequency. Lines, a grid or blotches would stand out." }
        },
        commands: &["cargo xtask report"],
        figures,
    })
}

fn found(
    scene: &Scene,
    compiled: &CompiledScene,
    sampler: Sampler,
    [width, height]: [u16; 2],
    pictures: u64,
) -> Result<Found, Error> {
    let profile = Arithmetic::Precise;
    let picture = |seed| {
        let plan = Plan {
            width,
            height,
            spp: SPP,
            samples_per_unit: SPP as u16,
            seed,
            termination: Termination::Roulette,
            epsilon: profile.epsilon(scene.scale().magnification),
        };
        direct::film_as(profile, sampler, compiled, &plan).picture()
    };
    let grey = |picture: &Picture| -> Vec<f64> {
        let pixels = picture.pixels().iter();
        pixels
            .map(|pixel| pixel.map_or(0.0, |pixel| pixel.iter().sum::<f64>() / 3.0))
            .collect()
    };
    let all: Vec<Vec<f64>> = (1..=pictures).map(|seed| grey(&picture(seed))).collect();
    let spectrum = Spectrum::of(width.into(), height.into(), &all).ok_or("a spectrum takes two pictures")?;
    Ok(Found {
        sampler,
        spectrum,
        picture: picture(1),
    })
}

fn radial(all: &[Found]) -> Plot {
    let series = all.iter().enumerate().map(|(look, found)| {
        let rings = found.spectrum.radial().into_iter();
        let points = rings.map(|(frequency, power)| Point::new("", [frequency, power]));
        Series::joined(found.sampler.to_string(), look, points.collect())
    });
    Plot {
        series: series.collect(),
        rules: vec![Rule {
            along: Along::Upwards,
            value: 1.0,
            name: "white noise".to_owned(),
        }],
        ..Plot::new(
            "error-spectrum",
            "Power of the error, the mean over directions",
            Axis::linear("cycles a pixel"),
            Axis::linear("power"),
        )
    }
}

fn strongest(all: &[Found]) -> Table {
    let head = [
        "sampler",
        "the strongest frequency",
        "white noise exceeds once in 100",
    ];
    let mut table = Table::new("The strongest frequency", head);
    for found in all {
        let (strongest, threshold) = found.spectrum.strongest();
        table.push(vec![
            found.sampler.to_string(),
            number(strongest),
            number(threshold),
        ]);
    }
    table
}

fn image(found: &Found) -> Image {
    let ([width, height], powers) = (found.picture.size().into(), found.spectrum.centred());
    let pixels = powers.into_iter().map(|power| Some([0.2 * power; 3])).collect();
    Image::of(format!("{}", found.sampler), &Picture::new(width, height, pixels))
}
