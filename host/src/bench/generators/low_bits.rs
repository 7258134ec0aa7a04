//! What the published use of the low bits does to a picture, all else being equal.

use std::path::Path;

use fixedmath::I16F16;
use plotters::style::text_anchor::{HPos, VPos};
use serde::Serialize;
use tracer::profile::{Precise, Profile, Quadratic};
use tracer::random::LowBits;
use tracer::unit::{Plan, Termination};

use crate::image::drawing::{
    DrawingError, GAP, MARGIN, NORMAL, blit, diverging, draw_on, enlarged, signed, text, write_png,
};
use crate::image::picture::{Estimate, Picture};
use crate::image::raster::Raster;
use crate::oracle::compare::{CompareError, Comparison, compare};
use crate::oracle::difference::differences;
use crate::oracle::lockstep;
use crate::platform::file::WriteError;
use crate::scene::{Integrator, Scene, compile};

/// `precise` in everything but its random numbers, which are those of `paper`.
#[derive(Clone, Copy, Debug)]
pub enum PreciseByLowBits {}

impl Profile for PreciseByLowBits {
    const NAME: &'static str = "precise by low bits";
    const STRATIFIED_NAME: &'static str = "precise by low bits";
    const EPSILON: I16F16 = Precise::EPSILON;
    const QUADRATIC: Quadratic = Precise::QUADRATIC;
    type Numbers = <Precise as Profile>::Numbers;
    type Random = LowBits;
    type Hemisphere = <Precise as Profile>::Hemisphere;
}

/// Errors of pixels so far apart or nearer, across and down, are looked at together.
const REACH: usize = 16;
/// The film's resolution. A pixel with less noise than that, such as one of the light, has no error to speak of.
const RESOLUTION: f64 = 1.0 / 65_536.0;
/// Radiance of full colour in the maps of errors.
const RANGE: f64 = 0.1;
/// A pixel is so many of the drawing's.
const SCALE: u32 = 2;
const CAPTION: u32 = 48;
/// A pixel that one of the pictures lacks.
const MISSING: [u8; 3] = [0, 0, 0];

/// Two pictures of one plan, by the full state and by the low bits, and their reference.
#[derive(Clone, Debug)]
pub struct Pictures {
    full_state: Estimate,
    low_bits: Estimate,
    reference: Estimate,
}

/// How far a picture is from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Relative error of the mean.
    pub bias: Option<f64>,
    /// Its standard error, were the samples independent.
    pub bias_standard_error: Option<f64>,
    /// Root of the mean squared error, the picture's own noise included.
    pub rmse: f64,
    /// Tiles by channel that are further off than independent samples would be.
    pub tiles_failed: usize,
    /// Tiles by channel.
    pub tiles: usize,
    /// The largest correlation of the errors of two pixels near each other.
    pub correlation: f64,
    /// How far those are apart, across and down.
    pub correlation_at: (usize, usize),
}

/// Both.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// `precise` as it is.
    pub full_state: Figures,
    /// `precise` by the low bits.
    pub low_bits: Figures,
}

impl Pictures {
    /// Renders `scene` twice, with `spp` samples a pixel, in the size of `reference`.
    pub fn render(scene: &Scene, spp: u32, reference: Estimate) -> Self {
        let (width, height) = reference.picture.size();
        let plan = Plan {
            width,
            height,
            spp,
            samples_per_unit: spp.min(64) as u16,
            seed: 1,
            termination: Termination::Roulette,
            epsilon: Precise::EPSILON,
        };
        let compiled = compile(scene, width, height, Integrator::Path);
        Self {
            full_state: lockstep::render::<Precise>(&compiled, &plan, |_| ()).picture,
            low_bits: lockstep::render::<PreciseByLowBits>(&compiled, &plan, |_| ()).picture,
            reference,
        }
    }

    /// Compares both with the reference.
    pub fn effect(&self) -> Result<Effect, CompareError> {
        Ok(Effect {
            full_state: figures(&self.full_state, &self.reference)?,
            low_bits: figures(&self.low_bits, &self.reference)?,
        })
    }

    /// Draws both pictures side by side, and under each its error.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_png(path, || self.draw())
    }

    fn draw(&self) -> Result<Raster, DrawingError> {
        let effect = self.effect()?;
        let size = self.reference.picture.size();
        let panel = (u32::from(size.0) * SCALE, u32::from(size.1) * SCALE);
        let (right, below) = (MARGIN + panel.0 + GAP, MARGIN + CAPTION + panel.1 + GAP);
        draw_on(
            right + panel.0 + MARGIN,
            below + CAPTION + panel.1 + MARGIN,
            |canvas| {
                let columns = [
                    (
                        MARGIN,
                        "upper 32 bits of 64 (precise)",
                        &self.full_state,
                        effect.full_state,
                    ),
                    (
                        right,
                        "lower 16 bits of 32, as published",
                        &self.low_bits,
                        effect.low_bits,
                    ),
                ];
                for (left, name, estimate, figures) in columns {
                    let spp = estimate.spp.unwrap_or_default();
                    let picture = estimate.picture.display().as_chunks::<3>().0.to_vec();
                    let error = errors(&estimate.picture, &self.reference.picture);
                    let panels = [
                        (
                            MARGIN,
                            [name.to_owned(), format!("{spp} samples a pixel")],
                            picture,
                        ),
                        (below, captions(&figures), error),
                    ];
                    for (top, lines, pixels) in panels {
                        for (line, y) in lines.iter().zip([top, top + CAPTION / 2]) {
                            text(canvas, line, NORMAL, (left, y), HPos::Left, VPos::Top)?;
                        }
                        blit(
                            canvas,
                            (left, top + CAPTION),
                            panel,
                            enlarged(&pixels, size, panel),
                        )?;
                    }
                }
                Ok(())
            },
        )
    }
}

fn captions(figures: &Figures) -> [String; 2] {
    let bias = figures
        .bias
        .map_or("-".to_owned(), |bias| signed(100.0 * bias, 3));
    let (across, down) = figures.correlation_at;
    [
        format!(
            "error, −{RANGE} (blue) to +{RANGE} (red): bias {bias} %, rmse {:.4}",
            figures.rmse
        ),
        format!(
            "{} of {} tile tests fail; errors {across} across, {down} down correlate by {}",
            figures.tiles_failed,
            figures.tiles,
            signed(figures.correlation, 3)
        ),
    ]
}

fn errors(picture: &Picture, reference: &Picture) -> Vec<[u8; 3]> {
    let differences = differences(picture, reference).into_iter();
    differences
        .map(|d| d.map_or(MISSING, |d| diverging(d / RANGE)))
        .collect()
}

fn figures(image: &Estimate, reference: &Estimate) -> Result<Figures, CompareError> {
    let found: Comparison = compare(image, reference)?;
    // An image without a variance counts as exact, so that its noise stays in the error.
    let exact = Estimate {
        variance: None,
        ..image.clone()
    };
    let (correlation, correlation_at) = correlation(image, reference);
    Ok(Figures {
        bias: found.bias,
        bias_standard_error: found.bias_standard_error,
        rmse: compare(&exact, reference)?.rmse,
        tiles_failed: found.tiles.failed().count(),
        tiles: found.tiles.tested(),
        correlation,
        correlation_at,
    })
}

/// The largest correlation of two errors up to [`REACH`] apart, across to the right and down, each in units of its own noise, and where it is.
fn correlation(image: &Estimate, reference: &Estimate) -> (f64, (usize, usize)) {
    let (width, height) = image.picture.size();
    let (width, height) = (usize::from(width), usize::from(height));
    let noise = |estimate: &Estimate, at: usize| {
        let variance = estimate.variance.as_ref();
        variance.map_or(0.0, |variance| variance[at].iter().sum::<f64>())
    };
    let errors: Vec<f64> = differences(&image.picture, &reference.picture)
        .into_iter()
        .enumerate()
        .map(|(at, difference)| {
            let noise = (noise(image, at) + noise(reference, at)).sqrt();
            difference
                .filter(|_| noise > RESOLUTION)
                .map_or(0.0, |d| d / noise)
        })
        .collect();
    let square: f64 = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    let at = |(across, down): (usize, usize)| {
        let rows = down..height;
        let products = rows.flat_map(|y| {
            let (row, above) = (&errors[y * width..], &errors[(y - down) * width..]);
            (across..width).map(move |x| row[x] * above[x - across])
        });
        products.sum::<f64>() / ((width - across) * (height - down)) as f64 / square
    };
    let apart = (0..=REACH).flat_map(|down| (0..=REACH).map(move |across| (across, down)));
    apart
        .filter(|&(across, down)| (across, down) != (0, 0) && across < width && down < height)
        .map(|apart| (at(apart), apart))
        .max_by(|one, other| one.0.abs().total_cmp(&other.0.abs()))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    use super::*;
    use crate::oracle::reference::{self, Job};
    use crate::platform::workspace;

    fn pictures(width: u16, height: u16, spp: u32) -> Pictures {
        let scene = workspace::scene(None).expect("tests run in the checkout");
        let scene = Scene::load(&scene).expect("the scene is in order");
        let job = Job {
            width,
            height,
            spp,
            termination: reference::Termination::Roulette,
            seed: 1,
        };
        let reference = reference::render(&scene, &job, |_| ()).estimate;
        Pictures::render(&scene, spp, reference)
    }

    /// A picture of errors that are noise, and a share of the noise 3 across and 2 up; one pixel has no noise at all.
    fn noisy(share: f64) -> (Estimate, Estimate) {
        const SIZE: (u16, u16) = (64, 48);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let noise: Vec<f64> = (0..50 * 67)
            .map(|_| f64::from(random.next_u32()) / 2f64.powi(31) - 1.0)
            .collect();
        let places = (0..48).flat_map(|y| (0..64).map(move |x| (x, y)));
        let mut pixels: Vec<_> = places
            .map(|(x, y)| Some([noise[(y + 2) * 67 + x + 3] + share * noise[y * 67 + x]; 3]))
            .collect();
        let mut variance = vec![[1.0; 3]; pixels.len()];
        (pixels[1000], variance[1000]) = (Some([1e-3; 3]), [1e-30; 3]);
        let estimate = |pixels, variance| Estimate {
            picture: Picture::new(SIZE.0, SIZE.1, pixels),
            variance,
            spp: None,
        };
        let reference = estimate(vec![Some([0.0; 3]); variance.len()], None);
        (estimate(pixels, Some(variance)), reference)
    }

    #[test]
    fn errors_that_hang_together_are_found_where_they_are() {
        // Of 288 correlations of 3,072 errors none is further off than 5 standard deviations.
        let chance = 5.0 / (64.0 * 48.0f64).sqrt();
        let (image, reference) = noisy(0.0);
        assert!(correlation(&image, &reference).0.abs() < chance);
        let (image, reference) = noisy(0.5);
        let (found, at) = correlation(&image, &reference);
        assert!((found - 0.5 / 1.25).abs() < chance, "{found}");
        assert_eq!(at, (3, 2));
    }

    #[test]
    fn the_drawing_has_two_columns_and_two_rows() {
        let drawing = pictures(32, 24, 4).draw().expect("it is drawn");
        let (panel, captions) = ((32 * SCALE, 24 * SCALE), 2 * CAPTION);
        assert_eq!(drawing.width, 2 * (MARGIN + panel.0) + GAP);
        assert_eq!(drawing.height, 2 * (MARGIN + panel.1) + GAP + captions);
        let at = |x: u32, y: u32| drawing.rgb.as_chunks::<3>().0[(y * drawing.width + x) as usize];
        assert_eq!(at(0, 0), [255; 3]);
        let light = (MARGIN + 16 * SCALE, MARGIN + CAPTION + 3 * SCALE);
        assert_eq!(at(light.0, light.1), [255; 3], "the light is white");
    }
}
