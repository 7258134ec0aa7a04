//! What efficiency is: one over the variance of a sample times the time that it takes.

use serde::Serialize;

use crate::image::picture::{Estimate, Picture};

/// Below this share of the mean's square a variance is none: it is what rounding left.
const ROUNDING: f64 = 1e-12;

/// A figure by either mean over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Means {
    /// The arithmetic mean: it is that of the noisiest pixels.
    pub arithmetic: f64,
    /// The geometric mean: in a ratio of two every pixel counts alike. Of variances by few samples it is too small.
    pub geometric: f64,
}

/// Variances of one sample of two renderers. The geometric mean is over those pixels and channels in which both have noise: one of nothing but
/// lamp says nothing of either. `None` where there are no such pixels, or one of the variances is unknown.
pub(super) fn variances(one: &Estimate, other: &Estimate) -> Option<[Means; 2]> {
    let (one, other) = (of_a_sample(one)?, of_a_sample(other)?);
    let pairs = one
        .iter()
        .zip(&other)
        .filter(|(one, other)| **one > 0.0 && **other > 0.0);
    let logarithms: Vec<[f64; 2]> = pairs.map(|(one, other)| [one.ln(), other.ln()]).collect();
    if logarithms.is_empty() {
        return None;
    }
    let geometric = [0, 1].map(|side| mean(logarithms.iter().map(|pair| pair[side])).exp());
    let arithmetic = [one, other].map(|values| mean(values.into_iter()));
    Some([0, 1].map(|side| Means {
        arithmetic: arithmetic[side],
        geometric: geometric[side],
    }))
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// The variance of one sample in every channel of every pixel, without what is but rounding.
fn of_a_sample(estimate: &Estimate) -> Option<Vec<f64>> {
    let samples = f64::from(estimate.spp?);
    let pixels = estimate.picture.pixels().iter().zip(estimate.variance.as_ref()?);
    let channels = pixels.flat_map(|(mean, variance)| {
        [0, 1, 2].map(|c| {
            let mean = mean.map_or(0.0, |mean| mean[c]);
            let is_noise = variance[c] * samples > ROUNDING * mean * mean;
            if is_noise { variance[c] * samples } else { 0.0 }
        })
    });
    Some(channels.collect())
}

/// One picture of several that are independent of each other and of as many samples each.
pub(super) fn together(estimates: &[Estimate]) -> Option<Estimate> {
    let first = estimates.first()?;
    let count = estimates.len() as f64;
    let size = first.picture.size();
    let mut means = vec![[0.0; 3]; first.picture.pixels().len()];
    let mut variances = means.clone();
    let mut samples = 0;
    for estimate in estimates {
        samples += estimate.spp?;
        for (sum, pixel) in means.iter_mut().zip(estimate.picture.pixels()) {
            add(sum, &(*pixel)?, count);
        }
        for (sum, variance) in variances.iter_mut().zip(estimate.variance.as_ref()?) {
            add(sum, variance, count * count);
        }
    }
    Some(Estimate {
        picture: Picture::new(size.0, size.1, means.into_iter().map(Some).collect()),
        variance: Some(variances),
        spp: Some(samples),
    })
}

fn add(sum: &mut [f64; 3], part: &[f64; 3], divisor: f64) {
    for (sum, part) in sum.iter_mut().zip(part) {
        *sum += part / divisor;
    }
}

/// A picture's mean, and the standard error of that, by channel.
pub(super) fn brightness(estimate: &Estimate) -> Option<([f64; 3], [f64; 3])> {
    let variance = estimate.variance.as_ref()?;
    let error = |c: usize| variance.iter().map(|pixel| pixel[c]).sum::<f64>().sqrt() / variance.len() as f64;
    Some((estimate.picture.mean()?, [0, 1, 2].map(error)))
}

/// By how many standard errors two means differ: the worst of the channels, and no more than rounding counts as nothing.
pub(super) fn apart((one, error): ([f64; 3], [f64; 3]), (other, other_error): ([f64; 3], [f64; 3])) -> f64 {
    let channel = |c: usize| {
        let difference = (one[c] - other[c]).abs();
        if difference <= ROUNDING * other[c].abs() {
            return 0.0;
        }
        difference / error[c].hypot(other_error[c])
    };
    [0, 1, 2].map(channel).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(means: &[f64], variances: &[f64], spp: u32) -> Estimate {
        let grey = |values: &[f64]| values.iter().map(|&value| [value; 3]).collect::<Vec<_>>();
        Estimate {
            picture: Picture::new(means.len() as u16, 1, grey(means).into_iter().map(Some).collect()),
            variance: Some(grey(variances)),
            spp: Some(spp),
        }
    }

    #[test]
    fn the_geometric_mean_is_over_pixels_in_which_both_have_noise_and_the_other_over_all() {
        // Of a lamp; of a lamp that only one of them sees to be one, but for rounding; two pixels with noise.
        let one = estimate(&[12.0, 12.0, 1.0, 2.0], &[0.0, 0.5, 1.0, 4.0], 8);
        let other = estimate(&[12.0, 12.0, 1.0, 2.0], &[0.0, 1e-14, 0.25, 0.25], 4);
        let [one, other] = variances(&one, &other).expect("there is noise");
        assert_eq!(one.arithmetic, 11.0);
        assert!((one.geometric - 16.0).abs() < 1e-12, "{one:?}");
        assert_eq!(other.arithmetic, 0.5);
        assert!((other.geometric - 1.0).abs() < 1e-12, "{other:?}");
        assert_eq!(
            variances(&estimate(&[1.0], &[0.0], 4), &estimate(&[1.0], &[1.0], 4)),
            None
        );
    }

    #[test]
    fn pictures_together_have_the_samples_of_all_and_the_same_variance_of_one() {
        let parts = [
            estimate(&[1.0, 4.0], &[0.5, 1.0], 64),
            estimate(&[3.0, 4.0], &[0.5, 3.0], 64),
        ];
        assert_eq!(together(&parts), Some(estimate(&[2.0, 4.0], &[0.25, 1.0], 128)));
        assert_eq!(together(&[]), None);
    }

    #[test]
    fn means_are_apart_by_the_worst_channel_in_standard_errors_of_both() {
        let one = ([1.0, 2.0, 0.0], [0.3, 0.03, 0.0]);
        let other = ([1.1, 2.1, 0.0], [0.4, 0.04, 0.0]);
        assert!((apart(one, other) - 2.0).abs() < 1e-9, "{}", apart(one, other));
        // Without noise nothing but rounding may part them.
        let exact = |value: f64| ([value; 3], [0.0; 3]);
        assert_eq!(apart(exact(1.0), exact(1.0 + 1e-14)), 0.0);
        assert_eq!(apart(exact(1.0), exact(1.0 + 1e-9)), f64::INFINITY);
    }
}
