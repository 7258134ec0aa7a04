//! The tracer's arithmetic in double precision.

use fixedmath::{I2F30, I4F28, I16F16, I32F32, U0F32, U16F16, U19F45, U32F32};
use tracer::arithmetic::{Directions, Formats, Sampling};
use tracer::camera::FilmNumbers;
use tracer::geometry::sphere::{Reciprocal, SphereNumbers};
use tracer::material::{DielectricNumbers, RadianceNumbers};

/// `f64` for every quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Double {}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Formats for Double {
    type Length = f64;
    type Unit = f64;

    const NOTHING: f64 = 0.0;
    const FAR: f64 = 1e9;
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;

    fn length(length: I16F16) -> f64 {
        length.into()
    }

    fn unit(component: I2F30) -> f64 {
        component.into()
    }

    fn scale(l: f64, u: f64) -> f64 {
        l * u
    }
}

impl Directions for Double {
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
}

impl Sampling for Double {
    fn cos_sin(turn: U0F32) -> (f64, f64) {
        let (sine, cosine) = (f64::from(turn) * std::f64::consts::TAU).sin_cos();
        (cosine, sine)
    }

    fn signed(fraction: U0F32) -> f64 {
        2.0 * f64::from(fraction) - 1.0
    }

    fn root_of(fraction: U0F32) -> f64 {
        f64::from(fraction).sqrt()
    }

    fn complement(z: f64) -> f64 {
        (1.0 - z * z).sqrt()
    }

    fn below(fraction: U0F32, probability: f64) -> bool {
        f64::from(fraction) < probability
    }
}

impl FilmNumbers for Double {
    fn across(k: u32, jitter: f64, subpixels: u32, _reciprocal: U19F45) -> f64 {
        (f64::from(k) + 0.5 + jitter) / f64::from(subpixels) - 0.5
    }

    fn combine(forward: [f64; 3], a: f64, right: [f64; 3], b: f64, up: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| forward[i] + a * right[i] + b * up[i])
    }
}

impl SphereNumbers for Double {
    type Square = f64;
    type Projection = f64;

    const NO_SQUARE: f64 = 0.0;
    const GRAZING: f64 = 0.0;

    fn square(square: I32F32) -> f64 {
        square.to_bits() as f64 / 4_294_967_296.0
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

    fn normal(p: [f64; 3], radius: I16F16, _reciprocal: Reciprocal) -> [f64; 3] {
        let radius = f64::from(radius);
        p.map(|component| component / radius)
    }
}

impl DielectricNumbers for Double {
    type Ratio = f64;

    fn ratio(ratio: I4F28) -> f64 {
        ratio.into()
    }

    fn ratio_squared(ratio: f64) -> f64 {
        ratio * ratio
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
}

impl RadianceNumbers for Double {
    type Weight = f64;
    type Radiance = f64;

    const FULL: f64 = 1.0;
    const DARK: f64 = 0.0;

    fn weight(reflectance: U0F32) -> f64 {
        f64::from(reflectance.to_bits()) / f64::from(u32::MAX)
    }

    fn attenuate(throughput: f64, reflectance: f64) -> f64 {
        throughput * reflectance
    }

    fn emitted(throughput: f64, emission: U16F16) -> f64 {
        throughput * f64::from(emission)
    }

    fn film_sum(sum: f64) -> U32F32 {
        U32F32::from_bits((sum * 4_294_967_296.0) as u64)
    }
}
