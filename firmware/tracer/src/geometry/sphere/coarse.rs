//! A sphere in 16 bits: enough to know that a ray misses it, in a third of the time that it takes to know where it is hit.

use bytemuck::{Pod, Zeroable};
use fixedmath::halves::{self, Halves};
use fixedmath::{I2F30, I16F16, I32F32};

use crate::geometry::Grid;

/// A sphere on the scene's [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CoarseSphere {
    /// The centre's x and y, rounded down, as [`Halves`].
    xy: i32,
    /// Its z likewise, and zero.
    z: i32,
    /// The squared distance from which on a point is surely outside, times -1.
    inside: i32,
    /// Zero.
    reserved: u32,
}

/// A ray on the grid.
#[derive(Clone, Copy, Debug)]
pub struct CoarseRay {
    /// The x and y of its start, rounded down.
    origin: Halves,
    /// The x and y of its direction, 2:14, rounded down.
    direction: Halves,
    /// The z of both.
    z: Halves,
}

/// Units by which a projection may come out wrong: 2.5 of a vector's components, less than 1, 1 and 2 units off (a subtraction of
/// lower halves may borrow one from the upper); 3.5 of the direction's 14 fraction bits over the longest vector; and 1 of the shift.
const SLACK: i32 = 7;

impl CoarseRay {
    /// A ray as it is seen there.
    #[inline]
    pub(super) fn new(grid: Grid, origin: [I16F16; 3], direction: [I2F30; 3]) -> Self {
        let [x, y, z] = origin.map(|o| o.to_bits() >> grid.shift());
        let [u, v, w] = direction.map(I2F30::to_bits);
        Self {
            origin: Halves::of_lower(x, y),
            direction: Halves::of_upper(u, v),
            z: Halves::of_upper(z << 16, w),
        }
    }
}

impl CoarseSphere {
    /// The sphere of this centre and squared radius, for rays that start no further than `farthest` from its centre.
    pub fn new(grid: Grid, centre: [I16F16; 3], square: I32F32, farthest: I16F16) -> Self {
        // A vector that is sqrt(6) units off is too long by that, and its square by 6 and 2 sqrt(6) times its length.
        let units = (square.to_bits() >> (2 * grid.shift())) + 1;
        let longest = i64::from(farthest.to_bits() >> grid.shift()) + 1;
        let margin = longest * 49 / 10 + 7;
        let [x, y, z] = centre.map(|c| (c.to_bits() >> grid.shift()) as i16);
        Self {
            xy: Halves::new(x, y).to_bits(),
            z: Halves::new(z, 0).to_bits(),
            inside: -(units + margin).min(1 << 30) as i32,
            reserved: 0,
        }
    }

    /// Whether it tells most rays that miss it, which start up to `farthest` from its centre: what it takes for a hit is a sphere of at
    /// most a fourth of that for a radius.
    pub fn is_telling(&self, grid: Grid, farthest: I16F16) -> bool {
        let longest = i64::from(farthest.to_bits() >> grid.shift()) + 1;
        // The discriminant may be too large by twice a projection times what that is off.
        let taken = i64::from(2 * SLACK) * longest - i64::from(self.inside);
        16 * taken <= longest * longest
    }

    /// `false` only where the ray surely does not meet the sphere nearer than `t_max`: it starts outside, and passes by, leaves it
    /// behind, or ends before.
    #[inline]
    pub(super) fn may_be_met(&self, grid: Grid, ray: &CoarseRay, t_max: I16F16) -> bool {
        let xy = Halves::from_bits(self.xy.wrapping_sub(ray.origin.to_bits()));
        let z = Halves::from_bits(self.z.wrapping_sub(ray.z.to_bits()));
        let outside = halves::wrapping_lower(halves::wrapping_dot(self.inside, xy, xy), z, z);
        if outside < 0 {
            return true;
        }
        let b = halves::wrapping_lower_upper(halves::wrapping_dot(SLACK << 14, xy, ray.direction), z, ray.z)
            >> 14;
        let discriminant = b * b - outside;
        if b < 0 || discriminant < 0 {
            return false;
        }
        // The near root is b less the discriminant's root.
        let beyond = b - 2 * SLACK - 1 - (t_max.to_bits() >> grid.shift());
        beyond < 0 || beyond * beyond <= discriminant
    }
}
