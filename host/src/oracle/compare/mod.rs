//! How far a picture is from its reference, and whether that is more than noise.
//!
//! Both pictures are estimates with a variance for every pixel. What is compared is their difference `d`, whose variance
//! `v` is the sum of the two:
//!
//! - **bias**: the difference of the means over the reference's mean. Errors of either sign cancel in it.
//! - **rmse**: the root of `mean(d² - v)`: `mean(d²)` alone would be mostly noise. Where noise hides the error the mean
//!   may come out below zero; then `rmse` is 0 and [`SquaredError::rmse_at_most`] says how much could hide.
//! - **tiles**: what a mean over the picture forgives, a tile of 8x8 pixels does not. See [`Tiles`].
//! - **uniformity**: were `v` right and `d` nothing but noise, the pixels' p-values would be uniform. See [`Uniformity`].
//!
//! A picture without a variance counts as exact. A pixel that is missing on either side is left out and counted.

mod noise_share;
mod pixels;
#[cfg(test)]
mod tests;
mod tiles;

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use crate::image::picture::{Estimate, displayed};
pub use noise_share::NoiseShare;
use noise_share::error_of_sum;
pub use pixels::{PixelTest, Pixels};
pub(crate) use tiles::sidak_threshold;
pub use tiles::{FALSE_ALARM, SIDE, Tile, Tiles};

/// The verdict on a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// (mean - reference mean) / reference mean over all channels; `None` if the reference is black.
    pub bias: Option<f64>,
    /// Upper bound of the standard error of `bias` (as if the channels' noise were one and the same).
    pub bias_standard_error: Option<f64>,
    /// The picture's part of it, relative to the reference's mean as `bias` is: were the reference exact. `None` without a variance.
    pub standard_error: Option<f64>,
    /// The reference's part: were the picture exact.
    pub reference_standard_error: Option<f64>,
    /// How much of the noise is the reference's; `None` unless both sides' variance is known.
    pub noise_share: Option<NoiseShare>,
    /// Mean radiance of the picture.
    pub mean: [f64; 3],
    /// Mean radiance of the reference over the same pixels.
    pub reference_mean: [f64; 3],
    /// Noise-corrected root of the mean squared error, in radiance.
    pub rmse: f64,
    /// The square of `rmse` before it was cut off at zero.
    pub squared_error: SquaredError,
    /// The largest difference of any channel of any pixel, noise and all.
    pub max_abs: f64,
    /// Peak signal to noise on the display: both pictures clamped to [0, 1] and in sRGB, but not quantised, peak 1,
    /// noise and all, for it shows too. `None` if they do not differ.
    pub psnr_db: Option<f64>,
    /// Tile by tile.
    pub tiles: Tiles,
    /// All pixels' p-values together; `None` when neither side has a variance, or too few pixels or samples of them for a test.
    pub uniformity: Option<Uniformity>,
    /// Pixel by pixel; `None` when neither side has a variance, or too few samples of them for a test.
    pub pixels: Option<Pixels>,
    /// Pixels that both pictures have.
    pub compared: usize,
    /// Pixels that one of them lacks.
    pub missing: usize,
}

/// Mean squared error less the noise's share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquaredError {
    /// `mean(d² - v)`; below zero where noise was kind.
    pub corrected: f64,
    /// Its standard error, from its spread over the pixels. An error whose square is below about twice this cannot be told
    /// from none.
    pub standard_error: f64,
}

impl SquaredError {
    /// The largest root of the mean squared error that these figures leave room for: two standard errors up.
    pub fn rmse_at_most(&self) -> f64 {
        (self.corrected.max(0.0) + 2.0 * self.standard_error).sqrt()
    }
}

/// Whether pixels differ as noise would have them differ.
///
/// The green channel of every pixel is tested against its own noise (Welch's test, normal for the many samples of a
/// pixel), and the p-values are counted in bins of equal width. The chi-squared test over the bins presumes means near a
/// normal distribution, which those of few paths are far from: below 1,024 samples per pixel it is not made.
#[derive(Clone, Debug, PartialEq)]
pub struct Uniformity {
    /// p-values in [0, 1) by bins of 1/20.
    pub histogram: [usize; BINS],
    /// How likely a histogram this uneven is if all is well.
    pub p_value: f64,
}

const BINS: usize = 20;
/// Fewer samples leave the mean of a pixel too skewed for [`Uniformity`].
pub(crate) const FEWEST_SAMPLES: u32 = 1024;
/// The chi-squared test wants about five in each bin.
const FEWEST_TESTED: usize = 5 * BINS;

/// Pictures that cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// They differ in size.
    #[error(
        "the picture is {}x{} but the reference {}x{}; render both at one size",
        picture.0, picture.1, reference.0, reference.1
    )]
    Size {
        /// Width and height of the picture.
        picture: (u16, u16),
        /// Width and height of the reference.
        reference: (u16, u16),
    },
    /// Every pixel is wanted, and some are not there.
    #[error("{0} pixels of the picture or its reference are missing; render both to the end")]
    Incomplete(usize),
    /// No pixel is in both.
    #[error("the picture and the reference have no pixel in common; let the render get further")]
    NothingInCommon,
}

/// A pixel that both sides have.
#[derive(Clone, Copy)]
struct Pair {
    image: [f64; 3],
    reference: [f64; 3],
    /// Of the difference.
    variance: [f64; 3],
}

impl Pair {
    fn difference(&self, channel: usize) -> f64 {
        self.image[channel] - self.reference[channel]
    }

    fn largest_difference(&self) -> f64 {
        (0..3)
            .map(|channel| self.difference(channel).abs())
            .fold(0.0, f64::max)
    }
}

/// Compares `image` with `reference`.
pub fn compare(image: &Estimate, reference: &Estimate) -> Result<Comparison, CompareError> {
    let size = image.picture.size();
    if size != reference.picture.size() {
        return Err(CompareError::Size {
            picture: size,
            reference: reference.picture.size(),
        });
    }
    let pixels = pairs(image, reference);
    let present: Vec<Pair> = pixels.iter().flatten().copied().collect();
    if present.is_empty() {
        return Err(CompareError::NothingInCommon);
    }
    let count = present.len() as f64;
    let sum = |value: &dyn Fn(&Pair, usize) -> f64| -> [f64; 3] {
        [0, 1, 2].map(|channel| present.iter().map(|pair| value(pair, channel)).sum())
    };
    let mean = sum(&|pair, channel| pair.image[channel]).map(|sum| sum / count);
    let reference_mean = sum(&|pair, channel| pair.reference[channel]).map(|sum| sum / count);
    let reference_level: f64 = reference_mean.iter().sum();
    let error = error_of_sum(present.iter().map(|pair| pair.variance)) / count;
    let [image_error, reference_error] = [image, reference].map(|estimate| error_of_mean(estimate, &pixels));
    let relative = |value: f64| (reference_level > 0.0).then_some(value / reference_level);
    let squared_error = squared_error(&present);
    let noisy = image.variance.is_some() || reference.variance.is_some();
    let tested = noisy && nearly_normal(image) && nearly_normal(reference);
    Ok(Comparison {
        bias: relative(mean.iter().sum::<f64>() - reference_level),
        bias_standard_error: relative(error).filter(|_| noisy),
        standard_error: image_error.and_then(relative),
        reference_standard_error: reference_error.and_then(relative),
        noise_share: NoiseShare::of(reference, image),
        mean,
        reference_mean,
        rmse: squared_error.corrected.max(0.0).sqrt(),
        squared_error,
        max_abs: present.iter().map(Pair::largest_difference).fold(0.0, f64::max),
        psnr_db: psnr_db(&present),
        tiles: tiles::test(&pixels, size, reference_level / 3.0),
        uniformity: uniformity(&present).filter(|_| tested),
        pixels: tested.then(|| pixels::test(&pixels, size.0)),
        compared: present.len(),
        missing: pixels.len() - present.len(),
    })
}

/// The most that the standard error of an estimate's mean over the `pixels` there are can be.
fn error_of_mean(estimate: &Estimate, pixels: &[Option<Pair>]) -> Option<f64> {
    let both = estimate.variance.as_ref()?.iter().zip(pixels);
    let variances = both.filter_map(|(&variance, pair)| pair.map(|_| variance));
    Some(error_of_sum(variances) / pixels.iter().flatten().count() as f64)
}

fn pairs(image: &Estimate, reference: &Estimate) -> Vec<Option<Pair>> {
    let variance = |estimate: &Estimate, index: usize| match &estimate.variance {
        Some(variance) => variance[index],
        None => [0.0; 3],
    };
    let both = image.picture.pixels().iter().zip(reference.picture.pixels());
    both.enumerate()
        .map(|(index, (&one, &other))| {
            let (a, b) = (variance(image, index), variance(reference, index));
            Some(Pair {
                image: one?,
                reference: other?,
                variance: [0, 1, 2].map(|c| a[c] + b[c]),
            })
        })
        .collect()
}

/// The standard error of the mean of `value`. The channels of a pixel share its paths, pixels share nothing: the spread is
/// taken over pixels.
fn standard_error(pixels: &[Pair], value: impl Fn(&Pair) -> f64) -> f64 {
    let count = pixels.len() as f64;
    let mean = pixels.iter().map(&value).sum::<f64>() / count;
    let spread: f64 = pixels.iter().map(|pair| (value(pair) - mean).powi(2)).sum();
    (spread / (count - 1.0).max(1.0) / count).sqrt()
}

fn squared_error(pixels: &[Pair]) -> SquaredError {
    let excess = |pair: &Pair| -> f64 {
        (0..3)
            .map(|c| pair.difference(c).powi(2) - pair.variance[c])
            .sum::<f64>()
            / 3.0
    };
    SquaredError {
        corrected: pixels.iter().map(excess).sum::<f64>() / pixels.len() as f64,
        standard_error: standard_error(pixels, excess),
    }
}

fn psnr_db(pixels: &[Pair]) -> Option<f64> {
    let square = |pair: &Pair, c: usize| (displayed(pair.image[c]) - displayed(pair.reference[c])).powi(2);
    let sum: f64 = pixels
        .iter()
        .map(|pair| (0..3).map(|c| square(pair, c)).sum::<f64>())
        .sum();
    (sum > 0.0).then(|| -10.0 * (sum / (3 * pixels.len()) as f64).log10())
}

/// Whether the pixels' means are near enough to a normal distribution, or exact.
fn nearly_normal(estimate: &Estimate) -> bool {
    estimate.variance.is_none() || estimate.spp.is_some_and(|spp| spp >= FEWEST_SAMPLES)
}

fn uniformity(pixels: &[Pair]) -> Option<Uniformity> {
    const GREEN: usize = 1;
    let mut histogram = [0; BINS];
    let noisy = pixels.iter().filter(|pair| pair.variance[GREEN] > 0.0);
    for pair in noisy {
        let z = pair.difference(GREEN) / pair.variance[GREEN].sqrt();
        let p = two_sided_p(z);
        histogram[((p * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let tested: usize = histogram.iter().sum();
    if tested < FEWEST_TESTED {
        return None;
    }
    let expected = tested as f64 / BINS as f64;
    let unevenness: f64 = histogram
        .iter()
        .map(|&seen| (seen as f64 - expected).powi(2) / expected)
        .sum();
    let p_value = ChiSquared::new((BINS - 1) as f64).ok()?.sf(unevenness);
    Some(Uniformity { histogram, p_value })
}

/// How likely noise alone is to deviate by `z` standard deviations or more, up or down.
fn two_sided_p(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}
