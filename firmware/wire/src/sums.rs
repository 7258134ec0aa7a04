//! Sums of radiance, packed.
//!
//! One pixel is three sums, red, green and blue, each an unsigned 40-bit integer (24:16), little-endian: 15 bytes. The host scales a
//! scene's light so that sums stay below 2^24 but with a chance of 2^-96. One that does not is sent as [`SUM_MAX`], which says so.

use core::fmt;

use crate::{DecodeError, MAX_PIXELS};

/// The greatest sum the wire can carry: 2^40 - 1, in units of 2^-16. It stands for itself and for all that is greater: who receives it
/// must take it for saturated.
pub const SUM_MAX: u64 = (1 << 40) - 1;

/// Bytes of one sum.
const SUM_LEN: usize = 5;

/// Bytes of one pixel.
const PIXEL_LEN: usize = 3 * SUM_LEN;

/// Sums that no packet can carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumsError {
    /// There are no pixels, or more than [`MAX_PIXELS`].
    Pixels,
}

impl SumsError {
    /// The error in words.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Pixels => "a packet carries 1 to 16 pixels",
        }
    }
}

impl fmt::Display for SumsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl core::error::Error for SumsError {}

/// The sums of 1 to [`MAX_PIXELS`] pixels as they travel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PixelSums {
    packed: [u8; PixelSums::MAX_LEN],
    pixels: u8,
}

impl PixelSums {
    /// Bytes that the most pixels take.
    pub(crate) const MAX_LEN: usize = MAX_PIXELS * PIXEL_LEN;

    /// Packs the sums of `pixels`; what is greater than [`SUM_MAX`] becomes that.
    pub fn new(pixels: &[[u64; 3]]) -> Result<Self, SumsError> {
        let mut packed = [0; Self::MAX_LEN];
        if pixels.is_empty() || pixels.len() > MAX_PIXELS {
            return Err(SumsError::Pixels);
        }
        for (slot, &sum) in packed.chunks_exact_mut(SUM_LEN).zip(pixels.iter().flatten()) {
            slot.copy_from_slice(&sum.min(SUM_MAX).to_le_bytes()[..SUM_LEN]);
        }
        Ok(Self {
            packed,
            pixels: pixels.len() as u8,
        })
    }

    /// How many pixels there are.
    pub fn pixels(&self) -> u8 {
        self.pixels
    }

    /// Red, green and blue of every pixel, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = [u64; 3]> + '_ {
        self.bytes().chunks_exact(PIXEL_LEN).map(|pixel| {
            let mut sums = [0; 3];
            for (sum, bytes) in sums.iter_mut().zip(pixel.chunks_exact(SUM_LEN)) {
                *sum = bytes
                    .iter()
                    .rev()
                    .fold(0, |sum, &byte| sum << 8 | u64::from(byte));
            }
            sums
        })
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        let len = usize::from(self.pixels) * PIXEL_LEN;
        self.packed.get(..len).unwrap_or(&self.packed)
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, DecodeError> {
        let mut packed = [0; Self::MAX_LEN];
        let room = packed.get_mut(..bytes.len()).ok_or(DecodeError::TooLong)?;
        if bytes.is_empty() || !bytes.len().is_multiple_of(PIXEL_LEN) {
            return Err(DecodeError::Truncated);
        }
        room.copy_from_slice(bytes);
        let pixels = (bytes.len() / PIXEL_LEN) as u8;
        Ok(Self { packed, pixels })
    }
}

impl fmt::Debug for PixelSums {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
