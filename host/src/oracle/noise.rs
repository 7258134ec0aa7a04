//! The noise of a picture whose cores sent sums and no squares.
//!
//! The lockstep oracle walks a picture's paths in double precision, and its samples' variance is the picture's: but for paths
//! that rounding has parted, which may have met with something rare on one side only. One path in a million that ends early in a
//! glass ball is a large part of a pixel's variance there, and a picture that has it must not be judged by an oracle that has
//! not. So where the two pixels differ by something that noise would feel, the picture's own samples are taken again.

use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::integrator::{Integrator, Path};
use tracer::material::RadianceNumbers;
use tracer::profile::Profile;
use tracer::scene::{All, Scene};
use tracer::unit::{Plan, walk};

use crate::image::picture::{Estimate, Picture};
use crate::oracle::lockstep::Moments;
use crate::scene::CompiledScene;

/// A squared difference of this share of the variance, or less, is none that the variance would be much larger by: one parted
/// sample adds just the square of the difference to the variance of the mean.
const FELT: f64 = 0.01;

/// The variance of every pixel of `picture`, which profile `P` rendered by `plan`, and `oracle` in lockstep with it.
///
/// Free-running orders take the same units; a stochastic one does not, and has no oracle. `progress` is told of samples looked
/// after since it was last told.
pub fn variance<P: Profile>(
    compiled: &CompiledScene,
    plan: &Plan,
    picture: &Picture,
    oracle: &Estimate,
    progress: impl Fn(u64) + Sync,
) -> Option<Vec<[f64; 3]>> {
    let variance = oracle.variance.as_ref()?;
    let pixels = picture.pixels().iter().zip(oracle.picture.pixels()).zip(variance);
    let parted: Vec<bool> = pixels
        .map(|((picture, oracle), variance)| match (picture, oracle) {
            (Some(picture), Some(oracle)) => {
                (0..3).any(|i| (picture[i] - oracle[i]).powi(2) > FELT * variance[i])
            }
            _ => false,
        })
        .collect();
    let (scene, path) = (compiled.view(), Path::<P, All>::new(plan));
    let camera = Camera::new(&compiled.camera);
    let spans = (0..plan.spans()).into_par_iter().map(|span| {
        let extent = plan.extent(span);
        let first = extent.first_pixel as usize;
        let range = first..first + usize::from(extent.pixels);
        progress(u64::from(extent.pixels) * u64::from(plan.spp));
        if parted[range.clone()].contains(&true) {
            own_variance(&path, &scene, &camera, compiled.exponent, plan, span)
        } else {
            variance[range].to_vec()
        }
    });
    Some(spans.collect::<Vec<_>>().concat())
}

/// The variance of a span's pixels by their own samples.
fn own_variance<P: Profile>(
    integrator: &impl Integrator<P>,
    scene: &Scene<'_>,
    camera: &Camera<P::Numbers>,
    exponent: i32,
    plan: &Plan,
    span: u32,
) -> Vec<[f64; 3]> {
    let unit = 2f64.powi(-exponent);
    let mut moments = vec![Moments::default(); usize::from(plan.extent(span).pixels)];
    for pass in 0..plan.passes() {
        walk(
            integrator,
            scene,
            camera,
            plan,
            pass * plan.spans() + span,
            |pixel, sample| {
                let radiance = sample.radiance.map(P::Numbers::film_sum);
                moments[pixel].add(radiance.map(|sum| sum.to_num::<f64>() * unit));
            },
        );
    }
    moments.iter().map(Moments::variance_of_mean).collect()
}

#[cfg(test)]
mod tests {
    use tracer::profile::Precise;
    use tracer::unit::Termination;

    use super::*;
    use crate::oracle::direct;
    use crate::scene::{self, compile};

    const PLAN: Plan = Plan {
        width: 16,
        height: 12,
        spp: 64,
        samples_per_unit: 64,
        seed: 3,
        termination: Termination::Roulette,
        epsilon: Precise::EPSILON,
    };

    fn cornell() -> CompiledScene {
        let text = include_str!("../../../scenes/cornell.toml");
        let scene = scene::Scene::parse("cornell.toml", text).expect("the standard scene");
        compile(&scene, PLAN.width, PLAN.height)
    }

    /// What the picture and its oracle have in common is the oracle's; a pixel with a difference gets its own.
    #[test]
    fn only_parted_pixels_have_a_variance_of_their_own() {
        let compiled = cornell();
        let (fixed, mut oracle) = direct::estimate::<Precise>(&compiled, &PLAN);
        let first = variance::<Precise>(&compiled, &PLAN, &fixed.picture, &oracle, |_| ())
            .expect("the oracle has one");
        // An oracle that has missed a rare bright path, and whose variance so misses it too.
        let mut pixels = oracle.picture.pixels().to_vec();
        pixels[40] = Some([0.0; 3]);
        oracle.picture = Picture::new(PLAN.width, PLAN.height, pixels);
        let all = oracle.variance.as_mut().expect("it has one");
        all[40] = [1e-12; 3];
        let second = variance::<Precise>(&compiled, &PLAN, &fixed.picture, &oracle, |_| ())
            .expect("the oracle has one");
        for channel in 0..3 {
            assert!(
                (second[40][channel] / first[40][channel] - 1.0).abs() < 0.01,
                "its own samples'"
            );
        }
        assert_eq!(first[100..], second[100..], "other spans are as they were");
    }
}
