//! The comparison by tiles.

use statrs::distribution::{ContinuousCDF, Normal};

use super::Pair;

/// Side of a tile in pixels; at the right and bottom edges a tile is what is left.
pub const SIDE: u16 = 8;

/// How often the tile test may fail a picture that has no error: one picture in a hundred.
pub const FALSE_ALARM: f64 = 0.01;

/// A tile whose reference is darker than this share of the picture's mean is measured against that share instead: a bias
/// relative to next to nothing says nothing.
const DIMMEST: f64 = 0.01;

/// What cores round the light of a scene by, as a share of it: an emission of 1/8, in 16:16, by 2^-14 of itself at most. A tile of
/// nothing but sky has no noise that would hide it, and so much is no error of the picture.
const ROUNDING: f64 = 1.0 / 16384.0;

/// Every tile against its own confidence interval.
///
/// A test is one channel of one tile: the difference summed over its pixels, less what cores round light by, over the root of the summed variance. With
/// so many tests some are extreme by chance, so the threshold is Šidák's: all tests together raise a false alarm in one
/// picture of a hundred ([`FALSE_ALARM`]). The channels of a tile are not independent, which makes it rarer still.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiles {
    /// Every tile that has a pixel on both sides, row-major.
    pub tiles: Vec<Tile>,
    /// The z-score, up or down, that a test must stay within.
    pub threshold_z: f64,
}

/// One tile's difference from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Column of its left pixels.
    pub x: u16,
    /// Row of its top pixels.
    pub y: u16,
    /// Bias over all channels, relative to the tile's own reference (or 1 % of the picture's mean, if that is more).
    /// Noise and all: read it beside `bias_noise`.
    pub bias: f64,
    /// Upper bound of the standard error of `bias`.
    pub bias_noise: f64,
    /// z-scores of red, green, blue; infinite where there is a difference without any noise.
    pub z: [f64; 3],
}

impl Tile {
    /// The z-score of the largest magnitude, with its sign.
    pub fn max_z(&self) -> f64 {
        self.z.into_iter().fold(0.0, larger)
    }
}

impl Tiles {
    /// Number of tests: three for every tile.
    pub fn tested(&self) -> usize {
        3 * self.tiles.len()
    }

    /// The z-score of the largest magnitude, with its sign.
    pub fn max_z(&self) -> f64 {
        self.tiles.iter().map(Tile::max_z).fold(0.0, larger)
    }

    /// The tile whose bias has the largest magnitude.
    pub fn most_biased(&self) -> Option<&Tile> {
        self.tiles
            .iter()
            .max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))
    }

    /// Tests that noise does not explain: the tile and the channel.
    pub fn failed(&self) -> impl Iterator<Item = (&Tile, usize)> {
        let tests = self
            .tiles
            .iter()
            .flat_map(|tile| [(tile, 0), (tile, 1), (tile, 2)]);
        tests.filter(|(tile, channel)| tile.z[*channel].abs() > self.threshold_z)
    }
}

fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// Sums over the pixels of one tile.
#[derive(Clone, Copy, Default)]
struct Sums {
    pixels: usize,
    difference: [f64; 3],
    reference: [f64; 3],
    variance: [f64; 3],
}

impl Sums {
    fn z_score(&self, channel: usize) -> f64 {
        let difference = self.difference[channel];
        let beyond = difference.abs() - ROUNDING * self.reference[channel];
        if beyond > 0.0 {
            beyond.copysign(difference) / self.variance[channel].sqrt()
        } else {
            0.0
        }
    }
}

/// Tests the tiles of a picture of `size`, whose reference has the mean `level`.
pub(super) fn test(pixels: &[Option<Pair>], size: (u16, u16), level: f64) -> Tiles {
    let places: Vec<(u16, u16)> = (0..size.1)
        .step_by(usize::from(SIDE))
        .flat_map(|y| (0..size.0).step_by(usize::from(SIDE)).map(move |x| (x, y)))
        .collect();
    let tiles: Vec<Tile> = places
        .into_iter()
        .map(|(x, y)| (x, y, sums(pixels, size, x, y)))
        .filter(|(_, _, sums)| sums.pixels > 0)
        .map(|(x, y, sums)| {
            let (bias, bias_noise) = bias(&sums, level);
            let z = [0, 1, 2].map(|channel| sums.z_score(channel));
            Tile {
                x,
                y,
                bias,
                bias_noise,
                z,
            }
        })
        .collect();
    let threshold_z = sidak_threshold(3 * tiles.len());
    Tiles { tiles, threshold_z }
}

fn sums(pixels: &[Option<Pair>], (width, height): (u16, u16), x: u16, y: u16) -> Sums {
    let mut sums = Sums::default();
    for row in y..y.saturating_add(SIDE).min(height) {
        for column in x..x.saturating_add(SIDE).min(width) {
            let index = usize::from(row) * usize::from(width) + usize::from(column);
            let Some(pair) = &pixels[index] else { continue };
            sums.pixels += 1;
            for channel in 0..3 {
                sums.difference[channel] += pair.difference(channel);
                sums.reference[channel] += pair.reference[channel];
                sums.variance[channel] += pair.variance[channel];
            }
        }
    }
    sums
}

/// A tile's relative bias over all channels, and the most its standard error can be.
fn bias(sums: &Sums, level: f64) -> (f64, f64) {
    let difference: f64 = sums.difference.iter().sum();
    let noise: f64 = sums.variance.iter().map(|variance| variance.sqrt()).sum();
    let measure = sums
        .reference
        .iter()
        .sum::<f64>()
        .max(DIMMEST * level * (3 * sums.pixels) as f64);
    if measure > 0.0 {
        (difference / measure, noise / measure)
    } else {
        (0.0, 0.0)
    }
}

/// The z-score within which all of `tests` independent tests stay with probability 1 - [`FALSE_ALARM`].
pub(crate) fn sidak_threshold(tests: usize) -> f64 {
    let one = 1.0 - (1.0 - FALSE_ALARM).powf(1.0 / tests.max(1) as f64);
    Normal::standard().inverse_cdf(1.0 - one / 2.0)
}
