//! The number formats of `precise`, and the published arithmetic where a choice says so.
//!
//! What is published is computed in 16:16 and widened, so that formats stay as they are and the operation alone is another.

use core::marker::PhantomData;

use fixedmath::{I2F30, I4F28, I16F16, I18F46, I32F32, I36F28, I48F16, U0F32, U16F16, U19F45, U32F32};
use fixedmath::{angle, division, root, unit, warp};
use tracer::aggregate::{Exit, Room, RoomNumbers, Wall, exit_by};
use tracer::arithmetic::{Directions, Formats, Mixed, Sampling};
use tracer::camera::FilmNumbers;
use tracer::geometry::Grid;
use tracer::geometry::sphere::{Bend, CoarseRay, CoarseSphere, Reciprocal, SphereNumbers, VastNumbers};
use tracer::light::{CapLight, LightNumbers, Magnitude};
use tracer::material::{DielectricNumbers, RadianceNumbers};
use tracer::profile::Quadratic;

use crate::Switch;

/// [`Mixed`] with a choice of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Varied<S>(PhantomData<S>);

/// 1 in 16:16.
const ONE: I16F16 = I16F16::ONE;

fn narrowed(component: I2F30) -> I16F16 {
    I16F16::from_bits(component.to_bits() >> 14)
}

fn widened(component: I16F16) -> I2F30 {
    I2F30::from_bits(component.to_bits() << 14)
}

/// The published root of a fraction.
fn restored_root(fraction: U0F32) -> I2F30 {
    widened(root::restoring(I16F16::from_bits(
        (fraction.to_bits() >> 16) as i32,
    )))
}

/// The published root of a square.
fn split_root(square: I32F32) -> I16F16 {
    root::split(I48F16::from_bits(square.to_bits() >> 16))
}

impl<S: Switch> Varied<S> {
    /// A direction's component as the choice keeps it.
    #[inline]
    fn kept(component: I2F30) -> I2F30 {
        if S::COARSE {
            widened(narrowed(component))
        } else {
            component
        }
    }

    #[inline]
    fn all_kept(v: [I2F30; 3]) -> [I2F30; 3] {
        v.map(Self::kept)
    }

    /// `v` over its length, one of the two by the published way.
    fn normalised_otherwise(v: [I2F30; 3], otherwise: [I2F30; 3]) -> [I2F30; 3] {
        let squares = v.map(|c| i64::from(c.to_bits()) * i64::from(c.to_bits()));
        let square = squares[0] as u64 + squares[1] as u64 + squares[2] as u64;
        if square < 1 << 30 {
            return otherwise;
        }
        if S::ROOTS {
            let length = root::split(I48F16::from_bits((square >> 44) as i64)).to_bits();
            if length == 0 {
                return otherwise;
            }
            return v.map(|c| {
                let quotient =
                    division::long(u64::from(c.to_bits().unsigned_abs()) << 16, length as u32) as i32;
                I2F30::from_bits(if c < I2F30::ZERO { -quotient } else { quotient })
            });
        }
        let length = I16F16::from_bits((root::nearest(square) >> 14) as i32);
        v.map(|c| widened(division::restoring(narrowed(c), length)))
    }
}

impl<S: Switch> Formats for Varied<S> {
    type Length = I16F16;
    type Unit = I2F30;

    const NOTHING: I16F16 = Mixed::NOTHING;
    const FAR: I16F16 = Mixed::FAR;
    const ZERO: I2F30 = Mixed::ZERO;
    const ONE: I2F30 = Mixed::ONE;

    #[inline]
    fn length(length: I16F16) -> I16F16 {
        length
    }

    #[inline]
    fn unit(component: I2F30) -> I2F30 {
        Self::kept(component)
    }

    #[inline]
    fn scale(l: I16F16, u: I2F30) -> I16F16 {
        Mixed::scale(l, u)
    }
}

impl<S: Switch> Directions for Varied<S> {
    #[inline]
    fn cosine(a: [I2F30; 3], b: [I2F30; 3]) -> I2F30 {
        Self::kept(Mixed::cosine(a, b))
    }

    #[inline]
    fn times(a: I2F30, b: I2F30) -> I2F30 {
        Self::kept(Mixed::times(a, b))
    }

    #[inline]
    fn normalised(v: [I2F30; 3], otherwise: [I2F30; 3]) -> [I2F30; 3] {
        if S::ROOTS || S::QUOTIENTS {
            return Self::normalised_otherwise(v, otherwise);
        }
        Self::all_kept(Mixed::normalised(v, otherwise))
    }

    #[inline]
    fn renormalised(v: [I2F30; 3]) -> [I2F30; 3] {
        Self::all_kept(Mixed::renormalised(v))
    }
}

impl<S: Switch> Sampling for Varied<S> {
    #[inline]
    fn cos_sin(turn: U0F32) -> (I2F30, I2F30) {
        if S::PARABOLAS {
            let sine = |turn| widened(angle::parabolic_sine(turn));
            return (sine(turn.to_bits().wrapping_add(1 << 30)), sine(turn.to_bits()));
        }
        let (cosine, sine) = Mixed::cos_sin(turn);
        (Self::kept(cosine), Self::kept(sine))
    }

    #[inline]
    fn root_of(fraction: U0F32) -> I2F30 {
        if S::ROOTS {
            restored_root(fraction)
        } else {
            Self::kept(Mixed::root_of(fraction))
        }
    }

    #[inline]
    fn below(fraction: U0F32, probability: I2F30) -> bool {
        Mixed::below(fraction, probability)
    }

    #[inline]
    fn tent(fraction: U0F32) -> I2F30 {
        if S::ROOTS {
            let offset = Self::ONE - restored_root(fraction << 1 | U0F32::DELTA);
            return if fraction.to_bits() >> 31 == 0 {
                -offset
            } else {
                offset
            };
        }
        Self::kept(Mixed::tent(fraction))
    }

    #[inline]
    fn on_hemisphere(fraction: U0F32) -> Option<[I2F30; 3]> {
        let [u, v, height] = warp::checked_hemisphere(fraction.to_bits())?;
        if S::ROOTS {
            let square = Mixed::times(u, u) + Mixed::times(v, v);
            return Some([u, v, widened(root::restoring(narrowed(Self::ONE - square)))]);
        }
        Some(Self::all_kept([u, v, height]))
    }

    #[inline]
    fn around(axis: [I2F30; 3], v: [I2F30; 3]) -> [I2F30; 3] {
        if S::QUOTIENTS {
            let ([x, y, z], [u, v, w]) = (axis, v);
            let across = Mixed::times(x, u) + Mixed::times(y, v);
            let along = w - widened(division::restoring(narrowed(across), ONE + narrowed(z).abs()));
            let turned = if z < I2F30::ZERO { -across } else { across };
            return [
                u + Mixed::times(x, along),
                v + Mixed::times(y, along),
                Mixed::times(z, w) - turned,
            ];
        }
        Self::all_kept(unit::around(axis, v))
    }
}

impl<S: Switch> FilmNumbers for Varied<S> {
    #[inline]
    fn across(k: u32, jitter: I2F30, subpixels: u32, reciprocal: U19F45) -> I2F30 {
        if S::QUOTIENTS {
            let half = I16F16::from_bits(1 << 15);
            let place = I16F16::from_bits((k as i32) << 16) + half + narrowed(jitter);
            return widened(division::restoring(place, I16F16::from_bits((subpixels as i32) << 16)) - half);
        }
        Self::kept(Mixed::across(k, jitter, subpixels, reciprocal))
    }

    #[inline]
    fn combine(forward: [I2F30; 3], a: I2F30, right: [I2F30; 3], b: I2F30, up: [I2F30; 3]) -> [I2F30; 3] {
        Self::all_kept(Mixed::combine(forward, a, right, b, up))
    }
}

impl<S: Switch> RadianceNumbers for Varied<S> {
    type Weight = U0F32;
    type Radiance = U32F32;

    const FULL: U0F32 = Mixed::FULL;
    const DARK: U32F32 = Mixed::DARK;

    #[inline]
    fn weight(reflectance: U0F32) -> U0F32 {
        Mixed::weight(reflectance)
    }

    #[inline]
    fn attenuate(throughput: U0F32, reflectance: U0F32) -> U0F32 {
        Mixed::attenuate(throughput, reflectance)
    }

    #[inline]
    fn emitted(throughput: U0F32, emission: U16F16) -> U32F32 {
        Mixed::emitted(throughput, emission)
    }

    #[inline]
    fn film_sum(sum: U32F32) -> U32F32 {
        Mixed::film_sum(sum)
    }
}

impl<S: Switch> SphereNumbers for Varied<S> {
    type Square = I32F32;
    type Coarse = CoarseRay;
    type Projection = I18F46;

    const NO_SQUARE: I32F32 = Mixed::NO_SQUARE;
    const GRAZING: I16F16 = Mixed::GRAZING;

    #[inline]
    fn square(square: I32F32) -> I32F32 {
        square
    }

    #[inline]
    fn dot(a: [I16F16; 3], b: [I16F16; 3]) -> I32F32 {
        Mixed::dot(a, b)
    }

    #[inline]
    fn product(a: I16F16, b: I16F16) -> I32F32 {
        Mixed::product(a, b)
    }

    #[inline]
    fn root(square: I32F32) -> I16F16 {
        if S::ROOTS {
            split_root(square)
        } else {
            Mixed::root(square)
        }
    }

    #[inline]
    fn near_root(square: I32F32) -> I16F16 {
        if S::ROOTS {
            split_root(square)
        } else {
            Mixed::near_root(square)
        }
    }

    #[inline]
    fn project(v: [I16F16; 3], d: [I2F30; 3]) -> I18F46 {
        Mixed::project(v, d)
    }

    #[inline]
    fn on_unit(projection: I18F46, d: [I2F30; 3], radius: I16F16) -> I18F46 {
        // Directions of 16 fraction bits are so far from unit length that ours would overflow.
        if S::COARSE {
            projection
        } else {
            Mixed::on_unit(projection, d, radius)
        }
    }

    #[inline]
    fn length_of(projection: I18F46) -> I16F16 {
        Mixed::length_of(projection)
    }

    #[inline]
    fn squared(projection: I18F46) -> I32F32 {
        Mixed::squared(projection)
    }

    #[inline]
    fn coarse(grid: Grid, origin: [I16F16; 3], direction: [I2F30; 3]) -> CoarseRay {
        Mixed::coarse(grid, origin, direction)
    }

    #[inline]
    fn may_meet(sphere: &CoarseSphere, grid: Grid, ray: &CoarseRay, t_max: I16F16) -> bool {
        Mixed::may_meet(sphere, grid, ray, t_max)
    }

    #[inline]
    fn normal(p: [I16F16; 3], radius: I16F16, reciprocal: Reciprocal) -> [I2F30; 3] {
        if S::QUOTIENTS {
            return unit::renormalised(p.map(|c| widened(division::restoring(c, radius))));
        }
        Self::all_kept(Mixed::normal(p, radius, reciprocal))
    }
}

impl<S: Switch> RoomNumbers for Varied<S> {
    #[inline]
    fn exit<'r>(room: &'r Room, origin: [I16F16; 3], direction: [I2F30; 3]) -> Option<Exit<'r, Self>> {
        match S::QUADRATIC {
            // What is proved of a room is proved of our formula.
            Quadratic::Textbook => None,
            Quadratic::Power => exit_by(room, origin, direction, Self::near_root),
        }
    }

    #[inline]
    fn normal_of_wall(wall: &Wall, point: [I16F16; 3]) -> [I2F30; 3] {
        if S::QUOTIENTS {
            // The record has 1 / r and no r: to find that costs a tenth of one of the three quotients.
            let radius = I16F16::from_bits(division::long(1 << 60, wall.reciprocal as u32) as i32);
            return [0, 1, 2].map(|i| widened(division::restoring(point[i] - wall.centre[i], radius)));
        }
        Self::all_kept(Mixed::normal_of_wall(wall, point))
    }
}

impl<S: Switch> DielectricNumbers for Varied<S> {
    type Ratio = I36F28;

    #[inline]
    fn ratio(ratio: I4F28) -> I36F28 {
        Mixed::ratio(ratio)
    }

    #[inline]
    fn ratio_squared(ratio: I36F28) -> I36F28 {
        Mixed::ratio_squared(ratio)
    }

    #[inline]
    fn refracted_square(cosine: I2F30, ratio_squared: I36F28) -> I36F28 {
        Mixed::refracted_square(cosine, ratio_squared)
    }

    #[inline]
    fn is_refracted(square: I36F28) -> bool {
        Mixed::is_refracted(square)
    }

    #[inline]
    fn root_of_ratio(square: I36F28) -> I2F30 {
        if S::ROOTS {
            return widened(root::restoring(I16F16::from_bits(
                (square.to_bits() >> 12) as i32,
            )));
        }
        Self::kept(Mixed::root_of_ratio(square))
    }

    #[inline]
    fn refract(ratio: I36F28, d: [I2F30; 3], cosine: I2F30, refracted: I2F30, n: [I2F30; 3]) -> [I2F30; 3] {
        Self::all_kept(Mixed::refract(ratio, d, cosine, refracted, n))
    }
}

/// Scenes of the report have no such spheres: ours in all but the directions.
impl<S: Switch> VastNumbers for Varied<S> {
    type Height = I18F46;

    const LEVEL: I18F46 = Mixed::LEVEL;

    fn height(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> I18F46 {
        Mixed::height(normal, bend, above)
    }

    fn is_below(height: I18F46) -> bool {
        Mixed::is_below(height)
    }

    fn slope(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3], direction: [I2F30; 3]) -> I2F30 {
        Self::kept(Mixed::slope(normal, bend, above, direction))
    }

    fn height_at(bend: Bend, height: I18F46, slope: I2F30, t: I16F16) -> I18F46 {
        Mixed::height_at(bend, height, slope, t)
    }

    fn root_of_slope(bend: Bend, height: I18F46, slope: I2F30) -> Option<I2F30> {
        Mixed::root_of_slope(bend, height, slope)
    }

    fn is_level(root: I2F30) -> bool {
        Mixed::is_level(root)
    }

    fn goes_under(bend: Bend, height: I18F46, slope: I2F30, root: I2F30, t_max: I16F16) -> Option<I16F16> {
        Mixed::goes_under(bend, height, slope, root, t_max)
    }

    fn upward(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> [I2F30; 3] {
        Self::all_kept(Mixed::upward(normal, bend, above))
    }

    fn lowered(point: [I16F16; 3], height: I18F46, upward: [I2F30; 3]) -> [I16F16; 3] {
        Mixed::lowered(point, height, upward)
    }
}

/// Choices are switched for paths that do not look for light: ours in all but the directions.
impl<S: Switch> LightNumbers for Varied<S> {
    type Cone = I2F30;
    type Balance = Magnitude;

    fn direction(v: [I16F16; 3]) -> Option<[I2F30; 3]> {
        Mixed::direction(v).map(Self::all_kept)
    }

    fn on_cap(cap: &CapLight, fraction: U0F32) -> Option<[I16F16; 3]> {
        Mixed::on_cap(cap, fraction)
    }

    fn cone(radius: I16F16, square: I32F32) -> Option<I2F30> {
        Mixed::cone(radius, square)
    }

    fn stored_cone(spread: I2F30) -> I2F30 {
        Mixed::stored_cone(spread)
    }

    fn in_cone(cone: I2F30, fraction: U0F32) -> Option<[I2F30; 3]> {
        Mixed::in_cone(cone, fraction).map(Self::all_kept)
    }

    fn balance_of_cap(cosine: I2F30, turned: I16F16, reach: Magnitude, square: I32F32) -> Magnitude {
        Mixed::balance_of_cap(cosine, turned, reach, square)
    }

    fn balance_of_cone(cosine: I2F30, cone: I2F30, reach: Magnitude) -> Magnitude {
        Mixed::balance_of_cone(cosine, cone, reach)
    }

    fn share(balance: Magnitude) -> U0F32 {
        Mixed::share(balance)
    }

    fn thinned(balance: Magnitude, fraction: impl FnOnce() -> U0F32) -> Option<U0F32> {
        Mixed::thinned(balance, fraction)
    }
}
