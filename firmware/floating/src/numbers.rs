//! The tracer's arithmetic in a floating-point format.

use core::f64::consts::TAU;
use core::marker::PhantomData;

use fixedmath::{I2F30, I4F28, I16F16, I32F32, U0F32, U16F16, U19F45, U32F32, warp};
use tracer::aggregate::{RoomNumbers, Wall};
use tracer::arithmetic::{Directions, Formats, Sampling};
use tracer::camera::FilmNumbers;
use tracer::geometry::Grid;
use tracer::geometry::sphere::{Bend, CoarseSphere, Reciprocal, SphereNumbers, VastNumbers};
use tracer::light::{CapLight, LEAST_SHARE, LightNumbers, MOST_DOUBLINGS, Magnitude};
use tracer::material::{DielectricNumbers, RadianceNumbers};

use crate::Float;

/// `F` for every quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floating<F>(PhantomData<F>);

const TWO_TO_32: f64 = (1u64 << 32) as f64;

fn dot<F: Float>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn not_negative<F: Float>(value: F) -> F {
    if value > F::ZERO { value } else { F::ZERO }
}

fn fraction<F: Float>(fraction: U0F32) -> F {
    F::of_u32(fraction.to_bits()).over_power(32)
}

impl<F: Float> Formats for Floating<F> {
    type Length = F;
    type Unit = F;

    const NOTHING: F = F::ZERO;
    const FAR: F = F::FAR;
    const ZERO: F = F::ZERO;
    const ONE: F = F::ONE;

    #[inline]
    fn length(length: I16F16) -> F {
        F::of_i32(length.to_bits()).over_power(16)
    }

    #[inline]
    fn unit(component: I2F30) -> F {
        F::of_i32(component.to_bits()).over_power(30)
    }

    #[inline]
    fn scale(l: F, u: F) -> F {
        l * u
    }
}

impl<F: Float> Directions for Floating<F> {
    #[inline]
    fn cosine(a: [F; 3], b: [F; 3]) -> F {
        dot(a, b)
    }

    #[inline]
    fn times(a: F, b: F) -> F {
        a * b
    }

    #[inline]
    fn normalised(v: [F; 3], otherwise: [F; 3]) -> [F; 3] {
        let square = dot(v, v);
        if square == F::ZERO {
            return otherwise;
        }
        let reciprocal = F::ONE / square.root();
        v.map(|component| component * reciprocal)
    }

    #[inline]
    fn renormalised(v: [F; 3]) -> [F; 3] {
        Self::normalised(v, v)
    }
}

impl<F: Float> Floating<F> {
    /// A point of the unit disc.
    #[inline]
    fn on_disc(value: U0F32) -> Option<[F; 2]> {
        // As fixed point chooses, so that both draw alike.
        warp::checked_hemisphere(value.to_bits())?;
        let coordinate = |bits: u32| F::of_i32((bits as u16 as i16).into()) + F::of(0.5);
        let bits = [value.to_bits() >> 16, value.to_bits()];
        Some(bits.map(|bits| coordinate(bits) * F::of(1.0 / 32768.0)))
    }
}

impl<F: Float> Sampling for Floating<F> {
    #[inline]
    fn cos_sin(turn: U0F32) -> (F, F) {
        let (sine, cosine) = (fraction::<F>(turn) * F::of(TAU)).sine_cosine();
        (cosine, sine)
    }

    #[inline]
    fn root_of(value: U0F32) -> F {
        fraction::<F>(value).root()
    }

    #[inline]
    fn on_hemisphere(value: U0F32) -> Option<[F; 3]> {
        let [u, v] = Self::on_disc(value)?;
        Some([u, v, not_negative(F::ONE - u * u - v * v).root()])
    }

    #[inline]
    fn around(axis: [F; 3], v: [F; 3]) -> [F; 3] {
        let ([x, y, z], [u, v, w]) = (axis, v);
        let across = x * u + y * v;
        let (height, turned) = if z < F::ZERO { (-z, -across) } else { (z, across) };
        let along = w - across / (F::ONE + height);
        [u + x * along, v + y * along, z * w - turned]
    }

    #[inline]
    fn below(value: U0F32, probability: F) -> bool {
        fraction::<F>(value) < probability
    }
}

impl<F: Float> FilmNumbers for Floating<F> {
    #[inline]
    fn across(k: u32, jitter: F, subpixels: u32, _reciprocal: U19F45) -> F {
        (F::of_u32(k) + F::of(0.5) + jitter) / F::of_u32(subpixels) - F::of(0.5)
    }

    #[inline]
    fn combine(forward: [F; 3], a: F, right: [F; 3], b: F, up: [F; 3]) -> [F; 3] {
        [0, 1, 2].map(|i| forward[i] + a * right[i] + b * up[i])
    }
}

impl<F: Float> SphereNumbers for Floating<F> {
    type Square = F;
    type Projection = F;
    /// The oracle looks at every sphere closely.
    type Coarse = ();

    const NO_SQUARE: F = F::ZERO;
    const GRAZING: F = F::ZERO;

    #[inline]
    fn square(square: I32F32) -> F {
        F::of_i64(square.to_bits()).over_power(32)
    }

    #[inline]
    fn dot(a: [F; 3], b: [F; 3]) -> F {
        dot(a, b)
    }

    #[inline]
    fn product(a: F, b: F) -> F {
        a * b
    }

    #[inline]
    fn root(square: F) -> F {
        not_negative(square).root()
    }

    #[inline]
    fn coarse(_grid: Grid, _origin: [F; 3], _direction: [F; 3]) {}

    #[inline]
    fn may_meet(_sphere: &CoarseSphere, _grid: Grid, _ray: &(), _t_max: F) -> bool {
        true
    }

    #[inline]
    fn project(v: [F; 3], d: [F; 3]) -> F {
        dot(v, d)
    }

    /// Directions are of unit length to the last place of the squares, too.
    #[inline]
    fn on_unit(projection: F, _d: [F; 3], _radius: I16F16) -> F {
        projection
    }

    #[inline]
    fn length_of(projection: F) -> F {
        projection
    }

    #[inline]
    fn squared(projection: F) -> F {
        projection * projection
    }

    #[inline]
    fn normal(p: [F; 3], _radius: I16F16, _reciprocal: Reciprocal) -> [F; 3] {
        // Not p / r: a normal that is too long makes a diffuse ray too long, which is off a room's surface by more at the chord's other
        // end. That doubled with each bounce, and from the last place of `f64` led out of the room after some fifty.
        Self::normalised(p, p)
    }
}

fn curvature<F: Float>(bend: Bend) -> F {
    F::of_i32(bend.curvature) * F::of(1.0 / (1u64 << 44) as f64)
}

impl<F: Float> VastNumbers for Floating<F> {
    type Height = F;

    const LEVEL: F = F::ZERO;

    fn height(normal: [I2F30; 3], bend: Bend, above: [F; 3]) -> F {
        dot(normal.map(Self::unit), above) - curvature::<F>(bend) * F::of(0.5) * dot(above, above)
    }

    fn is_below(height: F) -> bool {
        height < F::ZERO
    }

    fn slope(normal: [I2F30; 3], bend: Bend, above: [F; 3], direction: [F; 3]) -> F {
        dot(normal.map(Self::unit), direction) - curvature::<F>(bend) * dot(above, direction)
    }

    fn height_at(bend: Bend, height: F, slope: F, t: F) -> F {
        height + t * slope - curvature::<F>(bend) * F::of(0.5) * t * t
    }

    fn root_of_slope(bend: Bend, height: F, slope: F) -> Option<F> {
        let square = slope * slope + F::of(2.0) * curvature::<F>(bend) * height;
        (square >= F::ZERO).then(|| square.root())
    }

    fn is_level(root: F) -> bool {
        root <= F::ZERO
    }

    fn goes_under(bend: Bend, height: F, slope: F, root: F, _t_max: F) -> Option<F> {
        if slope > F::ZERO {
            let radius = F::of_i32(bend.radius) * F::of_u32(1 << bend.shift) * F::of(1.0 / 65536.0);
            return bend.is_towards().then(|| (root + slope) * radius);
        }
        if height <= F::ZERO {
            return Some(F::ZERO);
        }
        let steepness = root - slope;
        (steepness > F::ZERO).then(|| (height + height) / steepness)
    }

    fn upward(normal: [I2F30; 3], bend: Bend, above: [F; 3]) -> [F; 3] {
        let curvature = curvature::<F>(bend);
        Self::renormalised([0, 1, 2].map(|i| Self::unit(normal[i]) - above[i] * curvature))
    }

    fn lowered(point: [F; 3], height: F, upward: [F; 3]) -> [F; 3] {
        [0, 1, 2].map(|i| point[i] - height * upward[i])
    }
}

/// The oracle asks every wall.
impl<F: Float> RoomNumbers for Floating<F> {
    #[inline]
    fn normal_of_wall(wall: &Wall, point: [F; 3]) -> [F; 3] {
        let reciprocal = F::of_i32(wall.reciprocal) * F::of(1.0 / (1u64 << 44) as f64);
        [0, 1, 2].map(|i| (point[i] - Self::length(wall.centre[i])) * reciprocal)
    }
}

impl<F: Float> DielectricNumbers for Floating<F> {
    type Ratio = F;

    #[inline]
    fn ratio(ratio: I4F28) -> F {
        F::of_i32(ratio.to_bits()).over_power(28)
    }

    #[inline]
    fn ratio_squared(ratio: F) -> F {
        ratio * ratio
    }

    #[inline]
    fn refracted_square(cosine: F, ratio_squared: F) -> F {
        F::ONE - ratio_squared * (F::ONE - cosine * cosine)
    }

    #[inline]
    fn is_refracted(square: F) -> bool {
        square >= F::ZERO
    }

    #[inline]
    fn root_of_ratio(square: F) -> F {
        square.root()
    }

    #[inline]
    fn refract(ratio: F, d: [F; 3], cosine: F, refracted: F, n: [F; 3]) -> [F; 3] {
        let bend = ratio * cosine - refracted;
        [0, 1, 2].map(|i| ratio * d[i] + bend * n[i])
    }
}

impl<F: Float> RadianceNumbers for Floating<F> {
    type Weight = F;
    type Radiance = F;

    const FULL: F = F::ONE;
    const DARK: F = F::ZERO;

    #[inline]
    fn weight(reflectance: U0F32) -> F {
        F::of_u32(reflectance.to_bits()) * F::of(1.0 / (TWO_TO_32 - 1.0))
    }

    #[inline]
    fn attenuate(throughput: F, reflectance: F) -> F {
        throughput * reflectance
    }

    #[inline]
    fn emitted(throughput: F, emission: U16F16) -> F {
        throughput * F::of_u32(emission.to_bits()).over_power(16)
    }

    #[inline]
    fn film_sum(sum: F) -> U32F32 {
        U32F32::from_bits((sum * F::of(TWO_TO_32)).to_u64())
    }
}

impl<F: Float> LightNumbers for Floating<F> {
    /// One minus the cosine of its half angle.
    type Cone = F;
    type Balance = F;

    fn direction(v: [F; 3]) -> Option<[F; 3]> {
        (dot(v, v) > F::ZERO).then(|| Self::normalised(v, v))
    }

    fn on_cap(cap: &CapLight, value: U0F32) -> Option<[F; 3]> {
        let [x, y] = Self::on_disc(value)?;
        let square = x * x + y * y;
        let flatness = (F::ONE - fraction::<F>(cap.height) * square * F::of(0.5)).root();
        Some([0, 1, 2].map(|i| {
            let [across, up] = cap.across.map(|vector| Self::length(vector[i]));
            Self::length(cap.pole[i]) + flatness * (x * across + y * up) - square * Self::length(cap.down[i])
        }))
    }

    fn cone(radius: F, square: F) -> Option<F> {
        let sine_squared = radius * radius / square;
        (sine_squared < F::ONE).then(|| sine_squared / (F::ONE + (F::ONE - sine_squared).root()))
    }

    fn stored_cone(spread: I2F30) -> F {
        let spread = Self::unit(spread);
        spread * spread * F::of(0.5)
    }

    fn in_cone(height: F, value: U0F32) -> Option<[F; 3]> {
        let [x, y] = Self::on_disc(value)?;
        let below = height * (x * x + y * y);
        let spread = (height * (F::of(2.0) - below)).root();
        Some([x * spread, y * spread, F::ONE - below])
    }

    fn balance_of_cap(cosine: F, turned: F, reach: Magnitude, square: F) -> F {
        let own = cosine * turned * of_magnitude(reach);
        own / (own + square)
    }

    fn balance_of_cone(cosine: F, height: F, reach: Magnitude) -> F {
        let own = cosine * height * of_magnitude(reach);
        own / (own + F::ONE)
    }

    fn share(balance: F) -> F {
        balance
    }

    fn thinned(balance: F, fraction: impl FnOnce() -> U0F32) -> Option<F> {
        let least = F::of(libm::ldexp(1.0, LEAST_SHARE));
        if balance >= least {
            return Some(balance);
        }
        let (mut share, mut doublings) = (balance, 0);
        while share < least && doublings < MOST_DOUBLINGS {
            (share, doublings) = (share + share, doublings + 1);
        }
        let chance = ((1u64 << (MOST_DOUBLINGS - doublings)) - 1) as u32;
        (fraction().to_bits() <= chance).then_some(share)
    }
}

fn of_magnitude<F: Float>(magnitude: Magnitude) -> F {
    let (mantissa, exponent) = magnitude.parts();
    F::of(libm::ldexp(mantissa.into(), exponent))
}
