//! Equidistribution and serial correlation of the numbers a tracer takes.
//!
//! **Equidistribution**: numbers, pairs and triples of numbers that follow each other are counted in 4,096 equal cells of
//! the unit interval, square or cube, and the counts go through a chi-squared test. Counts that are too even are as
//! suspicious as counts that are too uneven. **Serial correlation**: of each number with the one a lag behind it, as a
//! normal z-score.
//!
//! A test that passes says little if it could not have failed: [`Power`] says what would have been found.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::streams::DRAWS;

/// Bits of a cell's number: 4,096 cells, which is 12, 6 or 4 bits of each coordinate.
const CELL_BITS: u32 = 12;
/// A p-value below this, or above 1 less this, is a failure.
pub const FALSE_ALARM: f64 = 1e-6;
/// How likely a deviation of the size given by [`Power`] is to be found.
pub const SURE: f64 = 0.9;
/// Neighbours, the bounces and samples after them, the same place in the next unit, and the published period.
const LAGS: [usize; 12] = [1, 2, 3, 4, 5, 6, 7, 8, 16, 64, DRAWS, 65_536];

/// What the tests say of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Uniformity {
    /// Numbers that were tested.
    pub numbers: usize,
    /// p-values of equidistribution in 1, 2 and 3 dimensions: how likely counts as uneven as these or more so are.
    pub equidistribution: [f64; 3],
    /// The largest serial correlation, in standard deviations.
    pub correlation_z: f64,
    /// The lag it has.
    pub correlation_lag: usize,
    /// How likely any of the lags' correlations is to be that large (Z. Šidák's correction).
    pub correlation: f64,
}

impl Uniformity {
    /// Tests a sequence.
    ///
    /// # Panics
    /// If the sequence is not longer than the longest lag.
    pub fn of(numbers: &[u32]) -> Self {
        let (lag, z) = LAGS
            .map(|lag| (lag, correlation(numbers, lag)))
            .into_iter()
            .max_by(|one, other| one.1.abs().total_cmp(&other.1.abs()))
            .expect("there are lags");
        let p = 2.0 * Normal::standard().sf(z.abs());
        Self {
            numbers: numbers.len(),
            equidistribution: [1, 2, 3].map(|dimensions| equidistribution(numbers, dimensions)),
            correlation_z: z,
            correlation_lag: lag,
            correlation: -(LAGS.len() as f64 * (-p).ln_1p()).exp_m1(),
        }
    }

    /// Whether each test is passed: the three of equidistribution, and correlation.
    pub fn passed(&self) -> [bool; 4] {
        let [one, two, three] = self
            .equidistribution
            .map(|p| (FALSE_ALARM..=1.0 - FALSE_ALARM).contains(&p));
        [one, two, three, self.correlation >= FALSE_ALARM]
    }
}

/// The p-value of the counts of successive groups of numbers.
fn equidistribution(numbers: &[u32], dimensions: u32) -> f64 {
    let bits = CELL_BITS / dimensions;
    let mut counts = vec![0u32; 1 << CELL_BITS];
    let groups = numbers.chunks_exact(dimensions as usize);
    let expected = groups.len() as f64 / counts.len() as f64;
    for group in groups {
        let cell = group
            .iter()
            .fold(0, |cell, number| cell << bits | number >> (32 - bits));
        counts[cell as usize] += 1;
    }
    let unevenness = counts
        .iter()
        .map(|&count| (f64::from(count) - expected).powi(2) / expected)
        .sum();
    cells().sf(unevenness)
}

/// The distribution of the unevenness of true random numbers.
fn cells() -> ChiSquared {
    ChiSquared::new(f64::from((1u32 << CELL_BITS) - 1)).expect("a positive number of degrees of freedom")
}

/// Correlation with the number `lag` places on, times the root of how many pairs there are.
fn correlation(numbers: &[u32], lag: usize) -> f64 {
    let centred = |number: u32| (f64::from(number) + 0.5) / 4_294_967_296.0 - 0.5;
    let pairs = numbers.iter().zip(&numbers[lag..]);
    let sum: f64 = pairs.map(|(&one, &other)| centred(one) * centred(other)).sum();
    // A fraction's variance is 1/12.
    12.0 * sum / ((numbers.len() - lag) as f64).sqrt()
}

/// What [`Uniformity`] would find in most cases ([`SURE`]), of a given length of sequence.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Power {
    /// Root mean square of the cells' relative errors, in 1, 2 and 3 dimensions.
    pub unevenness: [f64; 3],
    /// A correlation.
    pub correlation: f64,
}

impl Power {
    /// The power of the tests on so many numbers.
    pub fn of(numbers: usize) -> Self {
        let beyond = Normal::standard().inverse_cdf(SURE);
        let freedom = f64::from((1u32 << CELL_BITS) - 1);
        let critical = cells().inverse_cdf(1.0 - FALSE_ALARM);
        // The non-central distribution's mean must lie `beyond` of its standard deviations above the critical value.
        let mut excess = critical - freedom;
        for _ in 0..30 {
            excess = critical - freedom + beyond * (2.0 * (freedom + 2.0 * excess)).sqrt();
        }
        let level = FALSE_ALARM / 2.0 / LAGS.len() as f64;
        Self {
            unevenness: [1.0, 2.0, 3.0].map(|dimensions| (excess * dimensions / numbers as f64).sqrt()),
            correlation: (Normal::standard().inverse_cdf(1.0 - level) + beyond) / (numbers as f64).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    use tracer::random::{FullState, LowBits};

    use super::*;
    use crate::bench::generators::streams::{first_of_units, unit_after_unit};

    const NUMBERS: usize = 1 << 20;

    fn test(numbers: impl Iterator<Item = u32>, how_many: usize) -> Uniformity {
        Uniformity::of(&numbers.take(how_many).collect::<Vec<_>>())
    }

    #[test]
    fn the_full_state_passes_within_units_and_across() {
        for seed in [1, 2, u64::MAX] {
            let within = test(unit_after_unit::<FullState>(seed), NUMBERS);
            let across = test(first_of_units::<FullState>(seed), NUMBERS);
            assert_eq!(within.passed(), [true; 4], "{within:?}");
            assert_eq!(across.passed(), [true; 4], "{across:?}");
        }
    }

    #[test]
    fn the_low_bits_fail_every_test() {
        let within = test(unit_after_unit::<LowBits>(1), 4 * NUMBERS);
        let across = test(first_of_units::<LowBits>(1), 4 * NUMBERS);
        assert_eq!(within.passed(), [false; 4], "{within:?}");
        assert_eq!(across.passed(), [false; 4], "{across:?}");
    }

    /// The tests find what they claim to find, and not much less.
    #[test]
    fn power_is_as_stated() {
        let power = Power::of(NUMBERS);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut numbers: Vec<u32> = (0..NUMBERS).map(|_| random.next_u32()).collect();
        assert_eq!(Uniformity::of(&numbers).passed(), [true; 4]);
        // Half of the cells lose a share of what they get to the other half: an error of the same size in each.
        for share in [2.0 * power.unevenness[0], 0.3 * power.unevenness[0]] {
            let mut biased = numbers.clone();
            for number in &mut biased {
                if *number >> 20 & 1 == 0 && f64::from(random.next_u32()) < share * 2f64.powi(32) {
                    *number |= 1 << 20;
                }
            }
            assert_eq!(Uniformity::of(&biased).passed()[0], share < power.unevenness[0]);
        }
        // A share of the numbers repeats the one before: a correlation of that share.
        for at in 1..NUMBERS {
            if f64::from(random.next_u32()) < 2.0 * power.correlation * 2f64.powi(32) {
                numbers[at] = numbers[at - 1];
            }
        }
        assert!(!Uniformity::of(&numbers).passed()[3]);
    }
}
