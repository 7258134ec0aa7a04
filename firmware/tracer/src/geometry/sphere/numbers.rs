//! What spheres need of the number formats.

use core::fmt::Debug;
use core::ops::{Add, Sub};

use fixedmath::{I2F30, I16F16, I18F46, I32F32, I48F16, division, product, root, unit};

use super::{CoarseRay, CoarseSphere, Reciprocal};
use crate::arithmetic::{Directions, Mixed, Published};
use crate::geometry::Grid;

/// Squares of lengths, and lengths along a direction.
///
/// Ranges are the scene compiler's to guarantee: no ray starts 2^15 / 3 or more from the centre of a hollow sphere, or twice that
/// from any other, and no hollow or glass sphere's radius reaches 2^15 / 3. Then no square leaves 32:32.
pub trait SphereNumbers: Directions {
    /// Squares of lengths.
    type Square: Copy + Debug + PartialOrd + Add<Output = Self::Square> + Sub<Output = Self::Square>;
    /// What is enough of a ray to know most spheres that it misses.
    type Coarse: Copy + Debug;
    /// A length along a direction before it is rounded.
    type Projection: Copy + Debug;

    /// No square.
    const NO_SQUARE: Self::Square;
    /// How far rounding can move a hit along the ray.
    const GRAZING: Self::Length;

    /// A square of the scene.
    fn square(square: I32F32) -> Self::Square;
    /// `a . b`, rounded once where it is rounded at all.
    fn dot(a: [Self::Length; 3], b: [Self::Length; 3]) -> Self::Square;
    /// `a b`.
    fn product(a: Self::Length, b: Self::Length) -> Self::Square;
    /// The root of a square; 0 for a negative one.
    fn root(square: Self::Square) -> Self::Length;
    /// The root of a square, quickly: within 1.2 ulp.
    fn near_root(square: Self::Square) -> Self::Length {
        Self::root(square)
    }
    /// `v . d`.
    fn project(v: [Self::Length; 3], d: [Self::Unit; 3]) -> Self::Projection;
    /// `v . d / |d|`, of the projection `v . d` on the way to a sphere of this radius. Directions are of unit length to 2^-29 only; what
    /// that makes of the projection's square is seen where a ball is small beside its distance, and is left elsewhere.
    fn on_unit(projection: Self::Projection, d: [Self::Unit; 3], radius: I16F16) -> Self::Projection;
    /// A projection as a length, cut to its format.
    fn length_of(projection: Self::Projection) -> Self::Length;
    /// A projection's square.
    fn squared(projection: Self::Projection) -> Self::Square;
    /// A ray on the scene's grid.
    fn coarse(grid: Grid, origin: [Self::Length; 3], direction: [Self::Unit; 3]) -> Self::Coarse;
    /// Whether a ray may meet a sphere nearer than `t_max`: `false` only where it surely does not.
    fn may_meet(sphere: &CoarseSphere, grid: Grid, ray: &Self::Coarse, t_max: Self::Length) -> bool;
    /// `p / r` for a point `p` relative to the centre of the sphere it lies on: a unit vector.
    fn normal(p: [Self::Length; 3], radius: I16F16, reciprocal: Reciprocal) -> [Self::Unit; 3];
}

fn bits(v: [I2F30; 3]) -> [i64; 3] {
    v.map(|component| component.to_bits().into())
}

impl SphereNumbers for Mixed {
    type Square = I32F32;
    type Coarse = CoarseRay;
    /// Exact.
    type Projection = I18F46;

    const NO_SQUARE: I32F32 = I32F32::ZERO;
    /// 3 ulp: 1 of the projection's cut, 1/2 of the root, and 0.87 where the three components are rounded.
    const GRAZING: I16F16 = I16F16::from_bits(3);

    #[inline]
    fn square(square: I32F32) -> I32F32 {
        square
    }

    #[inline]
    fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
        product::wrapping_dot(a, b)
    }

    #[inline]
    fn product(a: I16F16, b: I16F16) -> I32F32 {
        I32F32::from_bits(i64::from(a.to_bits()) * i64::from(b.to_bits()))
    }

    #[inline]
    fn root(square: I32F32) -> I16F16 {
        root::of_square(square)
    }

    #[inline]
    fn near_root(square: I32F32) -> I16F16 {
        root::near_square(square)
    }

    #[inline]
    fn project(v: [I16F16; 3], d: [I2F30; 3]) -> I18F46 {
        let [x, y, z] = bits(d);
        let sum =
            i64::from(v[0].to_bits()) * x + i64::from(v[1].to_bits()) * y + i64::from(v[2].to_bits()) * z;
        I18F46::from_bits(sum)
    }

    #[inline]
    fn on_unit(projection: I18F46, d: [I2F30; 3], radius: I16F16) -> I18F46 {
        // Up to 64 roots of the radius away, how far a ray passes the centre is known within half an ulp without.
        let distance = (projection.to_bits() >> 46) as i32;
        if distance * distance <= radius.to_bits() >> 4 {
            return projection;
        }
        // 1 / |d| is 1 - (|d|^2 - 1) / 2 to 2^-56.
        let [x, y, z] = bits(d);
        let excess = ((x * x + y * y + z * z - (1 << 60)) >> 2) as i32;
        let part = (projection.to_bits() >> 32) as i32;
        I18F46::from_bits(projection.to_bits() - ((i64::from(part) * i64::from(excess)) >> 27))
    }

    #[inline]
    fn length_of(projection: I18F46) -> I16F16 {
        I16F16::from_bits((projection.to_bits() >> 30) as i32)
    }

    #[inline]
    fn squared(projection: I18F46) -> I32F32 {
        // Of a length and what is less than an ulp of it; the last one's square is less than 2^-32.
        let length = Self::length_of(projection);
        let rest = projection.to_bits() as i32 & ((1 << 30) - 1);
        let twice = (i64::from(length.to_bits()) * i64::from(rest)) >> 29;
        Self::product(length, length) + I32F32::from_bits(twice)
    }

    #[inline]
    fn coarse(grid: Grid, origin: [I16F16; 3], direction: [I2F30; 3]) -> CoarseRay {
        CoarseRay::new(grid, origin, direction)
    }

    #[inline]
    fn may_meet(sphere: &CoarseSphere, grid: Grid, ray: &CoarseRay, t_max: I16F16) -> bool {
        sphere.may_be_met(grid, ray, t_max)
    }

    #[inline]
    fn normal(p: [I16F16; 3], _radius: I16F16, reciprocal: Reciprocal) -> [I2F30; 3] {
        let component = |p: I16F16| {
            let shifted = p.to_bits() << reciprocal.shift;
            let mantissa = i64::from(reciprocal.mantissa.to_bits());
            I2F30::from_bits(((i64::from(shifted) * mantissa) >> 30) as i32)
        };
        unit::renormalised([component(p[0]), component(p[1]), component(p[2])])
    }
}

impl SphereNumbers for Published {
    type Square = I48F16;
    type Coarse = ();
    type Projection = I16F16;

    const NO_SQUARE: I48F16 = I48F16::ZERO;
    const GRAZING: I16F16 = I16F16::ZERO;

    fn square(square: I32F32) -> I48F16 {
        I48F16::from_bits(square.to_bits() >> 16)
    }

    fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I48F16 {
        Self::sum_of_products(a, b)
    }

    fn product(a: I16F16, b: I16F16) -> I48F16 {
        I48F16::from_bits((i64::from(a.to_bits()) * i64::from(b.to_bits())) >> 16)
    }

    fn root(square: I48F16) -> I16F16 {
        root::split(square)
    }

    fn project(v: [I16F16; 3], d: [I16F16; 3]) -> I16F16 {
        I16F16::from_bits(Self::sum_of_products(v, d).to_bits() as i32)
    }

    /// Its directions are as published.
    fn on_unit(projection: I16F16, _d: [I16F16; 3], _radius: I16F16) -> I16F16 {
        projection
    }

    fn length_of(projection: I16F16) -> I16F16 {
        projection
    }

    fn squared(projection: I16F16) -> I48F16 {
        Self::product(projection, projection)
    }

    fn coarse(_grid: Grid, _origin: [I16F16; 3], _direction: [I16F16; 3]) {}

    fn may_meet(_sphere: &CoarseSphere, _grid: Grid, _ray: &(), _t_max: I16F16) -> bool {
        true
    }

    fn normal(p: [I16F16; 3], radius: I16F16, _reciprocal: Reciprocal) -> [I16F16; 3] {
        p.map(|component| division::restoring(component, radius))
    }
}
