//! Lost packets, as the gaps in a core's packet numbers show them.

use std::collections::BTreeSet;

/// The packet numbers of one core.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    next: u16,
    /// Numbers that were skipped not long ago: they may still come.
    missing: BTreeSet<u16>,
    lost: u64,
}

impl Sequence {
    /// Packet number `seq` came. Returns how many numbers before it were skipped, as far as that was not known; nothing where
    /// later packets have overtaken it.
    pub fn received(&mut self, seq: u16) -> Option<u64> {
        if is_behind(seq, self.next) {
            // Overtaken by others after all, or doubled on the way: then it is not missing.
            if self.missing.remove(&seq) {
                self.lost -= 1;
            }
            return None;
        }
        let skipped = self.sent_before(seq);
        self.step();
        skipped
    }

    /// The core says that it had sent packets up to, not including, number `seq`. Returns how many of them were not known to be
    /// missing; nothing where it has sent more since, and its word is old.
    pub fn sent_before(&mut self, seq: u16) -> Option<u64> {
        if is_behind(seq, self.next) {
            return None;
        }
        let before = self.lost;
        while self.next != seq {
            self.missing.insert(self.next);
            self.lost += 1;
            self.step();
        }
        Some(self.lost - before)
    }

    /// The core was started again: its next packet is number 0, and what is missing now never comes.
    pub fn start_again(&mut self) {
        self.next = 0;
        self.missing.clear();
    }

    /// Packets that were sent and have not come.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    fn step(&mut self) {
        // A number that is half the circle behind is lost for good; soon it would be mistaken for a new one.
        self.missing.remove(&(self.next ^ 0x8000));
        self.next = self.next.wrapping_add(1);
    }
}

/// Numbers wrap: up to half the circle back is behind.
fn is_behind(seq: u16, next: u16) -> bool {
    (seq.wrapping_sub(next) as i16) < 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lost_after(numbers: impl IntoIterator<Item = u16>) -> u64 {
        let mut sequence = Sequence::default();
        numbers.into_iter().for_each(|number| {
            sequence.received(number);
        });
        sequence.lost()
    }

    #[test]
    fn gaps_count_and_late_or_doubled_packets_do_not() {
        assert_eq!(lost_after([0, 1, 2]), 0);
        assert_eq!(lost_after([1, 2, 5]), 3);
        assert_eq!(lost_after([0, 2, 1, 3]), 0);
        assert_eq!(lost_after([0, 2, 2, 0, 2]), 1);
    }

    #[test]
    fn the_loss_of_the_last_packet_shows_in_the_next_word() {
        let mut sequence = Sequence::default();
        sequence.received(0);
        assert_eq!(sequence.sent_before(2), Some(1));
        assert_eq!(sequence.sent_before(2), Some(0), "it is known");
        assert_eq!(sequence.sent_before(1), None);
        assert_eq!(sequence.lost(), 1);
    }

    #[test]
    fn a_core_that_is_started_again_has_lost_what_was_missing_and_no_more() {
        let mut sequence = Sequence::default();
        [0, 1, 3, 4].into_iter().for_each(|number| {
            sequence.received(number);
        });
        sequence.start_again();
        // The last one is the 2 of the new life, not the missing one of the old.
        [0, 1, 2].into_iter().for_each(|number| {
            sequence.received(number);
        });
        assert_eq!(sequence.lost(), 1);
        // Nor is it thought of as an old packet when the old life was long.
        let mut sequence = Sequence::default();
        (0..40_000).for_each(|number| {
            sequence.received(number);
        });
        sequence.start_again();
        sequence.received(1);
        assert_eq!(sequence.lost(), 1);
    }

    #[test]
    fn numbers_wrap() {
        let twice_round = (0..150_000_u32).map(|number| number as u16);
        assert_eq!(lost_after(twice_round), 0);
        let one_in_ten_lost = (0..150_000_u32)
            .filter(|number| number % 10 != 3)
            .map(|number| number as u16);
        assert_eq!(lost_after(one_in_ten_lost), 15_000);
    }
}
