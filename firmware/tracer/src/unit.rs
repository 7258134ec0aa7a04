//! The work unit: a pure function of scene, camera, plan and unit id.

use fixedmath::{U32F32, U48F16};

use crate::camera::Camera;
use crate::integrator::{Integrator, Sample};
use crate::material::RadianceNumbers;
use crate::profile::Profile;
use crate::random::Random;
use crate::scene::Scene;

pub use crate::plan::{Extent, Plan, SPAN, Termination};

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
    let (mut column, mut row) = plan.place(extent.first_pixel);
    for pixel in 0..usize::from(extent.pixels) {
        random.start_pixel();
        let (left, below) = (2 * column, 2 * (u32::from(plan.height) - 1 - row));
        for subpixel in 0..4 {
            for _ in 0..extent.samples / 4 {
                random.start_sample();
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
