//! What vast spheres need of the number formats.

use core::fmt::Debug;
use core::ops::Neg;

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I16F16, I18F46, division, root, unit};

use crate::arithmetic::{Directions, Formats, Mixed, Published};

/// A curvature and its radius, both with the curvature's sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Bend {
    /// 1 / r in 0:44: an error of half a unit of it moves no point of the scene by more than half an ulp.
    pub curvature: i32,
    /// r as a mantissa of 16:16, at least 2^30, or 2^`shift` times that.
    pub radius: i32,
    /// Below 31.
    pub shift: u32,
}

impl Bend {
    /// Whether the surface bends towards the side that rays are on.
    #[inline]
    pub fn is_towards(self) -> bool {
        self.radius > 0
    }

    pub(super) fn is_sound(self) -> bool {
        let curvature = if self.is_towards() {
            self.curvature
        } else {
            self.curvature.wrapping_neg()
        };
        self.shift < 31 && self.radius.unsigned_abs() >= 1 << 30 && curvature >= 0
    }

    /// As it is seen from the other side.
    #[inline]
    #[must_use]
    pub fn turned(self) -> Self {
        Self {
            curvature: -self.curvature,
            radius: -self.radius,
            shift: self.shift,
        }
    }
}

/// Heights above a vast sphere, and slopes along a ray.
///
/// Ranges are the scene compiler's to guarantee: nothing that a ray meets is 2^15 / 3 or more from the middle of the scene, where
/// the pole is no further away, and the radius is at least twice that. Then heights are lengths, and slopes stay below 1.8.
pub trait VastNumbers: Directions {
    /// A height before it is rounded.
    type Height: Copy + Debug + Neg<Output = Self::Height>;

    /// A height of 0.
    const LEVEL: Self::Height;

    /// The height of a point that is `above` the pole by so much, where the unit normal is `normal`.
    fn height(normal: [I2F30; 3], bend: Bend, above: [Self::Length; 3]) -> Self::Height;
    /// Whether it is below the surface.
    fn is_below(height: Self::Height) -> bool;
    /// What the height gains along `direction`, at its start.
    fn slope(
        normal: [I2F30; 3],
        bend: Bend,
        above: [Self::Length; 3],
        direction: [Self::Unit; 3],
    ) -> Self::Unit;
    /// The height at `t` along the ray.
    fn height_at(bend: Bend, height: Self::Height, slope: Self::Unit, t: Self::Length) -> Self::Height;
    /// How steeply a ray crosses the surface; `None` where it passes by.
    fn root_of_slope(bend: Bend, height: Self::Height, slope: Self::Unit) -> Option<Self::Unit>;
    /// Whether a ray is so flat to the surface where it meets it that rounding decides on which side it is.
    fn is_level(root: Self::Unit) -> bool;
    /// Where the ray goes under the surface, if that is nearer than `t_max` or only a little further; at once, if it is below.
    fn goes_under(
        bend: Bend,
        height: Self::Height,
        slope: Self::Unit,
        root: Self::Unit,
        t_max: Self::Length,
    ) -> Option<Self::Length>;
    /// The unit normal at a point of the surface.
    fn upward(normal: [I2F30; 3], bend: Bend, above: [Self::Length; 3]) -> [Self::Unit; 3];
    /// A point moved down by a small height.
    fn lowered(point: [Self::Length; 3], height: Self::Height, upward: [Self::Unit; 3]) -> [Self::Length; 3];
}

/// `(a b) >> shift` for a shift of 1 to 32, or 33 to 63 where `whole` is that less 32.
#[inline]
fn upper(a: i64, b: i32, shift: u32) -> i64 {
    let (high, low) = (a >> 32, i64::from(a as u32));
    let b = i64::from(b);
    // Whole words of the product, and what its lowest word carries.
    let middle = high.wrapping_mul(b) + ((low * b) >> 32);
    if shift >= 32 {
        middle >> (shift - 32)
    } else {
        middle << (32 - shift)
    }
}

#[inline]
fn sum_of_products(a: [i32; 3], b: [i32; 3]) -> i64 {
    let times = |i: usize| i64::from(a[i]) * i64::from(b[i]);
    times(0) + times(1) + times(2)
}

impl VastNumbers for Mixed {
    type Height = I18F46;

    const LEVEL: I18F46 = I18F46::ZERO;

    #[inline]
    fn height(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> I18F46 {
        let above = above.map(I16F16::to_bits);
        let sag = upper(sum_of_products(above, above), bend.curvature, 31);
        I18F46::from_bits(sum_of_products(above, normal.map(I2F30::to_bits)) - sag)
    }

    #[inline]
    fn is_below(height: I18F46) -> bool {
        height < I18F46::ZERO
    }

    #[inline]
    fn slope(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3], direction: [I2F30; 3]) -> I2F30 {
        let direction = direction.map(I2F30::to_bits);
        let along = sum_of_products(above.map(I16F16::to_bits), direction);
        let slope = sum_of_products(normal.map(I2F30::to_bits), direction) - upper(along, bend.curvature, 30);
        I2F30::from_bits(((slope + (1 << 29)) >> 30) as i32)
    }

    #[inline]
    fn height_at(bend: Bend, height: I18F46, slope: I2F30, t: I16F16) -> I18F46 {
        let t = i64::from(t.to_bits());
        let gain = t * i64::from(slope.to_bits()) - upper(t * t, bend.curvature, 31);
        I18F46::from_bits(height.to_bits() + gain)
    }

    #[inline]
    fn root_of_slope(bend: Bend, height: I18F46, slope: I2F30) -> Option<I2F30> {
        let slope = i64::from(slope.to_bits());
        let square = slope * slope + upper(height.to_bits(), bend.curvature, 29);
        (square >= 0).then(|| I2F30::from_bits(root::nearest(square as u64) as i32))
    }

    /// 4 ulp: as much as slopes are rounded by.
    fn is_level(root: I2F30) -> bool {
        root <= I2F30::from_bits(4)
    }

    #[inline]
    fn goes_under(bend: Bend, height: I18F46, slope: I2F30, root: I2F30, t_max: I16F16) -> Option<I16F16> {
        let (slope, root) = (slope.to_bits(), root.to_bits());
        let t_max = t_max.to_bits() as u64;
        if slope > 0 {
            if !bend.is_towards() {
                return None;
            }
            let t = (u64::from(slope.wrapping_add(root) as u32) * bend.radius as u64) >> (30 - bend.shift);
            return (t < t_max).then(|| I16F16::from_bits(t as i32));
        }
        if height <= I18F46::ZERO {
            return Some(I16F16::ZERO);
        }
        let (twice, steepness) = ((height.to_bits() as u64) << 1, root.wrapping_sub(slope) as u32);
        if twice >= t_max * u64::from(steepness) {
            return None;
        }
        Some(I16F16::from_bits(division::long(twice, steepness) as i32))
    }

    fn upward(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> [I2F30; 3] {
        unit::renormalised([0, 1, 2].map(|i| {
            let turned = i64::from(above[i].to_bits()) * i64::from(bend.curvature);
            normal[i] - I2F30::from_bits(((turned + (1 << 29)) >> 30) as i32)
        }))
    }

    fn lowered(point: [I16F16; 3], height: I18F46, upward: [I2F30; 3]) -> [I16F16; 3] {
        let height = I16F16::from_bits(((height.to_bits() + (1 << 29)) >> 30) as i32);
        [0, 1, 2].map(|i| point[i] - Self::scale(height, upward[i]))
    }
}

fn fine(component: I16F16) -> I2F30 {
    I2F30::from_bits(component.to_bits() << 14)
}

/// The published system has no such spheres. It gets these with its own directions, 16:16, and long intermediates.
impl VastNumbers for Published {
    type Height = I18F46;

    const LEVEL: I18F46 = I18F46::ZERO;

    fn height(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> I18F46 {
        Mixed::height(normal, bend, above)
    }

    fn is_below(height: I18F46) -> bool {
        Mixed::is_below(height)
    }

    fn slope(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3], direction: [I16F16; 3]) -> I16F16 {
        Self::unit(Mixed::slope(normal, bend, above, direction.map(fine)))
    }

    fn height_at(bend: Bend, height: I18F46, slope: I16F16, t: I16F16) -> I18F46 {
        Mixed::height_at(bend, height, fine(slope), t)
    }

    fn root_of_slope(bend: Bend, height: I18F46, slope: I16F16) -> Option<I16F16> {
        Mixed::root_of_slope(bend, height, fine(slope)).map(Self::unit)
    }

    fn is_level(root: I16F16) -> bool {
        Mixed::is_level(fine(root))
    }

    fn goes_under(bend: Bend, height: I18F46, slope: I16F16, root: I16F16, t_max: I16F16) -> Option<I16F16> {
        Mixed::goes_under(bend, height, fine(slope), fine(root), t_max)
    }

    fn upward(normal: [I2F30; 3], bend: Bend, above: [I16F16; 3]) -> [I16F16; 3] {
        Mixed::upward(normal, bend, above).map(Self::unit)
    }

    fn lowered(point: [I16F16; 3], height: I18F46, upward: [I16F16; 3]) -> [I16F16; 3] {
        Mixed::lowered(point, height, upward.map(fine))
    }
}
