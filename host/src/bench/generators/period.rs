//! How long a generator takes to repeat, and how far apart its streams are.
//!
//! Streams are laid on one period at a fixed stride: stream `i` starts `i` strides from the first. Two streams whose ids
//! differ by `k` are then `k` strides apart, taken round the period, whatever the two ids are. The `k` that come closest
//! to a whole number of periods are the denominators of the convergents of stride / period (J.-L. Lagrange), so a few
//! dozen steps of Euclid's algorithm tell the distance for every pair of 2^32 streams.

/// A generator `x -> a x + c` modulo a power of two, used by its upper bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Congruential {
    /// `a`.
    pub multiplier: u64,
    /// `c`.
    pub increment: u64,
    /// Bits of the state.
    pub bits: u32,
}

impl Congruential {
    /// Whether it goes through all states: T. Hull and A. Dobell's conditions for a power of two.
    pub const fn has_full_period(self) -> bool {
        self.increment % 2 == 1 && self.multiplier % 4 == 1
    }

    /// The multiplier of `steps` steps at once.
    pub const fn leap(self, mut steps: u64) -> u64 {
        let (mut square, mut product) = (self.multiplier, 1u64);
        while steps != 0 {
            if steps % 2 == 1 {
                product = product.wrapping_mul(square);
            }
            square = square.wrapping_mul(square);
            steps /= 2;
        }
        product & (u64::MAX >> (64 - self.bits))
    }

    /// How many steps of a full-period generator lead from one state to another.
    ///
    /// Bit by bit from the lowest: `2^k` steps change no bit below `k`, and always bit `k`.
    pub const fn distance(self, from: u64, to: u64) -> u64 {
        let (mut a, mut c) = (self.multiplier, self.increment);
        let (mut state, mut steps, mut bit) = (from, 0, 0);
        while bit < self.bits {
            if (state ^ to) >> bit & 1 == 1 {
                state = state.wrapping_mul(a).wrapping_add(c);
                steps |= 1 << bit;
            }
            c = a.wrapping_add(1).wrapping_mul(c);
            a = a.wrapping_mul(a);
            bit += 1;
        }
        steps
    }
}

/// The two streams that come closest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closest {
    /// How much their ids differ.
    pub ids: u64,
    /// How many steps lie between them.
    pub steps: u64,
}

impl Closest {
    /// The period over `streams` times the distance: 1 for streams spread evenly, and the more the closer they come.
    pub fn crowding(self, streams: u64) -> f64 {
        2f64.powi(64) / (streams as f64 * self.steps as f64)
    }
}

/// For ever more streams at a `stride` on a period of 2^64, up to `streams` of them: each pair that is closer than all
/// before it.
pub fn closest(stride: u64, streams: u64) -> Vec<Closest> {
    let (mut before, mut steps) = (1u128 << 64, u128::from(stride));
    let (mut ids_before, mut ids) = (0u128, 1u128);
    let mut pairs = Vec::new();
    while ids < u128::from(streams) {
        let nearer = steps.min((1 << 64) - steps);
        pairs.push(Closest {
            ids: ids as u64,
            steps: nearer as u64,
        });
        if steps == 0 {
            break;
        }
        let quotient = before / steps;
        (before, steps) = (steps, before % steps);
        (ids_before, ids) = (ids, ids_before + quotient * ids);
    }
    pairs
}

/// The most that `streams` streams or fewer are crowded: the largest [`Closest::crowding`], counted where it is reached.
pub fn crowding(stride: u64, streams: u64) -> f64 {
    let pairs = closest(stride, streams);
    pairs
        .iter()
        .map(|pair| pair.crowding(pair.ids))
        .fold(0.0, f64::max)
}

/// The least distance between two streams of renders with different seeds. `starts` are the places on a period of 2^64
/// where the renders' first streams start; each has `streams` of them.
///
/// # Panics
/// If there are fewer than two starts.
pub fn closest_of_renders(starts: &[u64], stride: u64, streams: u64) -> u64 {
    let mut places: Vec<(u64, usize)> = (0..)
        .zip(starts)
        .flat_map(|(render, start)| {
            (0..streams).map(move |id| (start.wrapping_add(id.wrapping_mul(stride)), render))
        })
        .collect();
    places.sort_unstable();
    let next = places.iter().cycle().skip(1);
    let gaps = places.iter().zip(next);
    gaps.filter(|(one, other)| one.1 != other.1)
        .map(|(one, other)| other.0.wrapping_sub(one.0))
        .min()
        .expect("two renders")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::bench::generators::judgement::OURS;

    /// Over all pairs of `streams` streams.
    fn by_trial(stride: u64, streams: u64) -> u64 {
        let apart = |ids: u64| {
            let steps = ids.wrapping_mul(stride);
            steps.min(steps.wrapping_neg())
        };
        (1..streams).map(apart).min().expect("a pair")
    }

    proptest! {
        #[test]
        fn closest_streams_by_trial(stride in 1u64.., streams in 2u64..5000) {
            let found = *closest(stride, streams).last().expect("a pair");
            prop_assert_eq!(found.steps, by_trial(stride, streams));
            let steps = found.ids.wrapping_mul(stride);
            prop_assert_eq!(found.steps, steps.min(steps.wrapping_neg()));
            prop_assert!(found.ids < streams);
        }

        #[test]
        fn distance_undoes_steps(from: u64, steps: u64, bits in 3u32..=64) {
            let generator = Congruential { bits, ..OURS };
            let (mut a, mut c, mut state) = (OURS.multiplier, OURS.increment, from);
            for bit in 0..64 {
                if steps >> bit & 1 == 1 {
                    state = state.wrapping_mul(a).wrapping_add(c);
                }
                c = a.wrapping_add(1).wrapping_mul(c);
                a = a.wrapping_mul(a);
            }
            prop_assert_eq!(generator.distance(from, state), steps & (u64::MAX >> (64 - bits)));
        }
    }

    /// All generators of 2^6: the conditions hold exactly where all states are met.
    #[test]
    fn full_periods_by_trial() {
        for (multiplier, increment) in (0..64).flat_map(|a| (0..64).map(move |c| (a, c))) {
            let generator = Congruential {
                multiplier,
                increment,
                bits: 6,
            };
            let (mut state, mut steps) = (0, 0);
            while steps < 64 && (steps == 0 || state != 0) {
                state = (state * multiplier + increment) % 64;
                steps += 1;
            }
            let full = steps == 64 && state == 0;
            assert_eq!(generator.has_full_period(), full, "{multiplier} {increment}");
        }
    }

    #[test]
    fn renders_apart_by_hand() {
        let half = 1 << 63;
        assert_eq!(closest_of_renders(&[10, 25], half, 2), 15);
        assert_eq!(closest_of_renders(&[10, half - 7], half, 2), 17);
    }
}
