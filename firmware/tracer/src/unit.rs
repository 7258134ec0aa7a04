//! The work unit: a pure function of scene, plan and unit id.

use crate::integrator::{Path, Sample};
use crate::numbers::Numbers;
use crate::profile::Profile;
use crate::random::Random;
use crate::scene::{Needs, Scene};

pub use crate::integrator::Termination;

/// Pixels in a unit: a run of the picture in row-major order, the top row first.
pub const RUN: usize = 16;

/// What all units of one picture share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// Samples per pixel in all; a multiple of 4.
    pub spp: u32,
    /// Samples per pixel in one unit; a multiple of 4.
    pub samples_per_unit: u16,
    /// Seed of the whole render.
    pub seed: u64,
    /// When a path ends.
    pub termination: Termination,
    /// Self-intersection epsilon in 16:16.
    pub epsilon: i32,
}

/// One unit's share of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Row-major index of the first pixel.
    pub first_pixel: u32,
    /// Pixels, 1 to [`RUN`].
    pub pixels: u8,
    /// Samples per pixel.
    pub samples: u16,
}

impl Plan {
    /// Runs of [`RUN`] pixels in one pass over the picture.
    pub fn runs(&self) -> u32 {
        (u32::from(self.width) * u32::from(self.height)).div_ceil(RUN as u32)
    }

    /// Passes that make up [`Plan::spp`].
    pub fn passes(&self) -> u32 {
        self.spp.div_ceil(u32::from(self.samples_per_unit))
    }

    /// Units in the whole picture; ids are `pass * runs + run`. `None` where they do not fit 32 bits.
    pub fn units(&self) -> Option<u32> {
        self.runs().checked_mul(self.passes())
    }

    /// The share of unit `id`. Ids past [`Plan::units`] are further full passes (the stochastic mode draws them).
    pub fn extent(&self, id: u32) -> Extent {
        let (pass, run) = (id / self.runs(), id % self.runs());
        let all = u32::from(self.width) * u32::from(self.height);
        let first_pixel = run * RUN as u32;
        let full = u32::from(self.samples_per_unit);
        let left = self.spp.saturating_sub(pass.saturating_mul(full));
        let samples = if left == 0 { full } else { left.min(full) };
        Extent {
            first_pixel,
            pixels: (all - first_pixel).min(RUN as u32) as u8,
            samples: samples as u16,
        }
    }
}

/// Sums of radiance over one unit's samples: red, green, blue of each pixel in 24:16.
pub type Sums = [[u64; 3]; RUN];

/// Walks the samples of unit `id` in their fixed order and hands each to `take` with its pixel's place in the unit.
///
/// A pixel's samples are spread evenly over its 2x2 sub-pixels. One random stream runs through the whole unit.
#[inline]
pub fn walk<P: Profile, F: Needs>(
    scene: &Scene<P::Numbers>,
    plan: &Plan,
    id: u32,
    mut take: impl FnMut(usize, Sample<P::Numbers>),
) {
    let extent = plan.extent(id);
    let path = Path::<P, F>::new(scene, plan.termination, plan.epsilon);
    let mut random = P::Random::for_unit(plan.seed, id);
    let width = u32::from(plan.width);
    let (mut column, mut row) = (extent.first_pixel % width, extent.first_pixel / width);
    for pixel in 0..usize::from(extent.pixels) {
        let (left, below) = (2 * column, 2 * (u32::from(plan.height) - 1 - row));
        for subpixel in 0..4 {
            for _ in 0..extent.samples / 4 {
                let ray = scene
                    .camera
                    .ray(left + (subpixel & 1), below + (subpixel >> 1), &mut random);
                take(pixel, path.sample(ray, &mut random));
            }
        }
        column += 1;
        if column == width {
            (column, row) = (0, row + 1);
        }
    }
}

/// Renders unit `id` into `sums` and returns how many rays it took. Pixels past the picture's end are zero.
///
/// 4,096 samples of radiance up to 4,095 leave the 32:32 sums 8 bits to spare for paths that meet several lights.
pub fn render<P: Profile, F: Needs>(scene: &Scene<P::Numbers>, plan: &Plan, id: u32, sums: &mut Sums) -> u32 {
    *sums = [[0; 3]; RUN];
    let mut rays = 0;
    walk::<P, F>(scene, plan, id, |pixel, sample| {
        rays += sample.rays;
        for (sum, radiance) in sums[pixel].iter_mut().zip(sample.radiance) {
            *sum += P::Numbers::radiance_bits(radiance);
        }
    });
    // Summed in 32:32 and rounded once.
    for sum in sums.as_flattened_mut() {
        *sum = (*sum >> 16) + (*sum >> 15 & 1);
    }
    rays
}
