//! The plan of a picture: its size, its samples, and how it falls into units.

use fixedmath::I16F16;

/// Pixels in a unit: a span of the picture in row-major order, the top row first.
pub const SPAN: usize = 16;

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// By Russian roulette, once it has bounced five times.
    Roulette,
    /// At this many surfaces.
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

    /// Column and row of a pixel by its row-major index.
    #[inline]
    pub fn place(&self, pixel: u32) -> (u32, u32) {
        let width = u32::from(self.width);
        (pixel % width, pixel / width)
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
