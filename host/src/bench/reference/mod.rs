//! How efficient the reference is beside a plain path tracer, both in double precision and on one thread, timed in turns.
//!
//! The rival ([`plain`]) is what one would write first: the walk that the reference takes, without looking for light and without strata,
//! in C++ with all that the compiler can do for it. Time is that of rendering alone, the best of some rounds: whatever else the
//! machine does makes rounds longer, and nothing makes them shorter. Every round has random numbers of its own, and the variance is that of all.
//! Renderers of different pictures cannot be compared, so the two must agree about the picture first.

mod efficiency;
pub mod plain;

use std::path::Path;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use serde::Serialize;

use crate::image::picture::Estimate;
use crate::oracle::reference::{self, Job, Rendered, Termination};
use crate::render::options::Size;
use crate::scene::{Integrator, Scene};
pub use efficiency::Means;
use efficiency::{apart, brightness, together, variances};
use plain::{Plain, PlainError};

/// How often each of the two renders.
pub const ROUNDS: u64 = 3;
/// The means of two renderers of one picture are no more standard errors apart, but for one run in 5,000.
const SURE: f64 = 4.0;
/// How much more efficient than the plain one the reference has to be on the standard scene, by the arithmetic mean.
const LEAST: f64 = 10.0;
/// The name of that scene.
const STANDARD: &str = "cornell";
/// What the seeds of the plain one begin with: the same generator is seeded in the same way on either side.
const OTHER_SEEDS: u64 = 1 << 32;

/// Why there are no figures, or none that suffice.
#[derive(Debug, thiserror::Error)]
pub enum ContestError {
    /// The plain one has no picture.
    #[error(transparent)]
    Plain(#[from] PlainError),
    /// The reference has no thread.
    #[error("cannot start a thread for the reference (end other programs)")]
    Thread(#[from] ThreadPoolBuildError),
    /// There is no noise to be compared.
    #[error(
        "no pixel of {0} has noise by both; take a scene with light and surfaces that it falls on, or more samples"
    )]
    NoNoise(String),
    /// They render different pictures.
    #[error(
        "the plain path tracer and the reference disagree about {scene}: means {} and {} are {apart:.1} standard errors apart, {SURE} at most \
         are chance; one of the two has a fault (`cargo test --release -p host oracle::reference` judges the reference alone)",
        colour(.plain), colour(.reference)
    )]
    Disagree {
        /// The scene.
        scene: String,
        /// The plain one's mean.
        plain: [f64; 3],
        /// The reference's.
        reference: [f64; 3],
        /// In standard errors.
        apart: f64,
    },
    /// It is not efficient enough.
    #[error(
        "the reference is only {0:.2} times as efficient as the plain path tracer, and {LEAST} times is wanted on the standard scene; if \
         the machine is busy, try again, else see what the reference spends variance and time on (host/src/oracle/reference)"
    )]
    Inefficient(f64),
}

/// Which picture the two render.
#[derive(Clone, Copy, Debug)]
pub struct Contest<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The picture's size.
    pub size: Size,
    /// Samples per pixel in each round, a multiple of 64; from 256 on the reference has all of its strata.
    pub spp: u32,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The scene's name.
    pub scene: String,
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// Samples per pixel in all rounds.
    pub spp: u32,
    /// The plain path tracer.
    pub plain: Side,
    /// The reference.
    pub reference: Side,
    /// By how many standard errors the pictures' means differ: the worst channel.
    pub standard_errors_apart: f64,
    /// How often the reference's efficiency is the plain one's.
    pub ratio: Means,
}

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Side {
    /// Mean radiance of the picture.
    pub mean: [f64; 3],
    /// Variance of one sample.
    pub variance: Means,
    /// Seconds that a sample takes.
    pub seconds_per_sample: f64,
}

/// All rounds of either.
struct Rounds {
    plain: Vec<Estimate>,
    reference: Vec<Rendered>,
    /// The best round's seconds: of the plain one, of the reference.
    seconds: [f64; 2],
}

impl Contest<'_> {
    /// Has both render in turns; `compiler` is g++.
    pub fn hold(&self, compiler: &Path) -> Result<Outcome, ContestError> {
        let rounds = self.rounds(&Plain::build(compiler)?)?;
        self.judge(&rounds)
    }

    fn rounds(&self, plain: &Plain) -> Result<Rounds, ContestError> {
        let thread = ThreadPoolBuilder::new().num_threads(1).build()?;
        let mut rounds = Rounds {
            plain: Vec::new(),
            reference: Vec::new(),
            seconds: [f64::INFINITY; 2],
        };
        for seed in 1..=ROUNDS {
            let rendered = plain.render(self.scene, &self.job(OTHER_SEEDS + seed))?;
            let (known, seconds) = timed(&thread, self.scene, &self.job(seed));
            let best = |now: f64, before: f64| now.min(before);
            rounds.seconds = [
                best(rendered.seconds, rounds.seconds[0]),
                best(seconds, rounds.seconds[1]),
            ];
            rounds.plain.push(rendered.estimate);
            rounds.reference.push(known);
        }
        Ok(rounds)
    }

    fn job(&self, seed: u64) -> Job {
        Job {
            width: self.size.width,
            height: self.size.height,
            spp: self.spp,
            termination: Termination::Roulette,
            seed,
        }
    }

    fn judge(&self, rounds: &Rounds) -> Result<Outcome, ContestError> {
        let scene = &self.scene.name;
        let no_noise = || ContestError::NoNoise(scene.clone());
        let known: Vec<Estimate> = rounds
            .reference
            .iter()
            .map(|round| round.estimate.clone())
            .collect();
        let reference = together(&known).ok_or_else(no_noise)?;
        let plain = together(&rounds.plain).ok_or_else(no_noise)?;
        let with_noise = together(&rounds.with_noise()).ok_or_else(no_noise)?;
        let brightness = |estimate: &Estimate| brightness(estimate).ok_or_else(no_noise);
        let (means, known_means) = (brightness(&with_noise)?, brightness(&reference)?);
        let apart = apart(means, known_means);
        if apart > SURE {
            return Err(ContestError::Disagree {
                scene: scene.clone(),
                plain: means.0,
                reference: known_means.0,
                apart,
            });
        }
        let variances = variances(&plain, &reference).ok_or_else(no_noise)?;
        let samples = self.job(0).samples() as f64;
        let [plain, reference] = [0, 1].map(|side| Side {
            mean: [means.0, known_means.0][side],
            variance: variances[side],
            seconds_per_sample: rounds.seconds[side] / samples,
        });
        Ok(Outcome {
            scene: scene.clone(),
            width: self.size.width,
            height: self.size.height,
            spp: self.spp * ROUNDS as u32,
            plain,
            reference,
            standard_errors_apart: apart,
            ratio: ratio(&plain, &reference),
        })
    }
}

impl Rounds {
    /// The plain one's pictures with the noise that is known of such paths: where few samples have met with nothing rare and bright, their own
    /// spread would make an error of that.
    fn with_noise(&self) -> Vec<Estimate> {
        let pairs = self.reference.iter().zip(&self.plain);
        let pooled = pairs.map(|(known, plain)| known.pooled_noise(plain.clone(), Integrator::Path));
        pooled.collect()
    }
}

/// Renders on this one thread, and takes the time.
fn timed(thread: &ThreadPool, scene: &Scene, job: &Job) -> (Rendered, f64) {
    thread.install(|| {
        let start = Instant::now();
        let rendered = reference::render(scene, job, |_| ());
        (rendered, start.elapsed().as_secs_f64())
    })
}

/// How often the efficiency of `reference` is that of `plain`.
fn ratio(plain: &Side, reference: &Side) -> Means {
    let time = plain.seconds_per_sample / reference.seconds_per_sample;
    let by = |mean: fn(&Means) -> f64| mean(&plain.variance) / mean(&reference.variance) * time;
    Means {
        arithmetic: by(|means| means.arithmetic),
        geometric: by(|means| means.geometric),
    }
}

impl Outcome {
    /// Whether the reference is as efficient as it has to be: of the standard scene that is known, of others nothing is asked.
    pub fn suffices(&self) -> Result<(), ContestError> {
        if self.scene == STANDARD && self.ratio.arithmetic < LEAST {
            return Err(ContestError::Inefficient(self.ratio.arithmetic));
        }
        Ok(())
    }

    /// The figures for people.
    pub fn table(&self) -> String {
        let row = |name: &str, side: &Side| {
            format!(
                "{name:20} {:>12.5} {:>12.5} {:>10.0} ns   {}",
                side.variance.arithmetic,
                side.variance.geometric,
                1e9 * side.seconds_per_sample,
                colour(&side.mean)
            )
        };
        let heading = format!(
            "{:20} {:>25} {:>13}   {}\n{:20} {:>12} {:>12} {:>13}   {}",
            format!("{} {}x{}", self.scene, self.width, self.height),
            "variance of a sample,",
            "time of a",
            "mean radiance:",
            format!("{} samples a pixel", self.spp),
            "mean",
            "geometric",
            "sample",
            "red, green, blue"
        );
        let verdict = format!(
            "The reference is {:.1} times as efficient, and {:.1} times by the geometric mean over pixels. The means are {:.1} standard errors apart.",
            self.ratio.arithmetic, self.ratio.geometric, self.standard_errors_apart
        );
        [
            heading,
            row("plain path tracer", &self.plain),
            row("reference", &self.reference),
            verdict,
        ]
        .join("\n")
    }
}

fn colour(mean: &[f64; 3]) -> String {
    mean.map(|channel| format!("{channel:.4}")).join(" ")
}

#[cfg(test)]
mod tests;
