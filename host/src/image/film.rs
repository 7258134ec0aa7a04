//! The film: integer sums, so that the picture does not depend on who delivered what first.
//!
//! A core sends each pixel's radiance as 24:16 sums over its samples. The film adds them up in 128 bits, where all the packets of
//! 2^88 units have room: addition of integers commutes and loses nothing, and so the same units give the same film in any order.
//!
//! A sum that does not fit its packet arrives as the greatest there is ([`wire::SUM_MAX`]). The film adds that, and counts it.

use sha2::{Digest, Sha256};
use wire::SUM_MAX;

use crate::image::picture::Picture;

/// Fraction bits of a sum.
const FRACTION_BITS: i32 = 16;

/// Sums and sample counts of a whole picture, row-major from the top row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u16,
    height: u16,
    exponent: i32,
    sums: Vec<[u128; 3]>,
    counts: Vec<u64>,
    saturated: u64,
}

/// Why a unit's sums were not added. The film is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FilmError {
    /// The run leaves the picture.
    #[error(
        "pixels {first}..{first}+{pixels} lie outside a film of {film}; sender and collector disagree on the picture"
    )]
    Outside {
        /// Row-major index of the run's first pixel.
        first: u32,
        /// Its length.
        pixels: usize,
        /// Pixels of the film.
        film: usize,
    },
}

impl Film {
    /// An empty film.
    pub fn new(width: u16, height: u16) -> Self {
        let pixels = usize::from(width) * usize::from(height);
        Self {
            width,
            height,
            exponent: 0,
            sums: vec![[0; 3]; pixels],
            counts: vec![0; pixels],
            saturated: 0,
        }
    }

    /// The same, whose sums are 2^exponent times the scene's radiance (see `scene::CompiledScene`).
    pub fn with_exponent(self, exponent: i32) -> Self {
        Self { exponent, ..self }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u16, u16) {
        (self.width, self.height)
    }

    /// Adds a run of pixels that begins at row-major index `first`: 24:16 sums over `samples` samples of each.
    pub fn add(&mut self, first: u32, samples: u32, run: &[[u64; 3]]) -> Result<(), FilmError> {
        let outside = FilmError::Outside {
            first,
            pixels: run.len(),
            film: self.counts.len(),
        };
        let start = usize::try_from(first).map_err(|_| outside)?;
        let range = start..start.checked_add(run.len()).ok_or(outside)?;
        let (Some(sums), Some(counts)) = (self.sums.get_mut(range.clone()), self.counts.get_mut(range))
        else {
            return Err(outside);
        };
        for ((sum, count), new) in sums.iter_mut().zip(counts).zip(run) {
            for (sum, &new) in sum.iter_mut().zip(new) {
                *sum += u128::from(new);
                self.saturated += u64::from(new >= SUM_MAX);
            }
            *count += u64::from(samples);
        }
        Ok(())
    }

    /// Samples of all pixels.
    pub fn samples(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Sums that came at the greatest value a packet holds: there the picture is darker than it should be.
    pub fn saturated(&self) -> u64 {
        self.saturated
    }

    /// Pixels without a sample.
    pub fn missing(&self) -> usize {
        self.counts.iter().filter(|&&count| count == 0).count()
    }

    /// Each pixel's mean radiance; a pixel without samples has none.
    pub fn picture(&self) -> Picture {
        let scale = 2f64.powi(-(FRACTION_BITS + self.exponent));
        let pixels = self.sums.iter().zip(&self.counts).map(|(sum, &count)| {
            (count > 0).then(|| sum.map(|component| component as f64 * scale / count as f64))
        });
        Picture::new(self.width, self.height, pixels.collect())
    }

    /// SHA-256, in hexadecimal, over width and height (u32) and then every pixel's three sums (u64) and count (u32), all
    /// little-endian; over all of them in twice the bytes where one needs more.
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(u32::from(self.width).to_le_bytes());
        hash.update(u32::from(self.height).to_le_bytes());
        let fits = self.counts.iter().all(|&count| u32::try_from(count).is_ok())
            && self
                .sums
                .as_flattened()
                .iter()
                .all(|&sum| u64::try_from(sum).is_ok());
        let share = if fits { 2 } else { 1 };
        for (sum, count) in self.sums.iter().zip(&self.counts) {
            for component in sum {
                hash.update(&component.to_le_bytes()[..16 / share]);
            }
            hash.update(&count.to_le_bytes()[..8 / share]);
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(value: u64) -> [[u64; 3]; 1] {
        [[value, 2 * value, 3 * value]]
    }

    #[test]
    fn order_does_not_matter() {
        let runs = [(0, one(5)), (3, one(7)), (0, one(11)), (1, one(13))];
        let (mut forwards, mut backwards) = (Film::new(2, 2), Film::new(2, 2));
        for (first, run) in &runs {
            forwards.add(*first, 4, run).unwrap();
        }
        for (first, run) in runs.iter().rev() {
            backwards.add(*first, 4, run).unwrap();
        }
        assert_eq!(forwards, backwards);
        assert_eq!(forwards.sha256(), backwards.sha256());
        assert_eq!((forwards.samples(), forwards.missing()), (16, 1));
    }

    #[test]
    fn the_hash_is_over_these_bytes() {
        let mut film = Film::new(2, 1);
        film.add(1, 4, &[[0x0001_0000, 2, 0x0100_0000_0000]]).unwrap();
        let bytes: Vec<u8> = [
            &[2, 0, 0, 0, 1, 0, 0, 0][..],
            &[0; 28],
            &[0, 0, 1, 0, 0, 0, 0, 0],
            &[2, 0, 0, 0, 0, 0, 0, 0],
            &[0, 0, 0, 0, 0, 1, 0, 0],
            &[4, 0, 0, 0],
        ]
        .concat();
        let expected: String = Sha256::digest(bytes)
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        assert_eq!(film.sha256(), expected);
        // Counts are part of it: the same sums over other counts are another picture.
        let mut other = Film::new(2, 1);
        other.add(1, 8, &[[0x0001_0000, 2, 0x0100_0000_0000]]).unwrap();
        assert_ne!(other.sha256(), expected);
    }

    #[test]
    fn means_are_sums_over_counts() {
        let mut film = Film::new(2, 1);
        film.add(0, 4, &[[4 << 16, 2 << 16, 1]]).unwrap();
        film.add(0, 4, &[[4 << 16, 2 << 16, 1]]).unwrap();
        let picture = film.picture();
        assert_eq!(picture.pixels(), [Some([1.0, 0.5, 2.0 / 65536.0 / 8.0]), None]);
    }

    #[test]
    fn the_exponent_is_taken_out_again() {
        let mut film = Film::new(1, 1).with_exponent(20);
        film.add(0, 4, &[[4 << 16, 2 << 16, 1 << 16]]).unwrap();
        let unit = 2f64.powi(-20);
        assert_eq!(film.picture().pixels(), [Some([unit, unit / 2.0, unit / 4.0])]);
    }

    /// The published pictures' 20,000 samples in a light of 12, by units of 64: the last one has 32.
    #[test]
    fn twenty_thousand_samples_of_the_light_lose_nothing() {
        let mut film = Film::new(1, 1);
        for pass in 0..20_000u64.div_ceil(64) {
            let samples = (20_000 - 64 * pass).min(64);
            film.add(0, samples as u32, &[[(12 * samples) << FRACTION_BITS; 3]])
                .unwrap();
        }
        assert_eq!(film.sums, [[(12 * 20_000) << FRACTION_BITS; 3]]);
        assert_eq!(film.picture().pixels(), [Some([12.0; 3])]);
        assert_eq!((film.samples(), film.saturated()), (20_000, 0));
    }

    /// As many samples of one pixel as a plan can name and more, each of the most light that fits a packet of four.
    #[test]
    fn four_thousand_million_samples_lose_nothing() {
        let brightest = (SUM_MAX - 1) / 4;
        let (samples, packets) = (1u64 << 32, 1u128 << 30);
        let mut film = Film {
            sums: vec![[packets * u128::from(4 * brightest), 1, 0]],
            counts: vec![samples],
            ..Film::new(1, 1)
        };
        film.add(0, 4, &[[4 * brightest, 1, 0]]).unwrap();
        assert_eq!(film.sums, [[(packets + 1) * u128::from(4 * brightest), 2, 0]]);
        assert_eq!((film.samples(), film.saturated()), (samples + 4, 0));
        let mean = [
            brightest as f64 / 65536.0,
            2.0 / 65536.0 / (samples + 4) as f64,
            0.0,
        ];
        assert_eq!(film.picture().pixels(), [Some(mean)]);
    }

    /// What needs more bytes has a hash over more bytes, and is not taken for what is left of it in fewer.
    #[test]
    fn large_sums_have_a_hash_of_their_own() {
        let film = |sum: u128, count: u64| Film {
            sums: vec![[sum, 0, 0]],
            counts: vec![count],
            ..Film::new(1, 1)
        };
        let small = film(5, 7).sha256();
        assert_ne!(film(5 + (1 << 64), 7).sha256(), small);
        assert_ne!(film(5, 7 + (1 << 32)).sha256(), small);
    }

    #[test]
    fn saturated_sums_are_counted() {
        let mut film = Film::new(2, 1);
        film.add(0, 4, &[[SUM_MAX - 1, SUM_MAX, 0], [SUM_MAX; 3]])
            .unwrap();
        film.add(1, 4, &[[SUM_MAX, 0, 0]]).unwrap();
        assert_eq!(film.saturated(), 5);
        assert_eq!(film.sums[1][0], 2 * u128::from(SUM_MAX));
    }

    #[test]
    fn what_does_not_fit_changes_nothing() {
        let mut film = Film::new(2, 1);
        film.add(0, 4, &[[1; 3], [2; 3]]).unwrap();
        let before = film.clone();
        assert!(matches!(
            film.add(1, 4, &[[0; 3]; 2]),
            Err(FilmError::Outside {
                first: 1,
                pixels: 2,
                film: 2
            })
        ));
        assert!(matches!(
            film.add(u32::MAX, 4, &[[0; 3]]),
            Err(FilmError::Outside { .. })
        ));
        assert_eq!(film, before);
    }
}
