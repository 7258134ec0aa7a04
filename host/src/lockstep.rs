//! The lockstep oracle: the tracer's own source over `f64`, driven by a profile's own random numbers.
//!
//! What differs between its picture and a core's is arithmetic, and nothing else: no Monte Carlo noise stands between
//! the two until rounding sends a path another way. It shares the tracer's formulas, so a wrong formula is not seen
//! here; [`crate::reference`] is there for that.

use std::marker::PhantomData;

use rayon::prelude::*;
use tracer::numbers::Numbers;
use tracer::profile::Profile;
use tracer::scene::{All, BlobError, Scene};
use tracer::unit::{Plan, walk};

use crate::picture::{Estimate, Picture};
use crate::scene::CompiledScene;

/// `f64` for every quantity.
#[derive(Clone, Copy, Debug)]
pub enum Double {}

/// Profile `P` in double precision: its random numbers, its formulas, exact arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Lockstep<P>(PhantomData<P>);

impl<P: Profile> Profile for Lockstep<P> {
    const NAME: &'static str = P::NAME;
    const EPSILON: i32 = P::EPSILON;
    type Numbers = Double;
    type Random = P::Random;
    type Intersection = P::Intersection;
    type Diffuse = P::Diffuse;
}

/// Renders `plan` in lockstep with profile `P`: every pass, on all host cores.
///
/// `progress` is told of samples done since it was last told.
pub fn render<P: Profile>(
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Result<Estimate, BlobError> {
    let scene = Scene::<Double>::decode::<All>(&compiled.blob)?;
    let unit = 2f64.powi(-compiled.exponent);
    let runs: Vec<Vec<Moments>> = (0..plan.runs())
        .into_par_iter()
        .map(|run| {
            let mut moments = vec![Moments::default(); usize::from(plan.extent(run).pixels)];
            for pass in 0..plan.passes() {
                let id = pass * plan.runs() + run;
                walk::<Lockstep<P>, All>(&scene, plan, id, |pixel, sample| {
                    moments[pixel].add(sample.radiance.map(|radiance| radiance * unit))
                });
                let extent = plan.extent(id);
                progress(u64::from(extent.pixels) * u64::from(extent.samples));
            }
            moments
        })
        .collect();
    let moments = runs.concat();
    let pixels = moments.iter().map(|moments| Some(moments.mean())).collect();
    Ok(Estimate {
        picture: Picture::new(plan.width, plan.height, pixels),
        variance: Some(moments.iter().map(Moments::variance_of_mean).collect()),
        spp: Some(plan.spp),
    })
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

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn of_bits(bits: impl Into<f64>, fraction_bits: i32) -> f64 {
    bits.into() * 2f64.powi(-fraction_bits)
}

impl Numbers for Double {
    type Length = f64;
    type Unit = f64;
    type Square = f64;
    type Projection = f64;
    type Ratio = f64;
    type Weight = f64;
    type Radiance = f64;
    type Reciprocal = f64;

    const NOTHING: f64 = 0.0;
    const GRAZING: f64 = 0.0;
    const FAR: f64 = 1e9;
    const ONE: f64 = 1.0;
    const ZERO: f64 = 0.0;
    const NO_SQUARE: f64 = 0.0;
    const FULL: f64 = 1.0;
    const DARK: f64 = 0.0;

    fn length(bits: i32) -> f64 {
        of_bits(bits, 16)
    }

    fn unit(bits: i32) -> f64 {
        of_bits(bits, 30)
    }

    fn square(bits: i64) -> f64 {
        bits as f64 * 2f64.powi(-32)
    }

    fn ratio(bits: i32) -> f64 {
        of_bits(bits, 28)
    }

    fn ratio_squared(ratio: f64) -> f64 {
        ratio * ratio
    }

    fn weight(bits: u32) -> f64 {
        f64::from(bits) / f64::from(u32::MAX)
    }

    fn reciprocal(radius: i32, _reciprocal: i32, _shift: u8) -> f64 {
        of_bits(radius, 16)
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        dot(a, b)
    }

    fn product(a: f64, b: f64) -> f64 {
        a * b
    }

    fn root(square: f64) -> f64 {
        square.max(0.0).sqrt()
    }

    fn project(v: [f64; 3], d: [f64; 3]) -> f64 {
        dot(v, d)
    }

    fn length_of(projection: f64) -> f64 {
        projection
    }

    fn squared(projection: f64) -> f64 {
        projection * projection
    }

    fn scale(l: f64, u: f64) -> f64 {
        l * u
    }

    fn normal(p: [f64; 3], r: f64) -> [f64; 3] {
        p.map(|component| component / r)
    }

    fn cosine(a: [f64; 3], b: [f64; 3]) -> f64 {
        dot(a, b)
    }

    fn times(a: f64, b: f64) -> f64 {
        a * b
    }

    fn normalised(v: [f64; 3], otherwise: [f64; 3]) -> [f64; 3] {
        let length = dot(v, v).sqrt();
        if length == 0.0 {
            otherwise
        } else {
            v.map(|component| component / length)
        }
    }

    fn bisector(a: [f64; 3], b: [f64; 3], otherwise: [f64; 3]) -> [f64; 3] {
        Self::normalised([0, 1, 2].map(|i| a[i] + b[i]), otherwise)
    }

    fn renormalised(v: [f64; 3]) -> [f64; 3] {
        Self::normalised(v, v)
    }

    fn cos_sin(turn: u32) -> (f64, f64) {
        let (sine, cosine) = (of_bits(turn, 32) * std::f64::consts::TAU).sin_cos();
        (cosine, sine)
    }

    fn signed(fraction: u32) -> f64 {
        of_bits(fraction, 31) - 1.0
    }

    fn root_of(fraction: u32) -> f64 {
        of_bits(fraction, 32).sqrt()
    }

    fn complement(z: f64) -> f64 {
        (1.0 - z * z).sqrt()
    }

    fn below(fraction: u32, probability: f64) -> bool {
        of_bits(fraction, 32) < probability
    }

    fn refracted_square(cosine: f64, ratio_squared: f64) -> f64 {
        1.0 - ratio_squared * (1.0 - cosine * cosine)
    }

    fn is_refracted(square: f64) -> bool {
        square >= 0.0
    }

    fn root_of_ratio(square: f64) -> f64 {
        square.sqrt()
    }

    fn refract(ratio: f64, d: [f64; 3], cosine: f64, refracted: f64, n: [f64; 3]) -> [f64; 3] {
        let bend = ratio * cosine - refracted;
        [0, 1, 2].map(|i| ratio * d[i] + bend * n[i])
    }

    fn across(k: u32, jitter: f64, subpixels: u32, _reciprocal: u64) -> f64 {
        (f64::from(k) + 0.5 + jitter) / f64::from(subpixels) - 0.5
    }

    fn combine(forward: [f64; 3], a: f64, right: [f64; 3], b: f64, up: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| forward[i] + a * right[i] + b * up[i])
    }

    fn attenuate(throughput: f64, reflectance: f64) -> f64 {
        throughput * reflectance
    }

    fn emitted(throughput: f64, emission: u32) -> f64 {
        throughput * of_bits(emission, 16)
    }

    fn radiance_bits(sum: f64) -> u64 {
        (sum * 4_294_967_296.0) as u64
    }
}
