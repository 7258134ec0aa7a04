//! Error against samples a pixel: how it falls, and where arithmetic stops it.

use tracer::profile::{Paper, Precise, Profile};

use super::part::{SURE, plan, reference};
use super::table::figure;
use super::{Effort, Error, Findings, Part, Plot, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::image::picture::{Estimate, Picture, displayed};
use crate::oracle::compare::{Comparison, Tile, compare};
use crate::oracle::lockstep::{self, Paired};
use crate::oracle::reference::Rendered;
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "convergence",
    about: "error against samples a pixel, and the floor that arithmetic leaves",
    measure,
};

const SIZE: [u16; 2] = [48, 32];
/// The most samples a pixel, a power of 4. `paper` takes a quarter: its floor is found by then.
const MOST: u64 = 1 << 16;
/// From where on the error's slope is taken: with fewer samples the rare bright paths are missing.
const SLOPE_FROM: u32 = 64;

const SCENES: [(&str, Option<&str>); 5] = [
    ("scenes/cornell.toml", Some("convergence-cornell")),
    ("scenes/smallpt.toml", None),
    ("scenes/hard/overlap.toml", None),
    ("scenes/hard/corridor.toml", None),
    ("scenes/hard/nested-glass.toml", None),
];

/// What `precise` must keep to, on the mean of the picture and of each tile of 8x8 pixels, as a share of it.
const PICTURE_BIAS: f64 = 1e-4;
const TILE_BIAS: f64 = 2e-3;
/// And its floor: a quarter of a level of 8 bits on the display.
const FLOOR: f64 = 0.25;

const ERRORS: &str = "Error: root of the mean squared difference from the reference, in radiance, noise and all, at so many samples a pixel. \
    Slope: of its logarithm over that of the samples, from 64 on; noise alone has -1/2. \
    Floor: root of the mean squared difference from the same samples in double precision, what is noise in it taken off, in radiance and in levels of an 8-bit \
    display; 'at most' is two standard errors above.";
const ERRORS_HEAD: [&str; 9] = [
    "scene",
    "arithmetic",
    "at 4",
    "at 256",
    "at the most",
    "slope",
    "floor",
    "floor, levels",
    "at most, levels",
];
const BIASES: &str = "Bias of `precise` from the same samples in double precision, of the whole picture and of its worst tile of 8x8 pixels, in per cent, with \
    standard errors. z-scores of its tiles, by channel, in the independent reference, with the standard errors that they have if there \
    is no error, as if a tile's channels were one.";
const BIASES_HEAD: [&str; 8] = [
    "scene",
    "samples a pixel",
    "bias, %",
    "standard error, %",
    "worst tile, %",
    "standard error, %",
    "mean of z",
    "deviation of z",
];

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let most = power_of_4(effort.of(MOST));
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    // Every picture beside its double, of 4, 16, ... samples; the same with a quarter of the samples for `paper`; the reference.
    let pairs = counts(most).sum::<u32>() + counts(most / 4).sum::<u32>();
    effort.expect(SCENES.len() as u64 * pixels * u64::from(2 * pairs + most));
    let mut errors = Table::new("Error against samples", ERRORS, &ERRORS_HEAD);
    let mut biases = Table::new("Bias", BIASES, &BIASES_HEAD);
    let mut findings = Findings::default();
    for (file, plot_name) in SCENES {
        let scene = Scene::load(&workspace::file(file)?)?;
        let compiled = compile(&scene, SIZE[0], SIZE[1], Integrator::Path);
        let rendered = reference(effort, &scene, SIZE, most);
        let precise = course::<Precise>(effort, Arithmetic::Precise, &compiled, &rendered, most);
        let paper = course::<Paper>(effort, Arithmetic::Paper, &compiled, &rendered, most / 4);
        for (name, course) in [("`precise`", &precise), ("`paper`", &paper)] {
            errors.push(course.errors_row(file, name)?);
        }
        let (row, faults) = biases_row(file, &precise, &rendered)?;
        biases.push(row);
        findings.faults.extend(faults);
        if let Some(name) = plot_name {
            findings.plots.push(Plot {
                name,
                title: format!("Error against samples: {file}"),
                across: "samples a pixel",
                upwards: "root mean squared error, radiance",
                curves: vec![
                    ("precise".to_owned(), precise.errors.clone()),
                    ("paper".to_owned(), paper.errors.clone()),
                    ("double precision".to_owned(), precise.errors_of_double.clone()),
                ],
            });
        }
    }
    findings.tables = vec![errors, biases];
    Ok(findings)
}

fn power_of_4(samples: u64) -> u32 {
    4u32.pow(samples.max(16).ilog(4))
}

/// 4, 16, ... samples a pixel up to `most`.
fn counts(most: u32) -> impl Iterator<Item = u32> {
    (1..=most.ilog(4)).map(|power| 4u32.pow(power))
}

/// How a profile's pictures get better.
struct Course {
    /// Samples a pixel, and the error.
    errors: Vec<(f64, f64)>,
    /// The same of the doubles.
    errors_of_double: Vec<(f64, f64)>,
    /// The last picture, of most samples.
    last: Paired,
}

fn course<P: Profile<Random: Clone>>(
    effort: &Effort,
    arithmetic: Arithmetic,
    compiled: &CompiledScene,
    rendered: &Rendered,
    most: u32,
) -> Course {
    let pair = |spp: u32| {
        let plan = plan(arithmetic, compiled, SIZE, spp);
        lockstep::render::<P>(compiled, &plan, |samples| effort.done(2 * samples))
    };
    let (mut errors, mut errors_of_double) = (Vec::new(), Vec::new());
    let mut last = None;
    for spp in counts(most) {
        let paired = pair(spp);
        errors.push((
            spp.into(),
            error_beside(&paired.picture.picture, &rendered.estimate),
        ));
        errors_of_double.push((
            spp.into(),
            error_beside(&paired.double.picture, &rendered.estimate),
        ));
        last = Some(paired);
    }
    Course {
        errors,
        errors_of_double,
        last: last.expect("there are at least 4 samples"),
    }
}

/// The root of the mean squared difference from the reference, whose own noise is taken off.
pub(crate) fn error_beside(picture: &Picture, reference: &Estimate) -> f64 {
    let variances = reference.variance.iter().flatten();
    let pixels = picture.pixels().iter().flatten();
    let pixels = pixels
        .zip(reference.picture.pixels().iter().flatten())
        .zip(variances);
    let squares = pixels
        .flat_map(|((one, other), variance)| (0..3).map(move |c| (one[c] - other[c]).powi(2) - variance[c]));
    let count = 3 * picture.pixels().len();
    (squares.sum::<f64>() / count as f64).max(0.0).sqrt()
}

impl Course {
    /// The slope of the line through the errors' logarithms, if they are two or more.
    fn slope(&self) -> Option<f64> {
        let points = self
            .errors
            .iter()
            .filter(|(spp, _)| *spp >= f64::from(SLOPE_FROM));
        let points: Vec<(f64, f64)> = points.map(|(spp, error)| (spp.ln(), error.ln())).collect();
        let mean =
            |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / points.len() as f64;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let (across, upwards) = points.iter().fold((0.0, 0.0), |(across, upwards), point| {
            let away = point.0 - x;
            (across + away * away, upwards + away * (point.1 - y))
        });
        (points.len() > 1).then(|| upwards / across)
    }

    fn error_at(&self, samples: f64) -> String {
        let found = self.errors.iter().find(|(spp, _)| *spp >= samples);
        found.map_or_else(|| "-".to_owned(), |(_, error)| figure(*error))
    }

    fn errors_row(&self, file: &str, name: &str) -> Result<Vec<String>, Error> {
        let radiance = beside_double(&self.last)?.squared_error;
        let levels = on_display(&self.last)?.squared_error;
        let (most, _) = self.errors.last().ok_or("no picture")?;
        Ok(vec![
            format!("`{file}`"),
            name.to_owned(),
            self.error_at(4.0),
            self.error_at(256.0),
            format!("{} ({most})", self.error_at(*most)),
            self.slope()
                .map_or_else(|| "-".to_owned(), |slope| format!("{slope:.3}")),
            figure(radiance.corrected.max(0.0).sqrt()),
            figure(255.0 * levels.corrected.max(0.0).sqrt()),
            figure(255.0 * levels.rmse_at_most()),
        ])
    }
}

/// The picture and its double, whose difference has the noise of paths that parted and no other.
fn beside_double(paired: &Paired) -> Result<Comparison, Error> {
    let (picture, double) = paired.difference();
    Ok(compare(&picture, &double)?)
}

/// The same as a display shows it, before it rounds to levels.
fn on_display(paired: &Paired) -> Result<Comparison, Error> {
    let shown = |estimate: &Estimate| {
        let pixels = estimate.picture.pixels().iter();
        Picture::new(
            SIZE[0],
            SIZE[1],
            pixels
                .map(|pixel| pixel.map(|radiance| radiance.map(displayed)))
                .collect(),
        )
    };
    let doubles = paired.double.picture.pixels().iter().flatten();
    let variance = doubles
        .zip(&paired.variance)
        .map(|(double, variance)| [0, 1, 2].map(|c| variance[c] * slope_of_display(double[c]).powi(2)));
    let picture = Estimate {
        picture: shown(&paired.picture),
        variance: Some(variance.collect()),
        spp: paired.picture.spp,
    };
    let double = Estimate {
        picture: shown(&paired.double),
        variance: None,
        spp: paired.double.spp,
    };
    Ok(compare(&picture, &double)?)
}

fn slope_of_display(radiance: f64) -> f64 {
    let step = 1e-6;
    (displayed(radiance + step) - displayed(radiance)) / step
}

/// A scene's row of biases, and what is wrong with it.
fn biases_row(file: &str, course: &Course, rendered: &Rendered) -> Result<(Vec<String>, Vec<String>), Error> {
    let last = &course.last;
    let lockstep = beside_double(last)?;
    let independent = compare(
        &rendered.pooled_noise(last.picture.clone(), Integrator::Path),
        &rendered.estimate,
    )?;
    let (bias, noise) = (
        lockstep.bias.unwrap_or_default(),
        lockstep.bias_standard_error.unwrap_or_default(),
    );
    let worst = *lockstep.tiles.most_biased().ok_or("no tile")?;
    let scores: Vec<f64> = independent.tiles.tiles.iter().flat_map(|tile| tile.z).collect();
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let deviation = (scores.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / scores.len() as f64).sqrt();
    let tiles = independent.tiles.tiles.len() as f64;
    let (of_mean, of_deviation) = (tiles.sqrt().recip(), (2.0 * tiles).sqrt().recip());
    let levels = on_display(last)?.squared_error;
    let least_floor = (levels.corrected - SURE * levels.standard_error).max(0.0).sqrt();
    let mut faults = Vec::new();
    let mut expect = |holds: bool, what: &str| {
        if !holds {
            faults.push(format!("{file}: {what}"));
        }
    };
    expect(
        bias.abs() - SURE * noise <= PICTURE_BIAS,
        "the bias is beyond 0.01 %",
    );
    let off = |tile: &Tile| tile.bias.abs() - SURE * tile.bias_noise > TILE_BIAS;
    expect(
        !lockstep.tiles.tiles.iter().any(off),
        "a tile's bias is beyond 0.2 %",
    );
    expect(mean.abs() <= SURE * of_mean, "the tiles' mean z-score is not 0");
    expect(
        (deviation - 1.0).abs() <= SURE * of_deviation,
        "the tiles' z-scores do not deviate by 1",
    );
    expect(
        255.0 * least_floor <= FLOOR,
        "the floor is above a quarter of a level",
    );
    let row = vec![
        format!("`{file}`"),
        last.picture.spp.unwrap_or_default().to_string(),
        figure(100.0 * bias),
        figure(100.0 * noise),
        figure(100.0 * worst.bias),
        figure(100.0 * worst.bias_noise),
        format!("{mean:+.2} ± {of_mean:.2}"),
        format!("{deviation:.2} ± {of_deviation:.2}"),
    ];
    Ok((row, faults))
}

#[cfg(test)]
mod tests {
    use indicatif::ProgressBar;

    use super::*;

    /// Proof that this part can fail: a picture that is darker by a thousandth, and one of a wrong tile.
    #[test]
    fn planted_faults_are_found() {
        let effort = Effort::new(100, ProgressBar::hidden());
        let scene = Scene::load(&workspace::file("scenes/cornell.toml").unwrap()).unwrap();
        let compiled = compile(&scene, SIZE[0], SIZE[1], Integrator::Path);
        let rendered = reference(&effort, &scene, SIZE, 16);
        let course = course::<Precise>(&effort, Arithmetic::Precise, &compiled, &rendered, 16);
        let faults = |change: &dyn Fn(usize, f64) -> f64| {
            let pixels = course.last.picture.picture.pixels().iter().enumerate();
            let changed =
                pixels.map(|(index, pixel)| pixel.map(|pixel| pixel.map(|radiance| change(index, radiance))));
            let mut last = course.last.clone();
            last.picture.picture = Picture::new(SIZE[0], SIZE[1], changed.collect());
            let changed = Course {
                last,
                errors: Vec::new(),
                errors_of_double: Vec::new(),
            };
            biases_row("planted", &changed, &rendered).unwrap().1.join("; ")
        };
        assert!(faults(&|_, radiance| 0.999 * radiance).contains("0.01 %"));
        let in_first_tile =
            |index: usize| index % usize::from(SIZE[0]) < 8 && index / usize::from(SIZE[0]) < 8;
        let tile = faults(&|index, radiance| {
            if in_first_tile(index) {
                1.02 * radiance
            } else {
                radiance
            }
        });
        assert!(tile.contains("0.2 %"), "{tile}");
    }
}
