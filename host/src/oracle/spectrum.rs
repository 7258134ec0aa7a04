//! Whether what a picture is off by has a structure: its power over spatial frequencies.
//!
//! Of noise whose pixels know nothing of each other the expected power is 1 at every frequency. A pattern that the eye would see, lines, a grid,
//! blotches, has more at its own.

use std::f64::consts::TAU;

use statrs::distribution::{ContinuousCDF, Gamma};

/// Power of the errors of several pictures of one size, each pixel in units of its own standard deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    width: usize,
    height: usize,
    /// The mean over pictures by frequency, in row-major order; the first is frequency 0.
    power: Vec<f64>,
    pictures: usize,
}

/// The chance by which white noise has a frequency that is called strong.
const FALSE_ALARM: f64 = 0.01;

impl Spectrum {
    /// Of independent pictures of the same, in row-major order; none of fewer than two, or where a picture has another number of pixels.
    pub fn of(width: usize, height: usize, pictures: &[Vec<f64>]) -> Option<Self> {
        let is_whole = |picture: &Vec<f64>| picture.len() == width * height;
        if pictures.len() < 2 || !pictures.iter().all(is_whole) {
            return None;
        }
        let mut power = vec![0.0; width * height];
        for error in whitened(pictures) {
            for (sum, value) in power.iter_mut().zip(powers(width, height, &error)) {
                *sum += value / pictures.len() as f64;
            }
        }
        Some(Self {
            width,
            height,
            power,
            pictures: pictures.len(),
        })
    }

    /// Power over frequency, the mean over all directions: cycles a pixel, in rings as wide as the lowest frequency of the narrower side.
    pub fn radial(&self) -> Vec<(f64, f64)> {
        let ring = 1.0 / self.width.min(self.height) as f64;
        let mut rings: Vec<(f64, f64, f64)> = Vec::new();
        for (index, power) in self.power.iter().enumerate().skip(1) {
            let frequency = self.frequency(index);
            let place = (frequency / ring).round() as usize;
            if rings.len() <= place {
                rings.resize(place + 1, (0.0, 0.0, 0.0));
            }
            let (frequencies, powers, count) = rings[place];
            rings[place] = (frequencies + frequency, powers + power, count + 1.0);
        }
        rings.retain(|(.., count)| *count > 0.0);
        rings
            .into_iter()
            .map(|(frequencies, powers, count)| (frequencies / count, powers / count))
            .collect()
    }

    /// The power of the strongest frequency, and what white noise exceeds once in a hundred times.
    pub fn strongest(&self) -> (f64, f64) {
        let strongest = self.power[1..].iter().copied().fold(0.0, f64::max);
        // Of a real picture half of the frequencies say all; a mean over pictures of powers that are exponential is a gamma variate.
        let frequencies = (self.power.len() / 2) as f64;
        let pictures = self.pictures as f64;
        let quantile = (1.0 - FALSE_ALARM).powf(1.0 / frequencies);
        let threshold = Gamma::new(pictures, pictures).map_or(f64::NAN, |gamma| gamma.inverse_cdf(quantile));
        (strongest, threshold)
    }

    /// Powers with frequency 0 in the middle, as one draws them.
    pub fn centred(&self) -> Vec<f64> {
        let (width, height) = (self.width, self.height);
        let at = |x: usize, y: usize| {
            let (x, y) = (
                (x + width - width / 2) % width,
                (y + height - height / 2) % height,
            );
            self.power[y * width + x]
        };
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| at(x, y))
            .collect()
    }

    /// In cycles a pixel.
    fn frequency(&self, index: usize) -> f64 {
        let one = |place: usize, size: usize| place.min(size - place) as f64 / size as f64;
        one(index % self.width, self.width).hypot(one(index / self.width, self.height))
    }
}

/// Each picture less the mean of all, over the standard deviation: pixel by pixel. Pixels without noise are 0.
fn whitened(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = pictures.len() as f64;
    let mut errors = pictures.to_vec();
    for pixel in 0..pictures[0].len() {
        let values = || pictures.iter().map(move |picture| picture[pixel]);
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        for error in &mut errors {
            let off = error[pixel] - mean;
            error[pixel] = if variance > 0.0 {
                off / variance.sqrt()
            } else {
                0.0
            };
        }
    }
    errors
}

/// The squared magnitude of a picture's discrete Fourier transform, over its pixels: first along rows, then along columns.
fn powers(width: usize, height: usize, picture: &[f64]) -> Vec<f64> {
    let rows: Vec<Vec<[f64; 2]>> = picture
        .chunks(width)
        .map(|row| transformed(&row.iter().map(|&value| [value, 0.0]).collect::<Vec<_>>()))
        .collect();
    let mut powers = vec![0.0; width * height];
    for x in 0..width {
        let column: Vec<[f64; 2]> = rows.iter().map(|row| row[x]).collect();
        for (y, [re, im]) in transformed(&column).into_iter().enumerate() {
            powers[y * width + x] = (re * re + im * im) / (width * height) as f64;
        }
    }
    powers
}

/// By the definition: lines are short, and any length will do.
fn transformed(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let length = line.len();
    let turns: Vec<[f64; 2]> = (0..length)
        .map(|place| (-TAU * place as f64 / length as f64).sin_cos())
        .map(|(sine, cosine)| [cosine, sine])
        .collect();
    (0..length)
        .map(|frequency| {
            line.iter()
                .enumerate()
                .fold([0.0, 0.0], |[re, im], (place, [a, b])| {
                    let [cosine, sine] = turns[frequency * place % length];
                    [re + a * cosine - b * sine, im + a * sine + b * cosine]
                })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::Xoshiro256StarStar;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    const SIZE: [usize; 2] = [24, 18];

    /// Pictures of noise that grows along each row, and of what is added to it.
    fn pictures(pattern: impl Fn(usize, usize, f64) -> f64) -> Vec<Vec<f64>> {
        let mut random = Xoshiro256StarStar::seed_from_u64(7);
        let mut next = move || random.next_u64() as f64 / 2f64.powi(64) - 0.5;
        (0..32)
            .map(|_| {
                let phase = next();
                let place = |index: usize| (index % SIZE[0], index / SIZE[0]);
                (0..SIZE[0] * SIZE[1])
                    .map(place)
                    .map(|(x, y)| 3.0 + next() * (1.0 + x as f64) + pattern(x, y, phase) * (1.0 + x as f64))
                    .collect()
            })
            .collect()
    }

    #[test]
    fn white_noise_is_flat() {
        let found = Spectrum::of(SIZE[0], SIZE[1], &pictures(|_, _, _| 0.0)).unwrap();
        let (strongest, threshold) = found.strongest();
        assert!(strongest < threshold, "{strongest} {threshold}");
        for (frequency, power) in found.radial() {
            assert!((power - 1.0).abs() < 0.25, "{frequency}: {power}");
        }
        let mean = found.centred().iter().sum::<f64>() / found.centred().len() as f64;
        assert!((mean - 1.0).abs() < 1e-9, "by Parseval's theorem: {mean}");
    }

    /// Stripes of a tenth of the noise's deviation, at a frequency of 4 in 24 pixels, which move from picture to picture.
    #[test]
    fn faint_stripes_are_seen() {
        let stripes = |x: usize, _: usize, phase: f64| 0.1 * (TAU * (4.0 * x as f64 / 24.0 + phase)).cos();
        let found = Spectrum::of(SIZE[0], SIZE[1], &pictures(stripes)).unwrap();
        let (strongest, threshold) = found.strongest();
        assert!(strongest > 1.5 * threshold, "{strongest} {threshold}");
        let centred = found.centred();
        let middle = SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2;
        assert_eq!(centred[middle + 4], strongest);
    }

    #[test]
    fn one_picture_has_no_noise_to_tell() {
        assert_eq!(Spectrum::of(2, 1, &[vec![1.0, 2.0]]), None);
        assert_eq!(Spectrum::of(2, 1, &[vec![1.0, 2.0], vec![1.0]]), None);
    }
}
