//! How noisy one sample is, pixel by pixel: what fixed point's own units say.
//!
//! A pixel's samples in one unit may keep apart on purpose, but units know nothing of each other. So the variance of a pixel's means over many
//! units, times the samples that each is of, is the variance of one sample as far as a picture is concerned: of independent samples it is
//! just that, and of others what is left of it.

use fixedmath::U48F16;
use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::integrator::{Integrator as _, Path};
use tracer::profile::Profile;
use tracer::scene::All;
use tracer::unit::{Plan, SPAN, render};

use super::moments::Moments;
use crate::firmware::Choice;
use crate::firmware::arithmetic::{Arithmetic, Sampler, with_choice, with_profile};
use crate::scene::CompiledScene;

/// The fewest units of a pixel that say anything.
pub const FEWEST_UNITS: u32 = 4;

/// Variance of one sample by pixel, the mean of the channels'.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// In row-major order.
    pub variance: Vec<f64>,
}

impl Noise {
    /// Over all pixels.
    pub fn mean(&self) -> f64 {
        self.variance.iter().sum::<f64>() / self.variance.len() as f64
    }

    /// The variance that this share of pixels does not exceed.
    pub fn quantile(&self, share: f64) -> f64 {
        let mut sorted = self.variance.clone();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1);
        sorted
            .get((share * last as f64).round() as usize)
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// The geometric mean over pixels of another's variance over this one's; of pixels that have any in both.
    pub fn less_than(&self, other: &Self) -> f64 {
        let pairs = self.variance.iter().zip(&other.variance);
        let ratios = pairs.filter(|(own, other)| **own > 0.0 && **other > 0.0);
        let (sum, count) = ratios.fold((0.0, 0.0), |(sum, count), (own, other)| {
            (sum + (other / own).ln(), count + 1.0)
        });
        (sum / count).exp()
    }
}

/// The noise of a picture by this profile and sampler; none of fewer than [`FEWEST_UNITS`] units a pixel.
///
/// `progress` is told of samples done since it was last told.
pub fn noise(
    profile: Arithmetic,
    sampler: Sampler,
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Option<Noise> {
    with_profile!(profile, sampler, P => of::<P>(compiled, plan, progress))
}

/// The same of a picture by `precise` but for one choice, which is the published system's.
pub fn noise_of_choice(choice: Choice, compiled: &CompiledScene, plan: &Plan) -> Option<Noise> {
    with_choice!(choice, P => of::<P>(compiled, plan, |_| ()))
}

fn of<P: Profile>(compiled: &CompiledScene, plan: &Plan, progress: impl Fn(u64) + Sync) -> Option<Noise> {
    if plan.passes() < FEWEST_UNITS {
        return None;
    }
    let (scene, path) = (compiled.view(), Path::<P, All>::new(plan));
    let camera = Camera::new(&compiled.camera);
    let unit = 2f64.powi(-compiled.exponent);
    let spans: Vec<Vec<f64>> = (0..plan.spans())
        .into_par_iter()
        .map(|span| {
            let mut pixels = [Moments::default(); SPAN];
            let mut extent = plan.extent(span);
            for pass in 0..plan.passes() {
                let id = pass * plan.spans() + span;
                extent = plan.extent(id);
                let mut sums = [[U48F16::ZERO; 3]; SPAN];
                render(&path, &scene, &camera, plan, id, &mut sums);
                for (moments, sums) in pixels.iter_mut().zip(sums) {
                    moments.add(sums.map(|sum| sum.to_num::<f64>() * unit / f64::from(extent.samples)));
                }
                progress(u64::from(extent.pixels) * u64::from(extent.samples));
            }
            let samples = f64::from(plan.samples_per_unit);
            pixels[..usize::from(extent.pixels)]
                .iter()
                .map(|pixel| samples * [0, 1, 2].map(|c| pixel.variance(c)).iter().sum::<f64>() / 3.0)
                .collect()
        })
        .collect();
    Some(Noise {
        variance: spans.concat(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::lockstep;
    use crate::scene::{Integrator, Scene, compile};
    use tracer::profile::Precise;
    use tracer::unit::Termination;

    fn plan(spp: u32) -> Plan {
        Plan {
            width: 16,
            height: 12,
            spp,
            samples_per_unit: 64,
            seed: 5,
            termination: Termination::Roulette,
            epsilon: Precise::EPSILON,
        }
    }

    fn cornell() -> CompiledScene {
        let path = crate::platform::workspace::scene(None).expect("tests run in the checkout");
        compile(
            &Scene::load(&path).expect("it is in order"),
            16,
            12,
            Integrator::NextEvent,
        )
    }

    /// Of independent samples, units say what the samples themselves do; those that keep apart have less noise.
    #[test]
    fn units_tell_the_noise_of_samples() {
        let (scene, plan) = (cornell(), plan(2048));
        let found =
            noise(Arithmetic::Precise, Sampler::Independent, &scene, &plan, |_| ()).expect("32 units");
        let samples = lockstep::render::<Precise>(&scene, &plan, |_| ()).picture;
        let samples = samples.variance.expect("it is known").into_iter();
        let known = Noise {
            variance: samples
                .map(|channels| channels.iter().sum::<f64>() / 3.0 * f64::from(plan.spp))
                .collect(),
        };
        // A variance of 32 unit means is known to sqrt(2 / 31) = 25 %, of 192 pixels to 1.8 %, and rare bright paths add to that.
        assert!(
            (found.less_than(&known) - 1.0).abs() < 0.1,
            "{}",
            found.less_than(&known)
        );
        let apart = noise(Arithmetic::Precise, Sampler::Kronecker, &scene, &plan, |_| ()).expect("32 units");
        assert!(apart.less_than(&found) > 1.05, "{}", apart.less_than(&found));
    }

    #[test]
    fn a_few_units_say_nothing() {
        assert_eq!(
            noise(
                Arithmetic::Paper,
                Sampler::Independent,
                &cornell(),
                &plan(192),
                |_| ()
            ),
            None
        );
    }

    #[test]
    fn quantiles_and_means() {
        let noise = Noise {
            variance: vec![4.0, 1.0, 3.0, 2.0, 5.0],
        };
        assert_eq!(
            (noise.mean(), noise.quantile(0.5), noise.quantile(1.0)),
            (3.0, 3.0, 5.0)
        );
        let twice = Noise {
            variance: noise.variance.iter().map(|v| 2.0 * v).collect(),
        };
        assert!((noise.less_than(&twice) - 2.0).abs() < 1e-12);
    }
}
