//! The scene's grid: coordinates in 16 bits.

use fixedmath::I16F16;

/// A scene's grid of whole units, fine enough that nothing that rays are tested against there is more than [`Grid::REACH`] units from
/// where a ray starts. Coordinates fit 16 bits.
///
/// A product of two 16-bit numbers is one cycle on an ARM9E-S (`SMULxy`, `SMLAxy`), of two 32-bit ones three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    shift: u32,
}

impl Grid {
    /// The longest distance, in units: twice its square fits a word.
    pub const REACH: i32 = 32_000;

    /// The finest grid for rays that start no further than `farthest` from the centre of anything on it, where no coordinate of a start
    /// or of a centre exceeds `coordinate`.
    pub fn finest(farthest: I16F16, coordinate: I16F16) -> Self {
        let mut shift = 0;
        while farthest.to_bits() >> shift >= Self::REACH || coordinate.to_bits() >> shift >= 1 << 15 {
            shift += 1;
        }
        Self { shift }
    }

    /// The grid of units of 2^(`shift` - 16), for a shift below 32.
    pub const fn new(shift: u32) -> Self {
        Self { shift: shift % 32 }
    }

    /// What brings 16:16 to units: below 32.
    #[inline]
    pub const fn shift(self) -> u32 {
        self.shift % 32
    }
}
