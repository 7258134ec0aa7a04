//! The judgement on the tracer's two generators.

use std::path::Path;

use serde::Serialize;
use tracer::random::{FullState, LowBits, Random, STRIDE, spread};

use super::dieharder::{self, Battery, DieharderError, Row};
use super::period::{self, Closest, Congruential};
use super::spectral::Spectrum;
use super::streams::{Width, first_of_units, unit_after_unit};
use super::uniformity::Uniformity;

/// The published generator, `fixedmath::random::Lcg32`.
pub const PUBLISHED: Congruential = Congruential {
    multiplier: 1_664_525,
    increment: 1_013_904_223,
    bits: 32,
};

/// Ours, `fixedmath::random::Lcg64`.
pub const OURS: Congruential = Congruential {
    multiplier: 6_364_136_223_846_793_005,
    increment: 1_442_695_040_888_963_407,
    bits: 64,
};

/// Numbers drawn for each test of uniformity.
pub const NUMBERS: usize = 1 << 24;
/// Pairs of streams are judged up to so many ids apart: the units of a large picture.
const NEIGHBOURS: u64 = 4096;
/// Renders with seeds 0, 1, 2, ... are laid on one period: so many, of so many units each.
const RENDERS: u64 = 64;
const UNITS: u64 = 1 << 14;
const SEED: u64 = 1;

/// What is known of a generator as a profile uses it.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// The profile that uses it.
    pub profile: &'static str,
    /// What it takes of each state.
    pub bits_used: &'static str,
    /// Logarithm of the period of what is used.
    pub period_log2: u32,
    /// Hull's and Dobell's conditions hold.
    pub full_period: bool,
    /// `nu_2^2` to `nu_6^2`.
    pub nu_squared: Vec<String>,
    /// `S_2` to `S_6`.
    pub merits: Vec<f64>,
    /// Unit after unit.
    pub within_units: Uniformity,
    /// The first number of each unit.
    pub across_units: Uniformity,
    /// Dieharder's results, where it was asked.
    pub dieharder: Vec<Row>,
}

impl Judgement {
    fn of<R: Random>(
        profile: &'static str,
        bits_used: &'static str,
        generator: Congruential,
        seen_bits: u32,
    ) -> Self {
        let seen = Congruential {
            bits: seen_bits,
            ..generator
        };
        let spectrum = Spectrum::of(seen.leap(1), seen.bits);
        let tested = |numbers: &mut dyn Iterator<Item = u32>| {
            Uniformity::of(&numbers.take(NUMBERS).collect::<Vec<_>>())
        };
        Self {
            profile,
            bits_used,
            period_log2: seen_bits,
            full_period: generator.has_full_period(),
            nu_squared: spectrum.squares.iter().map(ToString::to_string).collect(),
            merits: spectrum.merits,
            within_units: tested(&mut unit_after_unit::<R>(SEED)),
            across_units: tested(&mut first_of_units::<R>(SEED)),
            dieharder: Vec::new(),
        }
    }
}

/// Judges ours and the published one.
pub fn judge() -> [Judgement; 2] {
    [
        Judgement::of::<FullState>("precise", "upper 32 of 64", OURS, 64),
        // Nothing above bit 15 reaches the bits below it: they are a generator of their own.
        Judgement::of::<LowBits>("paper", "lower 16 of 32", PUBLISHED, 16),
    ]
}

/// The tests by which the published use is shown to fail; each takes seconds, the whole battery most of an hour.
const ENOUGH_FOR_LOW_BITS: [u16; 5] = [0, 2, 8, 15, 101];

/// Runs dieharder on both generators, ours through all of its tests, and tells each result as it comes.
///
/// The rows are in the order of [`judge`].
pub fn batteries(program: &Path, mut tell: impl FnMut(&Row)) -> Result<[Vec<Row>; 2], DieharderError> {
    let mut published = Vec::new();
    for number in ENOUGH_FOR_LOW_BITS {
        let numbers = unit_after_unit::<LowBits>(SEED);
        published.extend(dieharder::run(
            program,
            Battery::Only(number),
            numbers,
            Width::Half,
            &mut tell,
        )?);
    }
    let numbers = unit_after_unit::<FullState>(SEED);
    let ours = dieharder::run(program, Battery::All, numbers, Width::Full, &mut tell)?;
    Ok([ours, published])
}

/// How the streams of `precise` lie on their common period.
#[derive(Clone, Debug, Serialize)]
pub struct Streams {
    /// Steps from one unit's start to the next.
    pub stride: u64,
    /// Ids between the two closest of 2^32 streams.
    pub closest_ids: u64,
    /// Steps between them.
    pub closest_steps: u64,
    /// The most that any number of streams up to 2^32 is crowded, see [`Closest::crowding`].
    pub crowding: f64,
    /// `S_2` to `S_6` of the first numbers of successive units.
    pub merits: Vec<f64>,
    /// The smallest `S_2` of the pairs made by two streams side by side.
    pub pair_merit: f64,
    /// How many ids those two are apart.
    pub pair_ids: u64,
    /// How many ids apart streams were looked at.
    pub pairs_up_to: u64,
    /// Renders with successive seeds that were laid on one period.
    pub renders: u64,
    /// Units of each of them.
    pub units: u64,
    /// Steps between the closest two of their streams that have different seeds.
    pub closest_of_renders: u64,
}

/// Judges the layout that the tracer has.
pub fn streams() -> Streams {
    layout(OURS, STRIDE)
}

/// Judges `generator` with streams at `stride`.
///
/// # Panics
/// If the stride is zero.
pub fn layout(generator: Congruential, stride: u64) -> Streams {
    let pairs = period::closest(stride, 1 << 32);
    let Closest { ids, steps } = *pairs.last().expect("two streams make a pair");
    let (pair_ids, pair_merit) = (1..=NEIGHBOURS)
        .map(|apart| {
            (
                apart,
                Spectrum::of_pairs(generator.leap(apart.wrapping_mul(stride)), generator.bits),
            )
        })
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .expect("there are neighbours");
    let starts: Vec<u64> = (0..RENDERS)
        .map(|seed| generator.distance(0, spread(seed)))
        .collect();
    // Steps by an even number leave the lowest bits alone: the starts are a generator of the bits above them.
    let moving = Congruential {
        bits: generator.bits - stride.trailing_zeros(),
        ..generator
    };
    Streams {
        stride,
        closest_ids: ids,
        closest_steps: steps,
        crowding: period::crowding(stride, 1 << 32),
        merits: Spectrum::of(moving.leap(stride), moving.bits).merits,
        pair_merit,
        pair_ids,
        pairs_up_to: NEIGHBOURS,
        renders: RENDERS,
        units: UNITS,
        closest_of_renders: period::closest_of_renders(&starts, stride, UNITS),
    }
}

#[cfg(test)]
mod tests {
    use fixedmath::random::{Lcg32, Lcg64};

    use super::*;

    #[test]
    fn constants_are_the_tracers() {
        let step = |state: u64| {
            let mut generator = Lcg64::new(state);
            generator.next_fraction();
            generator
        };
        assert_eq!(step(0), Lcg64::new(OURS.increment));
        assert_eq!(step(1), Lcg64::new(OURS.increment.wrapping_add(OURS.multiplier)));
        let step = |state: u32| {
            let mut generator = Lcg32::new(state);
            generator.low_bits();
            generator
        };
        assert_eq!(step(0), Lcg32::new(PUBLISHED.increment as u32));
        let sum = PUBLISHED.increment + PUBLISHED.multiplier;
        assert_eq!(step(1), Lcg32::new(sum as u32));
    }

    /// The states that `distance` speaks of are the tracer's.
    #[test]
    fn streams_start_where_they_are_said_to() {
        for (seed, id) in [(0, 0), (1, 1), (7, u32::MAX), (u64::MAX, 12_345)] {
            let mut generator = Lcg64::new(0);
            let steps = u64::from(id).wrapping_mul(STRIDE);
            generator.jump(OURS.distance(0, spread(seed)).wrapping_add(steps));
            let mut random = FullState::for_unit(seed, id);
            assert!((0..9).all(|_| random.fraction().to_bits() == generator.next_fraction()));
        }
    }

    /// The longest unit that a packet can speak of may take 700 numbers a sample; in the Cornell box it takes 15.
    #[test]
    fn no_unit_reaches_the_next_stream() {
        let most = 700 * tracer::unit::SPAN as u64 * u64::from(wire::MAX_SAMPLES);
        let found = streams();
        assert!(found.closest_steps > most, "{found:?}");
        assert!(found.closest_of_renders > most, "{found:?}");
    }
}
