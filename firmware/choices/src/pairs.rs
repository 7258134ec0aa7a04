//! The published generator, for samples that want 32 bits.

use fixedmath::U0F32;
use tracer::random::{LowBits, Random};

/// Two draws of [`LowBits`] for each number, of 16 bits each: one alone would leave the second coordinate of every point of a disc at 0.
#[derive(Clone, Debug)]
pub struct LowBitPairs(LowBits);

impl Random for LowBitPairs {
    fn for_unit(seed: u64, id: u32) -> Self {
        Self(LowBits::for_unit(seed, id))
    }

    #[inline]
    fn fraction(&mut self) -> U0F32 {
        self.0.fraction() | self.0.fraction() >> 16u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_two_draws() {
        let (mut pairs, mut draws) = (LowBitPairs::for_unit(7, 3), LowBits::for_unit(7, 3));
        for _ in 0..100 {
            let [upper, lower] = [(); 2].map(|()| draws.fraction().to_bits());
            assert_eq!(pairs.fraction().to_bits(), upper | lower >> 16);
        }
    }
}
