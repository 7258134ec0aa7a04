//! The work unit: a pure function of scene, camera, plan and unit id.

use fixedmath::{I16F16, U32F32, U48F16};

use crate::camera::Camera;
use crate::integrator::{Integrator, Sample};
use crate::material::RadianceNumbers;
use crate::profile::Profile;
use crate::random::Random;
use crate::scene::Scene;

pub use crate::integrator::Termination;

/// Pixels in a unit: a span of the picture in row-major order, the top row first.
pub const SPAN: usize = 16;

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
    /// Self-intersection epsilon.
    pub epsilon: I16F16,
}

/// One unit's share of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Row-major index of the first pixel.
    pub first_pixel: u32,
    /// Pixels, 1 to [`SPAN`].
    pub pixels: u8,
    /// Samples per pixel.
    pub samples: u16,
}

impl Plan {
    /// Spans of [`SPAN`] pixels in one pass over the picture.
    pub fn spans(&self) -> u32 {
        (u32::from(self.width) * u32::from(self.height)).div_ceil(SPAN as u32)
    }

    /// Passes that make up [`Plan::spp`].
    pub fn passes(&self) -> u32 {
        self.spp.div_ceil(u32::from(self.samples_per_unit))
    }

    /// Units in the whole picture; ids are `pass * spans + span`. `None` where they do not fit 32 bits.
    pub fn units(&self) -> Option<u32> {
        self.spans().checked_mul(self.passes())
    }

    /// The share of unit `id`. Ids past [`Plan::units`] are further full passes (the stochastic mode draws them).
    pub fn extent(&self, id: u32) -> Extent {
        let (pass, span) = (id / self.spans(), id % self.spans());
        let all = u32::from(self.width) * u32::from(self.height);
        let first_pixel = span * SPAN as u32;
        let full = u32::from(self.samples_per_unit);
        let left = self.spp.saturating_sub(pass.saturating_mul(full));
        let samples = if left == 0 { full } else { left.min(full) };
        Extent {
            first_pixel,
            pixels: (all - first_pixel).min(SPAN as u32) as u8,
            samples: samples as u16,
        }
    }
}

/// Sums of radiance over one unit's samples: red, green, blue of each pixel. None reaches 2^24.
pub type Sums = [[U48F16; 3]; SPAN];

/// Walks the samples of unit `id` in their fixed order and hands each to `take` with its pixel's place in the unit.
///
/// A pixel's samples are spread evenly over its 2x2 sub-pixels. One random stream runs through the whole unit.
#[inline]
pub fn walk<P: Profile>(
    integrator: &impl Integrator<P>,
    scene: &Scene<'_>,
    camera: &Camera<P::Numbers>,
    plan: &Plan,
    id: u32,
    mut take: impl FnMut(usize, Sample<P::Numbers>),
) {
    let extent = plan.extent(id);
    let mut random = P::Random::for_unit(plan.seed, id);
    let width = u32::from(plan.width);
    let (mut column, mut row) = (extent.first_pixel % width, extent.first_pixel / width);
    for pixel in 0..usize::from(extent.pixels) {
        let (left, below) = (2 * column, 2 * (u32::from(plan.height) - 1 - row));
        for subpixel in 0..4 {
            for _ in 0..extent.samples / 4 {
                let ray = camera.ray(left + (subpixel & 1), below + (subpixel >> 1), &mut random);
                take(pixel, integrator.sample(scene, ray, &mut random));
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
pub fn render<P: Profile>(
    integrator: &impl Integrator<P>,
    scene: &Scene<'_>,
    camera: &Camera<P::Numbers>,
    plan: &Plan,
    id: u32,
    sums: &mut Sums,
) -> u32 {
    let mut wide = [[U32F32::ZERO; 3]; SPAN];
    let mut rays = 0;
    walk(integrator, scene, camera, plan, id, |pixel, sample| {
        rays += sample.rays;
        for (sum, radiance) in wide[pixel].iter_mut().zip(sample.radiance) {
            *sum += P::Numbers::film_sum(radiance);
        }
    });
    // Summed in 32:32 and rounded once.
    for (sum, wide) in sums.as_flattened_mut().iter_mut().zip(wide.as_flattened()) {
        let bits = wide.to_bits();
        *sum = U48F16::from_bits((bits >> 16) + (bits >> 15 & 1));
    }
    rays
}
