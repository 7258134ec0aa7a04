//! The lockstep oracle: the tracer's own source over `f64`, driven by a profile's own random numbers.
//!
//! What differs between its picture and a core's is arithmetic, and nothing else: no Monte Carlo noise stands between
//! the two until rounding sends a path another way. It shares the tracer's formulas, so a wrong formula is not seen
//! here; [`crate::oracle::reference`] is there for that.

mod paired;
pub(crate) mod samples;

use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::integrator::{Integrator, Path};
use tracer::profile::Profile;
use tracer::scene::All;
use tracer::unit::{Plan, walk};

use crate::image::picture::{Estimate, Picture};
use crate::scene::CompiledScene;

pub use paired::{Paired, paired};

/// Profile `P` in double precision: its random numbers, its formulas, exact arithmetic.
pub type Lockstep<P> = floating::Lockstep<P, f64>;

/// Renders `plan` in lockstep with profile `P`: every pass, on all host cores.
///
/// `progress` is told of samples done since it was last told.
pub fn render<P: Profile>(compiled: &CompiledScene, plan: &Plan, progress: impl Fn(u64) + Sync) -> Estimate {
    let (scene, path) = (compiled.view(), Path::<Lockstep<P>, All>::new(plan));
    let camera = Camera::new(&compiled.camera);
    let unit = 2f64.powi(-compiled.exponent);
    let spans: Vec<Vec<Moments>> = (0..plan.spans())
        .into_par_iter()
        .map(|span| {
            let mut moments = vec![Moments::default(); usize::from(plan.extent(span).pixels)];
            for pass in 0..plan.passes() {
                let id = pass * plan.spans() + span;
                walk(&path, &scene, &camera, plan, id, |pixel, sample| {
                    moments[pixel].add(sample.radiance.map(|radiance| radiance * unit))
                });
                let extent = plan.extent(id);
                progress(u64::from(extent.pixels) * u64::from(extent.samples));
            }
            moments
        })
        .collect();
    let moments = spans.concat();
    let pixels = moments.iter().map(|moments| Some(moments.mean())).collect();
    Estimate {
        picture: Picture::new(plan.width, plan.height, pixels),
        variance: Some(moments.iter().map(Moments::variance_of_mean).collect()),
        spp: Some(plan.spp),
    }
}

/// Count, sum and sum of squares of one pixel's samples.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moments {
    count: f64,
    sum: [f64; 3],
    squares: [f64; 3],
}

impl Moments {
    pub(crate) fn add(&mut self, radiance: [f64; 3]) {
        self.count += 1.0;
        for (channel, value) in radiance.into_iter().enumerate() {
            self.sum[channel] += value;
            self.squares[channel] += value * value;
        }
    }

    fn mean(&self) -> [f64; 3] {
        self.sum.map(|sum| sum / self.count)
    }

    pub(crate) fn variance_of_mean(&self) -> [f64; 3] {
        let mean = self.mean();
        [0, 1, 2].map(|channel| {
            let excess = self.squares[channel] - self.count * mean[channel] * mean[channel];
            (excess / (self.count - 1.0) / self.count).max(0.0)
        })
    }
}
