//! Random numbers in the order in which a render takes them.

use std::io::{self, Write};

use tracer::random::Random;

/// Numbers taken of each unit's stream: rounded up from what the 1,024 samples of a usual unit take in the Cornell box.
pub const DRAWS: usize = 16_384;

/// Bits of a number that are not merely zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// The upper 16.
    Half,
    /// All 32.
    Full,
}

/// Unit after unit, [`DRAWS`] numbers of each.
pub fn unit_after_unit<R: Random>(seed: u64) -> impl Iterator<Item = u32> {
    (0..=u32::MAX).flat_map(move |id| {
        let mut random = R::for_unit(seed, id);
        (0..DRAWS).map(move |_| random.fraction().to_bits())
    })
}

/// The first number of each unit.
pub fn first_of_units<R: Random>(seed: u64) -> impl Iterator<Item = u32> {
    (0..=u32::MAX).map(move |id| R::for_unit(seed, id).fraction().to_bits())
}

/// Writes the bits of `numbers` and no others as 32-bit words of this machine, until the reader has had enough.
pub fn write_words(
    mut numbers: impl Iterator<Item = u32>,
    width: Width,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut words = Vec::new();
    loop {
        words.clear();
        for _ in 0..DRAWS {
            let Some(number) = numbers.next() else {
                return out.write_all(&words);
            };
            let word = match width {
                Width::Full => number,
                Width::Half => number >> 16 | numbers.next().unwrap_or(0) & 0xffff_0000,
            };
            words.extend_from_slice(&word.to_ne_bytes());
        }
        match out.write_all(&words) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
            written => written?,
        }
    }
}

#[cfg(test)]
mod tests {
    use tracer::random::{FullState, LowBits};

    use super::*;

    #[test]
    fn units_follow_each_other() {
        let numbers: Vec<u32> = unit_after_unit::<FullState>(7).take(2 * DRAWS).collect();
        let mut second = FullState::for_unit(7, 1);
        assert!(
            numbers[DRAWS..]
                .iter()
                .all(|&number| number == second.fraction().to_bits())
        );
        let first: Vec<u32> = first_of_units::<FullState>(7).take(2).collect();
        assert_eq!(first, [numbers[0], numbers[DRAWS]]);
    }

    #[test]
    fn words_hold_every_used_bit_once() {
        let numbers = || first_of_units::<LowBits>(1).take(4);
        let (mut halves, mut full) = (Vec::new(), Vec::new());
        write_words(numbers(), Width::Half, &mut halves).expect("memory takes it");
        write_words(numbers(), Width::Full, &mut full).expect("memory takes it");
        let upper: Vec<u16> = numbers().map(|number| (number >> 16) as u16).collect();
        let word = |low: u16, high: u16| (u32::from(low) | u32::from(high) << 16).to_ne_bytes();
        assert_eq!(
            halves,
            [word(upper[0], upper[1]), word(upper[2], upper[3])].concat()
        );
        assert_eq!(full.len(), 16);
    }
}
