//! Whether two pictures are the same within a bound, and not only not known to differ.
//!
//! Fixed point is off from double precision, truly, so a test for a difference only asks for enough samples. What is asked here is
//! whether the difference is too small to matter, by two one-sided tests (D. J. Schuirmann, 1987): a mean passes where it is inside
//! its bound, on either side, by as many standard errors as leave a picture that lies *on* its bound a chance of
//! [`FALSE_PASS`]. All tests must pass, so that chance holds for the picture as a whole, however many tests there are (an
//! intersection-union test). That a picture without any error fails is what grows with their number:
//! [`Equivalence::false_alarm`] says how likely that is.
//!
//! The pictures are a path's and its double's with the same random numbers ([`Paired`]), so their noise cancels but for the few paths
//! that part.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::image::picture::Picture;
use crate::oracle::compare::{CompareError, SIDE};
use crate::oracle::lockstep::Paired;

/// How often a picture that is off by its bound may pass: one in a thousand.
pub const FALSE_PASS: f64 = 0.001;

/// The bound of the whole picture's mean, as a share of it. The published epsilon of 0.1 moves the Cornell box' mean by 0.5 %, for which
/// nobody would take it for right: a tenth of that.
pub const PICTURE: f64 = 0.0005;

/// The bound of a tile's mean, on the display: a quarter of a level of 8 bits, which rounding hides.
pub const TILE: f64 = 0.25 / 255.0;

/// One mean within its bound, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// The mean difference, in radiance.
    pub difference: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// What it must stay within.
    pub bound: f64,
}

impl Test {
    /// The p-value: how likely a picture on the bound would come out as near to 0 as this.
    pub fn p_value(&self) -> f64 {
        let inside = self.bound - self.difference.abs();
        if self.standard_error > 0.0 {
            Normal::standard().sf(inside / self.standard_error)
        } else {
            f64::from(u8::from(inside <= 0.0))
        }
    }

    /// Whether it is within its bound.
    pub fn passes(&self) -> bool {
        self.p_value() <= FALSE_PASS
    }

    /// How likely a picture without any error passes.
    pub fn power(&self) -> f64 {
        let normal = Normal::standard();
        let room = self.bound / self.standard_error - normal.inverse_cdf(1.0 - FALSE_PASS);
        if room > 0.0 {
            1.0 - 2.0 * normal.sf(room)
        } else {
            0.0
        }
    }
}

/// One channel of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileTest {
    /// Column of its left pixels.
    pub x: u16,
    /// Row of its top pixels.
    pub y: u16,
    /// Red, green or blue.
    pub channel: usize,
    /// Its mean.
    pub test: Test,
}

/// The verdict on a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Equivalence {
    /// The whole picture, mean of the channels.
    pub picture: Test,
    /// Every tile of 8x8 pixels, by channel.
    pub tiles: Vec<TileTest>,
}

/// Tests whether `picture` is the double's of `paired`, with the noise that the pair's own picture has beside it. All pixels must be
/// there.
pub fn test(picture: &Picture, paired: &Paired) -> Result<Equivalence, CompareError> {
    let double = &paired.double.picture;
    if picture.size() != double.size() {
        return Err(CompareError::Size {
            picture: picture.size(),
            reference: double.size(),
        });
    }
    let both = picture.pixels().iter().zip(double.pixels()).zip(&paired.variance);
    let pixels: Option<Vec<Pixel>> = both
        .map(|((&picture, &double), &variance)| {
            Some(Pixel {
                picture: picture?,
                double: double?,
                variance,
            })
        })
        .collect();
    let missing = |picture: &Picture| picture.pixels().iter().filter(|pixel| pixel.is_none()).count();
    let pixels = pixels.ok_or_else(|| CompareError::Incomplete(missing(picture).max(missing(double))))?;
    let all: Vec<&Pixel> = pixels.iter().collect();
    let channels = [0, 1, 2].map(|channel| Sums::of(&all, channel));
    let picture = Test {
        difference: channels.iter().map(|sums| sums.difference).sum::<f64>() / 3.0,
        // As if the channels' noise were one and the same, of which it is most.
        standard_error: channels.iter().map(|sums| sums.variance.sqrt()).sum::<f64>() / 3.0,
        bound: PICTURE * channels.iter().map(|sums| sums.double).sum::<f64>() / 3.0,
    };
    Ok(Equivalence {
        picture,
        tiles: tiles(double.size(), &pixels, &channels),
    })
}

impl Equivalence {
    /// Whether the picture and all of its tiles are within their bounds.
    pub fn passes(&self) -> bool {
        self.picture.passes() && self.failed().next().is_none()
    }

    /// The tiles that are not.
    pub fn failed(&self) -> impl Iterator<Item = &TileTest> {
        self.tiles.iter().filter(|tile| !tile.test.passes())
    }

    /// How likely a picture without any error fails, at most.
    pub fn false_alarm(&self) -> f64 {
        let tests = self.tiles.iter().map(|tile| &tile.test).chain([&self.picture]);
        tests.map(|test| 1.0 - test.power()).sum::<f64>().min(1.0)
    }

    /// The tile test that comes nearest to its bound, or lies furthest beyond.
    pub fn worst(&self) -> Option<&TileTest> {
        self.tiles
            .iter()
            .max_by(|a, b| a.test.p_value().total_cmp(&b.test.p_value()))
    }
}

#[derive(Clone, Copy)]
struct Pixel {
    picture: [f64; 3],
    double: [f64; 3],
    variance: [f64; 3],
}

/// Means over pixels of one channel, and the variance of the mean difference.
#[derive(Clone, Copy)]
struct Sums {
    double: f64,
    difference: f64,
    variance: f64,
}

impl Sums {
    fn of(pixels: &[&Pixel], channel: usize) -> Self {
        let count = pixels.len() as f64;
        let mean =
            |value: &dyn Fn(&Pixel) -> f64| pixels.iter().map(|pixel| value(pixel)).sum::<f64>() / count;
        Self {
            double: mean(&|pixel| pixel.double[channel]),
            difference: mean(&|pixel| pixel.picture[channel] - pixel.double[channel]),
            variance: mean(&|pixel| pixel.variance[channel]) / count,
        }
    }
}

/// Every tile. One in which no path has parted knows nothing of its noise, so none is taken for less noisy than tiles of its
/// brightness are in the mean: the variance of a pixel's difference over its radiance is the picture's at least.
fn tiles(size: (u16, u16), pixels: &[Pixel], channels: &[Sums; 3]) -> Vec<TileTest> {
    let mut tests = Vec::new();
    for (x, y) in (0..size.1)
        .step_by(SIDE.into())
        .flat_map(|y| (0..size.0).step_by(SIDE.into()).map(move |x| (x, y)))
    {
        let rows = y..y.saturating_add(SIDE).min(size.1);
        let inside: Vec<&Pixel> = rows
            .flat_map(|row| {
                let start = usize::from(row) * usize::from(size.0);
                let columns = usize::from(x)..usize::from(x.saturating_add(SIDE).min(size.0));
                &pixels[start + columns.start..start + columns.end]
            })
            .collect();
        for (channel, all) in channels.iter().enumerate() {
            let sums = Sums::of(&inside, channel);
            let usual = if all.double > 0.0 {
                all.variance * pixels.len() as f64 / inside.len() as f64 * (sums.double / all.double)
            } else {
                0.0
            };
            let test = Test {
                difference: sums.difference,
                standard_error: sums.variance.max(usual).sqrt(),
                bound: radiance_of(TILE, sums.double),
            };
            tests.push(TileTest { x, y, channel, test });
        }
    }
    tests
}

/// The radiance that moves the display by `step` where it shows `radiance`, by the slope there. What is brighter than white is taken
/// at the exposure that makes it white.
fn radiance_of(step: f64, radiance: f64) -> f64 {
    /// Where the transfer function of sRGB stops being straight, and its slope until there.
    const STRAIGHT: (f64, f64) = (0.0031308, 12.92);
    let exposed = radiance.min(1.0);
    let slope = if exposed <= STRAIGHT.0 {
        STRAIGHT.1
    } else {
        1.055 / 2.4 * exposed.powf(1.0 / 2.4 - 1.0)
    };
    step / slope * radiance.max(1.0)
}

#[cfg(test)]
mod tests;
