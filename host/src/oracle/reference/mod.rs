//! The reference: an independent path tracer in double precision, on all of the host's cores.
//!
//! `docs/reference.md` says by what method, and how it is checked. The rooms within: `vector` and `sampling` below all,
//! `ball` (intersection), `camera`, `lights` (where light may come from), `images` with its table `rings` and `caustics` (where light may
//! come from by way of balls), `walk` (what a path carries and is worth), and `path`, which puts them together.
//!
//! It tells what the picture *should* look like, and how sure it is of every pixel. Each row of the picture draws from a
//! stream of its own (the generator's `jump` puts 2^128 numbers between them), so that the same seed gives the same
//! picture on any number of threads. [`cache`] keeps results.

mod ball;
pub mod cache;
mod camera;
mod caustics;
pub mod effort;
mod images;
mod lights;
mod path;
mod rings;
mod sampling;
mod vector;
mod walk;

use std::sync::atomic::{AtomicU64, Ordering};

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use rayon::prelude::*;

use camera::SubPixel;
use sampling::{Batch, Draws};
use vector::Vector;

use super::moments::Moments;
use crate::image::picture::{Estimate, Picture};
use crate::scene::{Integrator, Scene};

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// From the sixth surface on, with a probability of one minus the surface's strongest reflectance.
    Roulette,
    /// At this many surfaces.
    Depth(u8),
}

/// What to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// Samples per pixel, a multiple of 4: the 2x2 sub-pixels.
    pub spp: u32,
    /// When a path ends.
    pub termination: Termination,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Job {
    /// Samples of the whole picture.
    pub fn samples(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * u64::from(self.spp)
    }
}

/// What is known of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The picture, and how uncertain it is.
    pub estimate: Estimate,
    /// Variance of one sample of a *plain* path tracer, that meets light and does not look for it: what noise a picture by the cores' paths
    /// has if nothing is wrong with it.
    pub plain_variance: Vec<[f64; 3]>,
    /// The same of a path tracer that looks for light at diffuse surfaces, and for nothing that balls show of it.
    pub looking_variance: Vec<[f64; 3]>,
}

impl Rendered {
    /// `picture` by this integrator with a better estimate of its noise, if it has one: its own samples' and the reference's together.
    ///
    /// A picture whose few samples have met with nothing rare and bright takes itself for exact, and its darkness for an error.
    #[must_use]
    pub fn pooled_noise(&self, picture: Estimate, integrator: Integrator) -> Estimate {
        let (Some(own), Some(samples), Some(others)) = (&picture.variance, picture.spp, self.estimate.spp)
        else {
            return picture;
        };
        let (samples, others) = (f64::from(samples), f64::from(others));
        let of_a_sample = match integrator {
            Integrator::Path => &self.plain_variance,
            Integrator::NextEvent => &self.looking_variance,
        };
        let pooled = own.iter().zip(of_a_sample).map(|(own, known)| {
            [0, 1, 2].map(|c| (samples * own[c] + others * known[c] / samples) / (samples + others))
        });
        Estimate {
            variance: Some(pooled.collect()),
            ..picture
        }
    }
}

/// Renders `scene`; `progress` hears how many samples are done, from any thread, once for every row.
///
/// The estimate always has a variance. With 4 samples per pixel it is that of the four sub-pixels taken together.
///
/// # Panics
/// If `job.spp` is not a multiple of 4 above zero.
pub fn render(scene: &Scene, job: &Job, progress: impl Fn(u64) + Sync) -> Rendered {
    assert!(
        job.spp > 0 && job.spp.is_multiple_of(4),
        "{} samples per pixel: must be a multiple of 4",
        job.spp
    );
    let world = path::World::new(scene, job.termination);
    render_world(&world, sampling::batch_size(job.spp / 4), scene, job, progress)
}

/// Renders `world`, which is that of `scene`, in batches of so many samples.
fn render_world(
    world: &path::World,
    batch_size: u32,
    scene: &Scene,
    job: &Job,
    progress: impl Fn(u64) + Sync,
) -> Rendered {
    let view = camera::View::new(&scene.camera, job.width, job.height);
    let done = AtomicU64::new(0);
    let mut stream = Xoshiro256PlusPlus::seed_from_u64(job.seed);
    let streams: Vec<_> = (0..job.height)
        .map(|_| {
            let row = stream.clone();
            stream.jump();
            row
        })
        .collect();
    let pixels: Vec<Pixel> = (0..job.height)
        .into_par_iter()
        .zip(streams)
        .flat_map_iter(|(row, mut random)| {
            let pixels: Vec<_> = (0..job.width)
                .map(|column| pixel(world, &view, [column, row], job.spp / 4, batch_size, &mut random))
                .collect();
            let samples = u64::from(job.width) * u64::from(job.spp);
            progress(done.fetch_add(samples, Ordering::Relaxed) + samples);
            pixels
        })
        .collect();
    of_pixels(&pixels, job)
}

fn of_pixels(pixels: &[Pixel], job: &Job) -> Rendered {
    let means = pixels.iter().map(|pixel| Some(pixel.mean)).collect();
    Rendered {
        estimate: Estimate {
            picture: Picture::new(job.width, job.height, means),
            variance: Some(pixels.iter().map(|pixel| pixel.variance).collect()),
            spp: Some(job.spp),
        },
        plain_variance: pixels.iter().map(|pixel| pixel.plain_variance).collect(),
        looking_variance: pixels.iter().map(|pixel| pixel.looking_variance).collect(),
    }
}

/// One pixel's figures.
#[derive(Clone, Copy)]
struct Pixel {
    mean: [f64; 3],
    /// Of the mean.
    variance: [f64; 3],
    /// Of one plain sample.
    plain_variance: [f64; 3],
    /// Of one that looks for light.
    looking_variance: [f64; 3],
}

/// The samples of one sub-pixel.
struct Stratum {
    /// Of batches.
    moments: Moments,
    /// Mean squares of samples by other methods.
    plain_square: Vector,
    looking_square: Vector,
}

fn pixel(
    world: &path::World,
    view: &camera::View,
    pixel: [u16; 2],
    samples: u32,
    batch_size: u32,
    random: &mut Xoshiro256PlusPlus,
) -> Pixel {
    let strata = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|part| {
        let sub_pixel = SubPixel { view, pixel, part };
        stratum(world, &sub_pixel, samples, batch_size, random)
    });
    let mean = [0, 1, 2].map(|channel| {
        strata
            .iter()
            .map(|stratum| stratum.moments.mean[channel])
            .sum::<f64>()
            / 4.0
    });
    // The sub-pixels are strata of equal weight: the variances of their means add up, over 4 squared.
    let variance = if samples > batch_size {
        [0, 1, 2].map(|channel| {
            let variances = strata
                .iter()
                .map(|stratum| stratum.moments.variance_of_mean(channel));
            variances.sum::<f64>() / 16.0
        })
    } else {
        let mut all = Moments::default();
        strata.iter().for_each(|stratum| all.add(stratum.moments.mean));
        [0, 1, 2].map(|channel| all.variance_of_mean(channel))
    };
    let variance_by = |square: fn(&Stratum) -> Vector| {
        [0, 1, 2].map(|channel| {
            let variances = strata.iter().map(|stratum| {
                let square = square(stratum).components()[channel];
                (square - stratum.moments.mean[channel].powi(2)).max(0.0)
            });
            variances.sum::<f64>() / 4.0
        })
    };
    Pixel {
        mean,
        variance,
        plain_variance: variance_by(|stratum| stratum.plain_square),
        looking_variance: variance_by(|stratum| stratum.looking_square),
    }
}

fn stratum(
    world: &path::World,
    sub_pixel: &SubPixel<'_>,
    samples: u32,
    batch_size: u32,
    random: &mut Xoshiro256PlusPlus,
) -> Stratum {
    let dark = Vector::of([0.0; 3]);
    let mut moments = Moments::default();
    let (mut plain_square, mut looking_square) = (dark, dark);
    let shows_an_edge = world.shows_an_edge(sub_pixel, &mut Draws::free(random));
    for _ in 0..samples / batch_size {
        let mut sum = dark;
        Batch::new(batch_size, random).draws(random, |draws| {
            let found = world.sample(sub_pixel, draws);
            let seen = if shows_an_edge {
                world.seen(sub_pixel, draws)
            } else {
                found.seen
            };
            sum = sum + found.reflected + seen;
            plain_square = plain_square + found.plain_square;
            looking_square = looking_square + found.looking_square;
        });
        moments.add((sum * (1.0 / f64::from(batch_size))).components());
    }
    let of_a_sample = 1.0 / f64::from(samples);
    Stratum {
        moments,
        plain_square: plain_square * of_a_sample,
        looking_square: looking_square * of_a_sample,
    }
}

#[cfg(test)]
mod agreement;
#[cfg(test)]
mod tests;
