//! The comparison pixel by pixel.

use super::Pair;
use super::tiles::sidak_threshold;

/// Welch's test of every channel of every pixel, all together: a z-score each (normal for the many samples of a pixel), and Šidák's
/// threshold, so that a picture without error fails once in a hundred times at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Tests made: channels that have any noise.
    pub tested: usize,
    /// What a z-score must stay within.
    pub threshold_z: f64,
    /// The z-score of the largest magnitude, with its sign.
    pub max_z: f64,
    /// Tests that noise does not explain.
    pub failed: Vec<PixelTest>,
}

/// One channel of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTest {
    /// Its column.
    pub x: u16,
    /// Its row, from the top.
    pub y: u16,
    /// Red, green or blue.
    pub channel: usize,
    /// By how many standard errors the two pictures differ.
    pub z: f64,
}

/// Tests all pixels of pictures of this width.
pub(super) fn test(pixels: &[Option<Pair>], width: u16) -> Pixels {
    let width = usize::from(width);
    let tests: Vec<PixelTest> = pixels
        .iter()
        .enumerate()
        .filter_map(|(index, pair)| Some((index, pair.as_ref()?)))
        .flat_map(|(index, pair)| {
            (0..3).map(move |channel| PixelTest {
                x: (index % width) as u16,
                y: (index / width) as u16,
                channel,
                z: pair.difference(channel) / pair.variance[channel].sqrt(),
            })
        })
        .filter(|test| test.z.is_finite())
        .collect();
    let threshold_z = sidak_threshold(tests.len());
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    Pixels {
        tested: tests.len(),
        threshold_z,
        max_z: tests.iter().map(|test| test.z).fold(0.0, larger),
        failed: tests
            .into_iter()
            .filter(|test| test.z.abs() > threshold_z)
            .collect(),
    }
}
