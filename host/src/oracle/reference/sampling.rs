//! Random numbers, in strata, and what is made of them.
//!
//! The samples of a sub-pixel come in batches of a power of two. In each pair of its first dimensions (the filter, and what is
//! decided at the first surfaces) a batch is a (0,2)-net in base 2: every box of so many equal ones into which halving cuts the unit square, tall
//! or wide, has one sample (Sobol' 1967; the digits are scrambled at random, and a sample is anywhere in its finest box). Which
//! sample has which point is shuffled for each pair anew (padding: Pharr, Jakob, Humphreys, "Physically Based Rendering").
//! Batches are independent of each other, so the spread of their means says what noise is left.

use std::f64::consts::{PI, TAU};

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use super::vector::Vector;

/// Surfaces whose decisions are stratified.
const SURFACES: usize = 3;
/// The filter; at each surface one pair for where the path goes on and one for where light is looked for.
const PAIRS: usize = 1 + 2 * SURFACES;
/// The largest batch.
const LARGEST: usize = 256;
/// Whole batches, at least: fewer would not tell their noise.
const FEWEST_BATCHES: u32 = 4;

/// The second dimension of Sobol's sequence, the binary digits of each point; those of the first are the number's own, reversed.
const SOBOL: [u8; LARGEST] = {
    let mut points = [0; LARGEST];
    let mut number = 0;
    while number < LARGEST {
        let (mut digits, mut direction) = (number, 0x80);
        while digits > 0 {
            if digits % 2 == 1 {
                points[number] ^= direction;
            }
            direction ^= direction >> 1;
            digits /= 2;
        }
        number += 1;
    }
    points
};

/// A uniform number in [0, 1). It has 48 bits, so that a cell's number added to it does not round up into the next cell.
fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 16) as f64 * (1.0 / (1u64 << 48) as f64)
}

/// The largest batch of which `samples` are enough whole ones.
pub(super) fn batch_size(samples: u32) -> u32 {
    let fits = |size: &u32| samples.is_multiple_of(*size) && samples / size >= FEWEST_BATCHES;
    let sizes = (1..=LARGEST.ilog2()).rev().map(|bits| 1 << bits);
    sizes.into_iter().find(fits).unwrap_or(1)
}

/// Which point each sample of a batch has, by pair.
pub(super) struct Batch {
    bits: u32,
    order: [[u8; LARGEST]; PAIRS],
    scramble: [[u8; 2]; PAIRS],
}

impl Batch {
    /// A batch of `size` samples, a power of two and at most [`LARGEST`].
    pub(super) fn new(size: u32, random: &mut Xoshiro256PlusPlus) -> Self {
        let mut order = [[0; LARGEST]; PAIRS];
        for order in &mut order {
            let order = &mut order[..size as usize];
            for (number, point) in order.iter_mut().enumerate() {
                *point = number as u8;
            }
            // Fisher's and Yates's shuffle.
            for last in (1..order.len()).rev() {
                let other = uniform(random) * (last + 1) as f64;
                order.swap(last, other as usize);
            }
        }
        let scramble = std::array::from_fn(|_| [0, 8].map(|shift| (random.next_u64() >> shift) as u8));
        Self {
            bits: size.ilog2(),
            order,
            scramble,
        }
    }

    /// Of all samples of a batch the random numbers.
    pub(super) fn draws<'a>(
        &'a self,
        random: &'a mut Xoshiro256PlusPlus,
        mut each: impl FnMut(&mut Draws<'_>),
    ) {
        for sample in 0..1 << self.bits {
            each(&mut Draws {
                stratum: Some((self, sample)),
                random,
            });
        }
    }
}

/// The random numbers of one sample.
pub(super) struct Draws<'a> {
    stratum: Option<(&'a Batch, usize)>,
    random: &'a mut Xoshiro256PlusPlus,
}

impl<'a> Draws<'a> {
    /// Those of no stratum.
    pub(super) fn free(random: &'a mut Xoshiro256PlusPlus) -> Self {
        Self {
            stratum: None,
            random,
        }
    }
}

impl Draws<'_> {
    /// A uniform number in [0, 1), of no stratum.
    pub(super) fn uniform(&mut self) -> f64 {
        uniform(self.random)
    }

    /// A point in the unit square, of no stratum.
    pub(super) fn point(&mut self) -> [f64; 2] {
        [self.uniform(), self.uniform()]
    }

    /// A point in the unit square for the filter.
    pub(super) fn of_pixel(&mut self) -> [f64; 2] {
        self.pair(0)
    }

    /// A point in the unit square for where a path goes on from its surface `number`, counted from 1.
    pub(super) fn of_direction(&mut self, number: u32) -> [f64; 2] {
        self.pair(2 * number as usize - 1)
    }

    /// A number in [0, 1) for which way a path takes at its surface `number`.
    pub(super) fn of_choice(&mut self, number: u32) -> f64 {
        self.of_direction(number)[0]
    }

    /// A point in the unit square for where light is looked for from surface `number`.
    pub(super) fn of_light(&mut self, number: u32) -> [f64; 2] {
        self.pair(2 * number as usize)
    }

    fn pair(&mut self, number: usize) -> [f64; 2] {
        let within = self.point();
        let Some((batch, sample)) = self.stratum.filter(|_| number < PAIRS) else {
            return within;
        };
        let point = batch.order[number][sample];
        let [x, y] = batch.scramble[number];
        let digits = [point.reverse_bits() ^ x, SOBOL[usize::from(point)] ^ y];
        let cell = digits.map(|digits| f64::from(u32::from(digits) >> (u8::BITS - batch.bits)));
        let cells = f64::from(1 << batch.bits);
        [(cell[0] + within[0]) / cells, (cell[1] + within[1]) / cells]
    }
}

/// A place of the tent filter over (-1, 1).
pub(super) fn tent(uniform: f64) -> f64 {
    let r = 2.0 * uniform;
    if r < 1.0 {
        r.sqrt() - 1.0
    } else {
        1.0 - (2.0 - r).sqrt()
    }
}

/// A direction around `normal` with the density of [`cosine_density`].
pub(super) fn cosine_weighted(normal: Vector, [square, around]: [f64; 2]) -> Vector {
    direction(normal, (1.0 - square).sqrt(), square.sqrt(), around)
}

/// Density of [`cosine_weighted`] by solid angle, at this cosine to the normal.
pub(super) fn cosine_density(cosine: f64) -> f64 {
    cosine / PI
}

/// A direction no further from `axis` than where one minus the cosine is `height`, uniform by solid angle (Shirley and Wang,
/// "Monte Carlo techniques for direct lighting calculations", 1996, for the cone in which a sphere is seen).
pub(super) fn within_cone(axis: Vector, height: f64, [share, around]: [f64; 2]) -> Vector {
    let below = height * share;
    // The sine from the height itself: a cosine near 1 has lost it.
    direction(axis, 1.0 - below, (below * (2.0 - below)).sqrt(), around)
}

/// The height of [`within_cone`] for a cone whose half angle has a sine of this square: 1 - cos = sin^2 / (1 + cos).
pub(super) fn height_of_cone(sine_square: f64) -> f64 {
    sine_square / (1.0 + (1.0 - sine_square).max(0.0).sqrt())
}

/// The unit vector at an angle to `axis` of this cosine and sine, `turn` of a full turn around it.
fn direction(axis: Vector, cosine: f64, sine: f64, turn: f64) -> Vector {
    let [tangent, bitangent] = axis.tangents();
    let (across, up) = sine_and_cosine(turn);
    tangent * (up * sine) + bitangent * (across * sine) + axis * cosine
}

/// Sine and cosine of `turns` full turns, from -1 to 1: by Taylor's series around the nearest quarter, to the last place but one.
///
/// The standard library's take a fifth of the time of all else that a path does.
pub(super) fn sine_and_cosine(turns: f64) -> (f64, f64) {
    // Casts cut off.
    let quarter = (4.0 * turns + 0.5f64.copysign(turns)) as i32;
    let angle = (turns - f64::from(quarter) / 4.0) * TAU;
    let square = angle * angle;
    let series = |coefficients: [f64; 8]| {
        coefficients
            .into_iter()
            .rfold(0.0, |sum, next| sum * square + next)
    };
    let sine = angle * series(const { inverse_factorials(1) });
    let cosine = series(const { inverse_factorials(0) });
    let (sine, cosine) = if quarter % 2 == 0 {
        (sine, cosine)
    } else {
        (cosine, -sine)
    };
    if quarter & 2 == 0 {
        (sine, cosine)
    } else {
        (-sine, -cosine)
    }
}

/// 1 / n! of every second `n` from `first` on, with alternating signs.
const fn inverse_factorials(first: u32) -> [f64; 8] {
    let mut coefficients = [0.0; 8];
    let (mut coefficient, mut number) = (1.0, first);
    let mut index = 0;
    while index < coefficients.len() {
        coefficients[index] = coefficient;
        coefficient /= -(((number + 1) * (number + 2)) as f64);
        number += 2;
        index += 1;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;

    #[test]
    fn every_box_of_a_batch_has_one_sample_of_every_pair() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        for bits in 0..=8 {
            let batch = Batch::new(1 << bits, &mut random);
            let mut points = Vec::new();
            batch.draws(&mut random, |draws| {
                points.push([draws.of_pixel(), draws.of_direction(1), draws.of_light(3)]);
            });
            for pair in 0..3 {
                for wide in 0..=bits {
                    let (columns, rows) = (1 << wide, 1 << (bits - wide));
                    let mut boxes: Vec<usize> = points
                        .iter()
                        .map(|point| {
                            let [x, y] = point[pair];
                            (x * f64::from(columns)) as usize
                                + columns as usize * (y * f64::from(rows)) as usize
                        })
                        .collect();
                    boxes.sort_unstable();
                    assert!(
                        boxes.into_iter().eq(0..1 << bits),
                        "{bits} bits, {columns} columns"
                    );
                }
            }
        }
    }

    #[test]
    fn a_batch_is_as_large_as_four_of_them_allow() {
        let sizes = [1, 3, 7, 8, 24, 64, 96, 256, 1024, 4096].map(batch_size);
        assert_eq!(sizes, [1, 1, 1, 2, 4, 16, 16, 64, 256, 256]);
    }

    #[test]
    fn sines_and_cosines_are_those_of_the_standard_library() {
        for number in -1000..=1000 {
            let turns = f64::from(number) / 1000.0;
            let (sine, cosine) = sine_and_cosine(turns);
            let (expected_sine, expected_cosine) = (TAU * turns).sin_cos();
            // Of a full turn the product with two pi is rounded to 4e-16.
            assert!((sine - expected_sine).abs() < 2e-15, "{turns}: {sine}");
            assert!((cosine - expected_cosine).abs() < 2e-15, "{turns}: {cosine}");
        }
    }
}
