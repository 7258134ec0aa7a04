//! Samples that keep out of each other's way: an additive recurrence.
//!
//! Number `i` of a pixel's samples has in dimension `d` the place `shift[d] + i alpha[d]`, modulo 1. The `alpha[d]` are the powers of
//! 1 / g with `g^(D + 1) = g + 1`, the golden ratio's kin in D dimensions (M. Roberts, "The Unreasonable Effectiveness of Quasirandom
//! Sequences", 2018), which fill the unit cube about as evenly as any sequence, however many samples there are. The shifts are random, each
//! pixel of each unit has its own (R. Cranley and T. Patterson, 1976), so that every sample by itself is uniform, and what is left of error
//! differs from pixel to pixel without a pattern.
//!
//! Dimensions are where a sample is in its sub-pixel, and the first [`PAIRS`] points of a disc that its path takes. All else is drawn from
//! the generator that the shifts come from.

use core::marker::PhantomData;

use fixedmath::{I16F16, U0F32};

use crate::profile::{Profile, Quadratic};
use crate::random::Random;

/// Points of a disc of one path.
pub const PAIRS: usize = 4;

const DIMENSIONS: usize = 2 + 2 * PAIRS;

/// Steps in 0:32: the first ten powers of the reciprocal of the root above 1 of g^11 = g + 1.
const ALPHA: [u32; DIMENSIONS] = [
    0xefa2_39aa,
    0xe050_4e7a,
    0xd1f9_1e9d,
    0xc48c_a286,
    0xb7fb_d901,
    0xac38_b669,
    0xa136_14fb,
    0x96e7_a620,
    0x8d41_e4ad,
    0x843a_0802,
];

/// A stream of samples by an additive recurrence, over a generator.
#[derive(Clone, Debug)]
pub struct Kronecker<R> {
    generator: R,
    /// Where the pixel's next sample is.
    places: [u32; DIMENSIONS],
    /// The sample's next pair.
    next: usize,
}

impl<R: Random> Kronecker<R> {
    /// Draws the first place in a dimension. Out of line, so that ten of them are not ten generators.
    #[inline(never)]
    fn shift(&mut self, dimension: usize) {
        if let Some(place) = self.places.get_mut(dimension) {
            *place = self.generator.fraction().to_bits();
        }
    }
}

impl<R: Random> Random for Kronecker<R> {
    fn for_unit(seed: u64, id: u32) -> Self {
        Self {
            generator: R::for_unit(seed, id),
            places: [0; DIMENSIONS],
            next: PAIRS,
        }
    }

    #[inline]
    fn fraction(&mut self) -> U0F32 {
        self.generator.fraction()
    }

    /// Kept small: it is seldom called.
    #[cold]
    #[inline(never)]
    fn start_pixel(&mut self) {
        for place in 0..DIMENSIONS {
            self.shift(place);
        }
    }

    #[inline]
    fn start_sample(&mut self) {
        for (place, alpha) in self.places.iter_mut().zip(ALPHA) {
            *place = place.wrapping_add(alpha);
        }
        self.next = 0;
    }

    #[inline]
    fn film(&mut self) -> [U0F32; 2] {
        [self.places[0], self.places[1]].map(U0F32::from_bits)
    }

    #[inline(never)]
    fn pair(&mut self) -> U0F32 {
        let Some([x, y]) = self.places[2..].as_chunks().0.get(self.next) else {
            return self.generator.fraction();
        };
        self.next += 1;
        U0F32::from_bits(x & 0xffff_0000 | y >> 16)
    }
}

/// Profile `P` with such samples.
#[derive(Clone, Copy, Debug)]
pub struct Stratified<P>(PhantomData<P>);

impl<P: Profile> Profile for Stratified<P> {
    const NAME: &'static str = P::STRATIFIED_NAME;
    const STRATIFIED_NAME: &'static str = P::STRATIFIED_NAME;
    const EPSILON: I16F16 = P::EPSILON;
    const QUADRATIC: Quadratic = P::QUADRATIC;
    type Numbers = P::Numbers;
    type Random = Kronecker<P::Random>;
    type Hemisphere = P::Hemisphere;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::FullState;

    /// `a b` in 0:32, cut.
    fn times(a: u64, b: u64) -> u64 {
        ((u128::from(a) * u128::from(b)) >> 62) as u64
    }

    /// With a = 1 / g, the equation is a^10 + a^11 = 1, and each step is a power of a, cut to 32 bits.
    #[test]
    fn steps_are_powers_of_the_golden_ratios_kin() {
        const ONE: u64 = 1 << 62;
        let power = |a: u64, n: u32| (0..n).fold(ONE, |power, _| times(power, a));
        let (mut low, mut high) = (0, ONE);
        while high - low > 1 {
            let middle = u64::midpoint(low, high);
            if power(middle, 10) + power(middle, 11) < ONE {
                low = middle;
            } else {
                high = middle;
            }
        }
        for (n, alpha) in (1..).zip(ALPHA) {
            assert_eq!(alpha, (power(low, n) >> 30) as u32, "{n}");
        }
    }

    /// In every dimension, the longest gap between a pixel's places is no more than five times the mean; of random ones it would be ten.
    #[test]
    fn places_keep_apart() {
        let mut samples = Kronecker::<FullState>::for_unit(3, 7);
        samples.start_pixel();
        let mut places = [[0; 64]; DIMENSIONS];
        for sample in 0..64 {
            samples.start_sample();
            for (dimension, place) in places.iter_mut().zip(samples.places) {
                dimension[sample] = place;
            }
        }
        for dimension in &mut places {
            dimension.sort_unstable();
            let around = dimension[0].wrapping_sub(dimension[63]);
            let longest = dimension
                .windows(2)
                .map(|pair| pair[1] - pair[0])
                .chain([around])
                .max();
            assert!(longest.is_some_and(|gap| gap < 5 << 26), "{longest:?}");
        }
    }

    /// Another pixel, another unit and another seed have other shifts; the same have the same.
    #[test]
    fn shifts_are_the_units_own() {
        let first = |seed, id, pixels| {
            let mut samples = Kronecker::<FullState>::for_unit(seed, id);
            (0..pixels).for_each(|_| samples.start_pixel());
            samples.start_sample();
            (samples.film(), samples.pair())
        };
        assert_eq!(first(1, 2, 1), first(1, 2, 1));
        assert!(
            first(1, 2, 1) != first(1, 2, 2)
                && first(1, 2, 1) != first(1, 3, 1)
                && first(1, 2, 1) != first(2, 2, 1)
        );
    }

    /// Past the last pair the generator goes on.
    #[test]
    fn later_pairs_are_drawn() {
        let mut samples = Kronecker::<FullState>::for_unit(1, 1);
        samples.start_pixel();
        samples.start_sample();
        let mut generator = samples.generator.clone();
        for _ in 0..PAIRS {
            samples.pair();
        }
        assert_eq!(samples.pair(), generator.fraction());
        assert_eq!(samples.fraction(), generator.fraction());
    }
}
