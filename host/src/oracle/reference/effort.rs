//! How many samples the reference takes: so many that its noise is not what a comparison sees.
//!
//! Its standard error, of the whole picture's mean and of the median tile, is to be below half of the picture's: then it adds
//! less than 12 % to the noise of their difference. How noisy the reference is, pilots say, whose samples are not used again: an
//! estimate that decided by itself when it is good enough would end where its bright, rare paths happen to be missing.

use super::{Job, Rendered, Termination};
use crate::image::picture::Estimate;
use crate::oracle::compare::{FEWEST_SAMPLES, NoiseShare};
use crate::scene::Integrator;

/// What the reference's standard error may be of the picture's.
pub const MOST_SHARE: f64 = 0.5;
/// By how much the true variance may be above a pilot's and the share still hold: few of its samples meet with the rarest light.
const MARGIN: f64 = 1.5;
/// Samples a pixel of the first pilot, at most, and the fewest of a reference.
const PILOT: u32 = 64;
/// Samples of the whole first pilot that are enough, and the fewest of a pixel: of fewer, strata keep too little apart to tell the noise of more.
const ENOUGH_OF_PILOT: u64 = 1 << 19;
const FEWEST_OF_PILOT: u32 = 32;
/// Samples a pixel, at most, for one of the picture's. The reference's samples have no more variance than those of a plain path tracer,
/// of which [`MARGIN`] times 4 would do; one that looks for light has a few times less.
const MOST_OF_PICTURE: u64 = 16;
/// Samples of the whole reference, at most: an hour or two of two processors.
const MOST_SAMPLES: u64 = 1 << 32;

/// The reference for `picture`, found by `render`, which renders a job or has it from a cache.
///
/// The result says how many samples a pixel it has: a power of two, so that it is found again. It has the most that is sensible where
/// the picture's variance is not known, and no more where that is not enough. What noise the picture has by its `integrator`, the pilots know
/// better than its own samples, if those are few.
pub fn reference_for(
    picture: &Estimate,
    integrator: Integrator,
    termination: Termination,
    seed: u64,
    render: impl Fn(&Job) -> Rendered,
) -> Rendered {
    let (width, height) = picture.picture.size();
    let job = |spp: u32, seed: u64| Job {
        width,
        height,
        spp,
        termination,
        seed,
    };
    let pixels = u64::from(width) * u64::from(height);
    let mut spp = power_of_two(ENOUGH_OF_PILOT / pixels.max(1)).clamp(FEWEST_OF_PILOT, PILOT);
    for pilot in 1..=2 {
        let found = render(&job(spp, seed.wrapping_add(pilot)));
        let picture = found.pooled_noise(picture.clone(), integrator);
        let wanted = enough(&found.estimate, spp, &picture);
        // A pilot that is a sixteenth of what is wanted has seen enough of it.
        if pilot == 2 || wanted <= 16 * spp {
            spp = wanted;
            break;
        }
        spp = wanted / 16;
    }
    render(&job(spp, seed))
}

/// How many samples a pixel are enough, by a pilot of `spp`.
fn enough(pilot: &Estimate, spp: u32, picture: &Estimate) -> u32 {
    let most = most(picture);
    let Some(share) = NoiseShare::of(pilot, picture) else {
        return most;
    };
    let wanted = f64::from(spp) * MARGIN * (share.largest() / MOST_SHARE).powi(2);
    // The comparison tests pixels where both sides have so many samples.
    let fewest = picture.spp.map_or(PILOT, |spp| power_of_two(spp.into()));
    let fewest = fewest.clamp(PILOT, FEWEST_SAMPLES).min(most);
    // Casts saturate.
    power_of_two(wanted.ceil() as u64).clamp(fewest, most)
}

/// The most samples a pixel that are sensible.
fn most(picture: &Estimate) -> u32 {
    let pixels = picture.picture.pixels().len() as u64;
    let affordable = MOST_SAMPLES / pixels.max(1).next_power_of_two();
    let sensible = picture
        .spp
        .map_or(affordable, |spp| MOST_OF_PICTURE * u64::from(spp));
    power_of_two(sensible).min(power_of_two(affordable)).max(PILOT)
}

/// The next power of two, up to the greatest of 32 bits.
fn power_of_two(samples: u64) -> u32 {
    samples.clamp(1, 1 << 31).next_power_of_two() as u32
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::image::picture::Picture;

    const SPP: u32 = 1024;

    /// A picture of 16x16 pixels of `spp` samples of this variance.
    fn flat(variance: f64, spp: u32) -> Estimate {
        Estimate {
            picture: Picture::new(16, 16, vec![Some([0.5; 3]); 256]),
            variance: Some(vec![[variance / f64::from(spp); 3]; 256]),
            spp: Some(spp),
        }
    }

    /// The jobs that are rendered where a reference's sample has this variance, and the result.
    fn jobs(picture: &Estimate, variance: f64) -> (Vec<Job>, Estimate) {
        let jobs = RefCell::new(Vec::new());
        let own = picture.variance.iter().flatten();
        let of_a_sample = own.map(|own| own.map(|variance| variance * f64::from(picture.spp.unwrap_or(1))));
        let of_a_sample: Vec<[f64; 3]> = of_a_sample.collect();
        let found = reference_for(picture, Integrator::Path, Termination::Roulette, 7, |job| {
            jobs.borrow_mut().push(*job);
            Rendered {
                estimate: flat(variance, job.spp),
                plain_variance: of_a_sample.clone(),
                looking_variance: Vec::new(),
            }
        });
        (jobs.into_inner(), found.estimate)
    }

    #[test]
    fn its_noise_is_below_half_and_no_pilot_is_used_again() {
        for variance in [1e-6, 0.01, 0.13, 0.5, 1.0] {
            let picture = flat(1.0, SPP);
            let (jobs, found) = jobs(&picture, variance);
            let share = NoiseShare::of(&found, &picture).unwrap();
            assert!(share.largest() < MOST_SHARE, "{variance}: {share:?}");
            // Not more than twice what would do, or what the pixels' test wants.
            let would_do = (4.0 * MARGIN * variance * f64::from(SPP)).max(f64::from(FEWEST_SAMPLES));
            assert!(
                f64::from(found.spp.unwrap()) < 2.0 * would_do,
                "{variance}: {found:?}"
            );
            assert!(found.spp.unwrap().is_power_of_two());
            let (last, pilots) = jobs.split_last().unwrap();
            assert_eq!(last.seed, 7);
            assert!(!pilots.is_empty() && pilots.iter().all(|pilot| pilot.seed != 7));
        }
    }

    #[test]
    fn a_first_pilot_that_sees_little_is_followed_by_another() {
        let picture = flat(1.0, 65536);
        let (jobs, _) = jobs(&picture, 1.0);
        let spp: Vec<u32> = jobs.iter().map(|job| job.spp).collect();
        assert_eq!(spp, [64, 32768, 1 << 19]);
    }

    #[test]
    fn the_work_is_bounded() {
        // A reference worse than the picture, as no scene should have it; one of a picture that is too large; an unknown picture.
        assert_eq!(jobs(&flat(1.0, 1024), 100.0).1.spp, Some(16384));
        assert_eq!(jobs(&flat(1.0, 1 << 28), 1.0).1.spp, Some(1 << 24));
        let unknown = Estimate {
            variance: None,
            ..flat(1.0, 64)
        };
        assert_eq!(jobs(&unknown, 1.0).1.spp, Some(1024));
    }

    #[test]
    fn a_picture_without_noise_takes_the_fewest() {
        assert_eq!(jobs(&flat(0.0, 16), 0.0).1.spp, Some(PILOT));
    }
}
