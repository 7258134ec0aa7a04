//! The spectral test: how close together the planes are on which a generator's points lie.
//!
//! D. Knuth, The Art of Computer Programming, vol. 2, 3.3.4, calls the most powerful test there is. `nu_t` is the length
//! of the shortest vector of the dual lattice in `t` dimensions, and planes are at most `1 / nu_t` apart. No lattice of
//! `m` points can do better than `nu_t = sqrt(gamma_t) m^(1/t)` with Hermite's constant `gamma_t`; the share of that which
//! a generator reaches is the figure of merit `S_t` (P. L'Ecuyer, "Tables of linear congruential generators of different
//! sizes and good lattice structure", 1999).
//!
//! The test is of a whole period, so it is a proof and needs no numbers drawn. It also judges numbers that are `k` steps
//! apart, with `a^k` for the multiplier: the first numbers of the units' streams are such.

use num_bigint::BigInt;
use num_traits::ToPrimitive;

use super::lattice;

/// Dimensions that are judged: 2 to 6.
pub const DIMENSIONS: std::ops::RangeInclusive<usize> = 2..=6;

/// Hermite's constants to the power of their dimension, for 2 to 6.
const HERMITE: [f64; 5] = [4.0 / 3.0, 2.0, 4.0, 8.0, 64.0 / 3.0];

/// What the test says of one generator, for each of [`DIMENSIONS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// `nu_t^2`, exactly.
    pub squares: Vec<BigInt>,
    /// `S_t`, above 0 and at most 1.
    pub merits: Vec<f64>,
}

impl Spectrum {
    /// The spectrum of the full-period generator `x -> a x + c mod 2^bits`, whatever its odd `c`.
    ///
    /// # Panics
    /// If `bits` is not 2 to 64.
    pub fn of(multiplier: u64, bits: u32) -> Self {
        assert!((2..=64).contains(&bits), "a modulus of 2^{bits}");
        Self::modulo(multiplier, 1 << bits)
    }

    /// The same for any modulus up to 2^64.
    pub fn modulo(multiplier: u64, modulus: u128) -> Self {
        let squares = lattice::shortest_squares(multiplier, modulus, *DIMENSIONS.end());
        let merits = DIMENSIONS
            .zip(&squares)
            .map(|(dimension, square)| merit(dimension, square, modulus));
        Self {
            merits: merits.collect(),
            squares,
        }
    }

    /// `S_2` alone, which is quicker.
    ///
    /// # Panics
    /// If `bits` is not 2 to 64.
    pub fn of_pairs(multiplier: u64, bits: u32) -> f64 {
        assert!((2..=64).contains(&bits), "a modulus of 2^{bits}");
        let modulus = 1 << bits;
        merit(2, &lattice::shortest_squares(multiplier, modulus, 2)[0], modulus)
    }
}

/// `S_t`.
fn merit(dimension: usize, square: &BigInt, modulus: u128) -> f64 {
    let power = 1.0 / dimension as f64;
    let best = HERMITE[dimension - DIMENSIONS.start()].powf(0.5 * power) * (modulus as f64).powf(power);
    square.to_f64().unwrap_or(f64::INFINITY).sqrt() / best
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn squares(multiplier: u64, modulus: u128) -> Vec<u64> {
        let found = Spectrum::modulo(multiplier, modulus).squares;
        found
            .iter()
            .map(|square| square.to_u64().expect("it fits"))
            .collect()
    }

    /// Knuth's table 1 in 3.3.4.
    #[test]
    fn figures_are_knuths() {
        assert_eq!(
            squares(65_539, 1 << 29),
            [536_936_458, 118, 116, 116, 116],
            "RANDU"
        );
        assert_eq!(
            squares(3_141_592_621, 10_000_000_000),
            [4_577_114_792, 1_034_718, 62_454, 1_776, 542]
        );
        assert_eq!(
            squares(1_664_525, 1 << 32),
            [4_938_916_874, 2_322_494, 63_712, 4_092, 1_038]
        );
    }

    /// The multiplier of the LXM generators, with the figures published for it.
    #[test]
    fn merits_are_steele_and_vignas() {
        let found = Spectrum::of(0xd134_2543_de82_ef95, 64).merits;
        for (found, published) in found
            .iter()
            .zip([0.958_602, 0.937_479, 0.870_757, 0.822_326, 0.820_405])
        {
            assert!((found - published).abs() < 1e-6, "{found} is not {published}");
        }
    }

    /// All vectors of a cube of side `2 reach + 1` that are in the dual lattice.
    fn by_trial(multiplier: u64, modulus: u64, dimension: u32, reach: i64) -> i64 {
        let side = 2 * reach + 1;
        let vectors = (0..side.pow(dimension)).filter_map(|code| {
            let (mut rest, mut power, mut sum, mut square) = (code, 1, 0, 0);
            for _ in 0..dimension {
                let component = rest % side - reach;
                sum = (sum + component * power).rem_euclid(modulus as i64);
                power = power * multiplier as i64 % modulus as i64;
                square += component * component;
                rest /= side;
            }
            (sum == 0 && square > 0).then_some(square)
        });
        vectors.min().expect("(m, 0, 0) at the least")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn small_lattices_by_trial(modulus in 2u64..60, multiplier in 1u64..60) {
            let found = squares(multiplier % modulus, modulus.into());
            // By Hermite's constant none is longer, and so no component is.
            for (dimension, reach) in [(2, 8), (3, 4), (4, 3), (5, 2), (6, 2)] {
                let trial = by_trial(multiplier % modulus, modulus, dimension, reach);
                prop_assert_eq!(found[dimension as usize - 2] as i64, trial);
            }
        }

        #[test]
        fn merits_are_shares(multiplier: u64) {
            for merit in Spectrum::of(multiplier | 1, 64).merits {
                prop_assert!(merit > 0.0 && merit <= 1.0 + 1e-9, "{}", merit);
            }
        }
    }
}
