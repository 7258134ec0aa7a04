//! The lockstep oracle: the tracer's own source over `f64`, driven by a profile's own random numbers.
//!
//! What differs between its picture and a core's is arithmetic, and nothing else: each sample of the double begins with the random
//! numbers that the core's own begins with, so that no Monte Carlo noise stands between the two but that of paths which rounding
//! sends another way. It shares the tracer's formulas, so a wrong formula is not seen here; [`crate::oracle::reference`] is there
//! for that.
//!
//! Cores send sums and no squares, so a picture's own noise is found here as well: the same samples are taken again.

pub(crate) mod samples;

use fixedmath::I16F16;
use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::integrator::{Integrator, Path};
use tracer::material::RadianceNumbers;
use tracer::profile::Profile;
use tracer::random::Random;
use tracer::scene::All;
use tracer::unit::Plan;

use self::samples::samples;
use crate::firmware::Choice;
use crate::firmware::arithmetic::{Arithmetic, Sampler, with_choice, with_profile};
use crate::image::picture::{Estimate, Picture};
use crate::scene::CompiledScene;

/// Profile `P` in double precision: its random numbers, its formulas, exact arithmetic.
pub type Lockstep<P> = floating::Lockstep<P, f64>;

/// A picture, its double, and how sure their difference is.
#[derive(Clone, Debug, PartialEq)]
pub struct Paired {
    /// The picture. A fleet's is the same but for the rounding of its sums: a unit's to 2^-16.
    pub picture: Estimate,
    /// The same samples in double precision.
    pub double: Estimate,
    /// Variance of the mean of each pixel's differences, by channel.
    pub variance: Vec<[f64; 3]>,
}

impl Paired {
    /// The picture with the noise of its difference from the double, and the double as if it were exact: what comes of comparing these is
    /// arithmetic.
    pub fn difference(&self) -> (Estimate, Estimate) {
        let picture = Estimate {
            variance: Some(self.variance.clone()),
            ..self.picture.clone()
        };
        let double = Estimate {
            variance: None,
            ..self.double.clone()
        };
        (picture, double)
    }
}

/// A pixel's samples, those of its double, and their differences.
#[derive(Clone, Copy, Default)]
struct Pixel {
    picture: Moments,
    double: Moments,
    difference: Moments,
}

/// Renders `plan` by profile `P` and in double precision: every pass, on all host cores.
///
/// `progress` is told of samples done since it was last told.
pub fn render<P: Profile<Random: Clone>>(
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Paired {
    render_beside::<P>(compiled, plan, plan.epsilon, progress)
}

/// The same by a profile and a sampler that are chosen at run time.
pub fn render_as(
    profile: Arithmetic,
    sampler: Sampler,
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Paired {
    with_profile!(profile, sampler, P => render::<P>(compiled, plan, progress))
}

/// The same by `precise` but for one choice, which is the published system's.
pub fn render_choice(
    choice: Choice,
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Paired {
    render_choice_beside(choice, compiled, plan, plan.epsilon, progress)
}

/// The same beside doubles of another epsilon than `plan`'s.
pub fn render_choice_beside(
    choice: Choice,
    compiled: &CompiledScene,
    plan: &Plan,
    epsilon: I16F16,
    progress: impl Fn(u64) + Sync,
) -> Paired {
    with_choice!(choice, P => render_beside::<P>(compiled, plan, epsilon, progress))
}

/// The same beside doubles of another epsilon than `plan`'s.
pub fn render_beside<P: Profile<Random: Clone>>(
    compiled: &CompiledScene,
    plan: &Plan,
    epsilon: I16F16,
    progress: impl Fn(u64) + Sync,
) -> Paired {
    let scene = compiled.view();
    let exact = Plan { epsilon, ..*plan };
    let paths = (Path::<P, All>::new(plan), Path::<Lockstep<P>, All>::new(&exact));
    let cameras = (Camera::new(&compiled.camera), Camera::new(&compiled.camera));
    let unit = 2f64.powi(-compiled.exponent);
    let spans: Vec<Vec<Pixel>> = (0..plan.spans())
        .into_par_iter()
        .map(|span| {
            let mut pixels = vec![Pixel::default(); usize::from(plan.extent(span).pixels)];
            for pass in 0..plan.passes() {
                let id = pass * plan.spans() + span;
                let mut random = P::Random::for_unit(plan.seed, id);
                let mut last = None;
                for (pixel, [column, row]) in samples(plan, id) {
                    if last.replace(pixel) != Some(pixel) {
                        random.start_pixel();
                    }
                    random.start_sample();
                    let mut doubles = random.clone();
                    let ray = cameras.0.ray(column, row, &mut random);
                    let sample = paths.0.sample(&scene, ray, &mut random);
                    let ray = cameras.1.ray(column, row, &mut doubles);
                    let double = paths.1.sample(&scene, ray, &mut doubles);
                    let radiance = sample
                        .radiance
                        .map(|radiance| P::Numbers::film_sum(radiance).to_num::<f64>() * unit);
                    pixels[pixel].add(radiance, double.radiance.map(|radiance| radiance * unit));
                }
                let extent = plan.extent(id);
                progress(u64::from(extent.pixels) * u64::from(extent.samples));
            }
            pixels
        })
        .collect();
    let pixels = spans.concat();
    let estimate = |moments: fn(&Pixel) -> &Moments| {
        let means = pixels.iter().map(|pixel| Some(moments(pixel).mean()));
        let variance = pixels.iter().map(|pixel| moments(pixel).variance_of_mean());
        Estimate {
            picture: Picture::new(plan.width, plan.height, means.collect()),
            variance: Some(variance.collect()),
            spp: Some(plan.spp),
        }
    };
    Paired {
        picture: estimate(|pixel| &pixel.picture),
        double: estimate(|pixel| &pixel.double),
        variance: pixels
            .iter()
            .map(|pixel| pixel.difference.variance_of_mean())
            .collect(),
    }
}

impl Pixel {
    fn add(&mut self, picture: [f64; 3], double: [f64; 3]) {
        self.picture.add(picture);
        self.double.add(double);
        self.difference
            .add([0, 1, 2].map(|channel| picture[channel] - double[channel]));
    }
}

/// Count, sum and sum of squares of one pixel's samples.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    sum: [f64; 3],
    squares: [f64; 3],
}

impl Moments {
    fn add(&mut self, radiance: [f64; 3]) {
        self.count += 1.0;
        for (channel, value) in radiance.into_iter().enumerate() {
            self.sum[channel] += value;
            self.squares[channel] += value * value;
        }
    }

    fn mean(&self) -> [f64; 3] {
        self.sum.map(|sum| sum / self.count)
    }

    fn variance_of_mean(&self) -> [f64; 3] {
        let mean = self.mean();
        [0, 1, 2].map(|channel| {
            let excess = self.squares[channel] - self.count * mean[channel] * mean[channel];
            (excess / (self.count - 1.0) / self.count).max(0.0)
        })
    }
}
