//! What looking for light needs of the number formats.

use core::fmt::Debug;

use fixedmath::{I2F30, I16F16, I32F32, I48F16, U0F32, root, unit};

use super::{CapLight, Magnitude};
use crate::arithmetic::{Directions, Formats, Mixed, Published, Sampling};
use crate::geometry::sphere::SphereNumbers;
use crate::material::RadianceNumbers;

/// Caps and cones, and how light found in two ways is shared between them.
pub trait LightNumbers: SphereNumbers + RadianceNumbers + Sampling {
    /// A cone of directions.
    type Cone: Copy + Debug;
    /// A share of light, however small: [0, 1].
    type Balance: Copy + Debug;

    /// `v` brought to unit length; none where it has no length.
    fn direction(v: [Self::Length; 3]) -> Option<[Self::Unit; 3]>;
    /// A point of a cap, uniform by area; none for one fraction in five, as of [`Sampling::on_hemisphere`].
    fn on_cap(cap: &CapLight, fraction: U0F32) -> Option<[Self::Length; 3]>;
    /// The cone that a sphere of this radius fills, seen from so far (squared) from its centre; none from within. It may be too large by a
    /// bit, and never is too small.
    fn cone(radius: Self::Length, square: Self::Square) -> Option<Self::Cone>;
    /// A cone of the scene, by the root of twice one minus the cosine of its half angle.
    fn stored_cone(spread: I2F30) -> Self::Cone;
    /// A direction in a cone round the third axis, uniform by solid angle; none for one fraction in five.
    fn in_cone(cone: Self::Cone, fraction: U0F32) -> Option<[Self::Unit; 3]>;

    /// `own / (own + looked)` for a point that is drawn by area: `g / (g + square)`, with `g` the product of the surface's cosine, that of
    /// the emitter times its radius, and `reach`. Both are positive.
    fn balance_of_cap(
        cosine: Self::Unit,
        turned: Self::Length,
        reach: Magnitude,
        square: Self::Square,
    ) -> Self::Balance;
    /// The same for a direction in a cone: `g / (g + 1)`, with `g` the product of the cosine, one minus the cosine of the cone's half angle,
    /// and `reach`.
    fn balance_of_cone(cosine: Self::Unit, cone: Self::Cone, reach: Magnitude) -> Self::Balance;
    /// The share as light is weighed by it.
    fn share(balance: Self::Balance) -> Self::Weight;
    /// The same for a connection: a share below 2^[`LEAST_SHARE`] is doubled until it is not, and kept with the chance that makes up for
    /// it. So none is lost in the formats of light, however far or small its emitter.
    fn thinned(balance: Self::Balance, fraction: impl FnOnce() -> U0F32) -> Option<Self::Weight>;
}

/// The least share of light that a connection has for certain is 2 to the power of this.
pub const LEAST_SHARE: i32 = -13;
/// The least chance that makes up for a share is 2 to the power of minus this: a fraction has no more bits.
pub const MOST_DOUBLINGS: i32 = 32;

/// 2^-13, whose square is 2^-29 where it counts.
const FLAT: U0F32 = U0F32::from_bits(1 << 19);

/// 1 as a product of two direction components, 4:60.
const ONE_SQUARED: u64 = 1 << 60;

impl LightNumbers for Mixed {
    /// The root of twice its height.
    type Cone = I2F30;
    type Balance = Magnitude;

    #[inline]
    fn direction(v: [I16F16; 3]) -> Option<[I2F30; 3]> {
        unit::checked_of_vector(v)
    }

    #[inline]
    fn on_cap(cap: &CapLight, fraction: U0F32) -> Option<[I16F16; 3]> {
        let ([x, y], square) = on_disc(fraction)?;
        let fallen = upper(cap.height, square) >> 1u32;
        let flatness = if fallen < FLAT {
            // The root of 1 less x is 1 less x / 2, and x^2 / 8 less than that.
            I2F30::from_bits((1 << 30) - (fallen.to_bits() >> 3) as i32)
        } else {
            Self::root_of(!fallen)
        };
        let [x, y] = [x, y].map(|c| i64::from(Self::times(c, flatness).to_bits()));
        let below = i64::from(square.to_bits() >> 2);
        let component = |i: usize| {
            let sum = x * i64::from(cap.across[0][i].to_bits()) + y * i64::from(cap.across[1][i].to_bits())
                - below * i64::from(cap.down[i].to_bits());
            cap.pole[i] + I16F16::from_bits(((sum + (1 << 29)) >> 30) as i32)
        };
        Some([component(0), component(1), component(2)])
    }

    #[inline]
    fn cone(radius: I16F16, square: I32F32) -> Option<I2F30> {
        let part = Self::product(radius, radius);
        if part >= square {
            return None;
        }
        // 1 - cos = sin^2 / (1 + cos)
        let sine_squared = magnitude(part).over(magnitude(square));
        let cosine = root::nearest(ONE_SQUARED.saturating_sub(sine_squared.to_fixed(60)));
        let height = sine_squared.over(Magnitude::new((1 << 30) + u64::from(cosine), -30));
        Some(I2F30::from_bits(root::nearest(height.to_fixed(61)) as i32 + 1))
    }

    #[inline]
    fn stored_cone(spread: I2F30) -> I2F30 {
        spread
    }

    #[inline]
    fn in_cone(spread: I2F30, fraction: U0F32) -> Option<[I2F30; 3]> {
        let ([x, y], square) = on_disc(fraction)?;
        let bits = i64::from(spread.to_bits());
        let height = U0F32::from_bits(((bits * bits) >> 29) as u32);
        let below = upper(height, square);
        // 1 - cos is below, and sin^2 = (1 - cos) (1 + cos).
        let spread = Self::times(spread, Self::root_of(!(below >> 1u32)));
        Some([
            Self::times(x, spread),
            Self::times(y, spread),
            I2F30::from_bits((1 << 30) - (below.to_bits() >> 2) as i32),
        ])
    }

    #[inline(never)]
    fn balance_of_cap(cosine: I2F30, turned: I16F16, reach: Magnitude, square: I32F32) -> Magnitude {
        let own = cosine.to_bits() as u64 * turned.to_bits() as u64;
        let own = Magnitude::new(own, -46).times(reach);
        own.over(own.plus(magnitude(square)))
    }

    #[inline]
    fn balance_of_cone(cosine: I2F30, spread: I2F30, reach: Magnitude) -> Magnitude {
        let spread = spread.to_bits() as u64;
        let own = Magnitude::new(cosine.to_bits() as u64, -30)
            .times(Magnitude::new(spread * spread, -61))
            .times(reach);
        own.over(own.plus(Magnitude::new(1, 0)))
    }

    #[inline]
    fn share(balance: Magnitude) -> U0F32 {
        U0F32::from_bits(balance.to_share())
    }

    #[inline]
    fn thinned(balance: Magnitude, fraction: impl FnOnce() -> U0F32) -> Option<U0F32> {
        let excess = (LEAST_SHARE + 1 - balance.log2()).min(MOST_DOUBLINGS);
        if excess <= 0 {
            return Some(Self::share(balance));
        }
        let chance = ((1u64 << (MOST_DOUBLINGS - excess)) - 1) as u32;
        (fraction().to_bits() <= chance).then(|| Self::share(balance.scaled(excess)))
    }
}

/// A point of the unit disc, 16 bits of a fraction for each coordinate, and the square of how far it is from the middle.
#[inline]
fn on_disc(fraction: U0F32) -> Option<([I2F30; 2], U0F32)> {
    let bits = fraction.to_bits();
    // 1:31, halfway between two multiples of 2^-15.
    let [x, y] = [bits & 0xffff_0000 | 0x8000, bits << 16 | 0x8000].map(|coordinate| coordinate as i32);
    let squared = |c: i32| ((i64::from(c) * i64::from(c)) >> 32) as u32;
    let square = squared(x) + squared(y);
    (square < 1 << 30).then(|| {
        (
            [x, y].map(|c| I2F30::from_bits(c >> 1)),
            U0F32::from_bits(square << 2),
        )
    })
}

#[inline]
fn upper(a: U0F32, b: U0F32) -> U0F32 {
    let product = u64::from(a.to_bits()) * u64::from(b.to_bits());
    U0F32::from_bits((product >> 32) as u32)
}

#[inline]
fn magnitude(square: I32F32) -> Magnitude {
    Magnitude::new(square.to_bits() as u64, -32)
}

/// As the published system has no light sampling, this is ours with its formats.
impl LightNumbers for Published {
    type Cone = I2F30;
    type Balance = Magnitude;

    fn direction(v: [I16F16; 3]) -> Option<[I16F16; 3]> {
        Mixed::direction(v).map(|direction| direction.map(Self::unit))
    }

    fn on_cap(cap: &CapLight, fraction: U0F32) -> Option<[I16F16; 3]> {
        Mixed::on_cap(cap, fraction)
    }

    fn cone(radius: I16F16, square: I48F16) -> Option<I2F30> {
        Mixed::cone(radius, widened_square(square))
    }

    fn stored_cone(spread: I2F30) -> I2F30 {
        spread
    }

    fn in_cone(cone: I2F30, fraction: U0F32) -> Option<[I16F16; 3]> {
        Mixed::in_cone(cone, fraction).map(|direction| direction.map(Self::unit))
    }

    fn balance_of_cap(cosine: I16F16, turned: I16F16, reach: Magnitude, square: I48F16) -> Magnitude {
        Mixed::balance_of_cap(widened(cosine), turned, reach, widened_square(square))
    }

    fn balance_of_cone(cosine: I16F16, cone: I2F30, reach: Magnitude) -> Magnitude {
        Mixed::balance_of_cone(widened(cosine), cone, reach)
    }

    fn share(balance: Magnitude) -> I16F16 {
        Self::weight(Mixed::share(balance))
    }

    fn thinned(balance: Magnitude, fraction: impl FnOnce() -> U0F32) -> Option<I16F16> {
        Mixed::thinned(balance, fraction).map(Self::weight)
    }
}

fn widened(component: I16F16) -> I2F30 {
    I2F30::from_bits(component.to_bits() << 14)
}

fn widened_square(square: I48F16) -> I32F32 {
    I32F32::from_bits(square.to_bits() << 16)
}
