//! Random numbers: one stream a unit.

use fixedmath::U0F32;
use fixedmath::random::{Lcg32, Lcg64};

/// A stream of uniform fractions that belongs to one unit of one render.
pub trait Random {
    /// The stream of unit `id` in the render seeded with `seed`.
    fn for_unit(seed: u64, id: u32) -> Self;

    /// The next number.
    fn fraction(&mut self) -> U0F32;

    /// To be called before a pixel's first sample.
    #[inline]
    fn start_pixel(&mut self) {}

    /// To be called before each sample.
    #[inline]
    fn start_sample(&mut self) {}

    /// Where a sample is in its sub-pixel: a point of the unit square, to be taken first.
    #[inline]
    fn film(&mut self) -> [U0F32; 2] {
        [self.fraction(), self.fraction()]
    }

    /// A point of the unit square, 16 bits for each coordinate, the first in the upper half.
    #[inline]
    fn pair(&mut self) -> U0F32 {
        self.fraction()
    }
}

/// 2^64 over the golden ratio, rounded to the even number above, whose continued fraction stays that of the golden ratio
/// longest. Multiples of it by 0, 1, 2, ... keep as far apart as any sequence can: the first `n` are at least
/// 2^64 / (2.62 n) steps from each other, up to the n = 2^32 units that there can be.
pub const STRIDE: u64 = 0x9e37_79b9_7f4a_7c16;

/// Spreads a seed over all bits (the finaliser of D. Stafford's variant 13, as in SplitMix64), so that seeds 1 and 2
/// start far apart: the state before the first number of unit 0.
pub const fn spread(seed: u64) -> u64 {
    let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The upper half of a 64-bit generator's state: period 2^64.
#[derive(Clone, Debug)]
pub struct FullState(Lcg64);

impl Random for FullState {
    fn for_unit(seed: u64, id: u32) -> Self {
        let mut generator = Lcg64::new(spread(seed));
        generator.jump(u64::from(id).wrapping_mul(STRIDE));
        Self(generator)
    }

    #[inline]
    fn fraction(&mut self) -> U0F32 {
        U0F32::from_bits(self.0.next_fraction())
    }
}

/// The published use of a 32-bit generator: the low 16 bits, which repeat after 65,536 draws.
#[derive(Clone, Debug)]
pub struct LowBits(Lcg32);

impl Random for LowBits {
    fn for_unit(seed: u64, id: u32) -> Self {
        let mut generator = Lcg32::new(spread(seed) as u32);
        generator.jump(id.wrapping_mul((STRIDE >> 32) as u32));
        Self(generator)
    }

    #[inline]
    fn fraction(&mut self) -> U0F32 {
        U0F32::from_bits(u32::from(self.0.low_bits()) << 16)
    }
}

#[cfg(test)]
mod tests {
    use super::STRIDE;

    /// Streams `k` ids apart are `k STRIDE` steps apart, one way or the other round the period.
    fn apart(k: u64) -> u64 {
        let steps = k.wrapping_mul(STRIDE);
        steps.min(steps.wrapping_neg())
    }

    /// The multiples that come closest to a whole period are the denominators of the convergents of STRIDE / 2^64: the
    /// Fibonacci numbers, up to the last below 2^32.
    #[test]
    fn streams_keep_their_distance() {
        let (mut k, mut next) = (1u64, 2u64);
        while k < 1 << 32 {
            // Between this Fibonacci number and the next, nothing comes closer.
            assert!(apart(k) as f64 >= 2f64.powi(64) / 2.62 / k as f64, "{k}");
            (k, next) = (next, k + next);
        }
        let closest = (1..1_000_000).map(apart).min();
        assert_eq!(
            closest,
            Some(apart(832_040)),
            "the largest Fibonacci number below a million"
        );
        assert_eq!(apart(2_971_215_073), 2_920_294_230, "the closest of all 2^32");
    }
}
