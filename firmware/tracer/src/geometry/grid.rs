//! The scene's grid: coordinates in 16 bits.

use fixedmath::I16F16;

/// A scene's grid of whole units, fine enough that nothing that rays are tested against there is more than [`Grid::REACH`] units from
/// where a ray starts. A start's coordinates fit 16 bits, and so does twice a centre's.
///
/// A product of two 16-bit numbers is one cycle on an ARM9E-S (`SMULxy`, `SMLAxy`), of two 32-bit ones three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    shift: u32,
}

impl Grid {
    /// The longest distance, in units: its square fits a word, and so does twice its product with a direction in 2:14.
    pub const REACH: i32 = 23_000;

    /// The finest grid for rays that start no further than `farthest` from the centre of anything on it, where no coordinate of a start
    /// exceeds `start`, and none of a centre `centre`.
    pub fn finest(farthest: I16F16, start: I16F16, centre: I16F16) -> Self {
        let mut shift = 0;
        let exceeds = |length: I16F16, shift: u32, most: i32| length.to_bits() >> shift >= most;
        while exceeds(farthest, shift, Self::REACH)
            || exceeds(start, shift, 1 << 15)
            || exceeds(centre, shift, 1 << 14)
        {
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
