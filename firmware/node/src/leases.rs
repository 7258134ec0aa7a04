//! The units a core has been told to render.

use heapless::Deque;

use crate::log;

/// Leases a core holds at once.
pub const LEASES: usize = 4;

/// Lease numbers a core remembers, so as to know a duplicate: more than can be on their way at once.
const REMEMBERED: usize = 4 * LEASES;

/// Units `next` to `last`.
#[derive(Clone, Copy, Debug)]
struct Lease {
    next: u32,
    last: u32,
}

/// The queue of leases, first in first out.
#[derive(Debug, Default)]
pub(crate) struct Leases {
    queue: Deque<Lease, LEASES>,
    /// The last of their numbers, oldest first.
    seen: Deque<u16, REMEMBERED>,
}

/// No room for another lease.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Full;

impl Leases {
    /// Takes a lease. A duplicate is nothing new, and so no error; a lease that was refused is not remembered.
    pub(crate) fn take(&mut self, number: u16, first: u32, last: u32) -> Result<(), Full> {
        if self.seen.iter().any(|&seen| seen == number) {
            log::debug!("lease {=u16} is here already", number);
            return Ok(());
        }
        self.queue
            .push_back(Lease { next: first, last })
            .map_err(|_| Full)?;
        if self.seen.is_full() {
            self.seen.pop_front();
        }
        // There is room for it.
        let _ = self.seen.push_back(number);
        log::debug!("lease {=u16}: units {=u32} to {=u32}", number, first, last);
        Ok(())
    }

    /// The next unit to render.
    pub(crate) fn next(&mut self) -> Option<u32> {
        let lease = self.queue.front_mut()?;
        let unit = lease.next;
        if unit == lease.last {
            self.queue.pop_front();
        } else {
            lease.next += 1;
        }
        Some(unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_come_in_the_order_of_the_leases() {
        let mut leases = Leases::default();
        leases.take(1, 10, 12).unwrap();
        leases.take(2, u32::MAX, u32::MAX).unwrap();
        let units: [_; 5] = core::array::from_fn(|_| leases.next());
        assert_eq!(units, [Some(10), Some(11), Some(12), Some(u32::MAX), None]);
    }

    #[test]
    fn a_refused_lease_is_taken_later() {
        let mut leases = Leases::default();
        for number in 0..4 {
            leases.take(number, 0, 0).unwrap();
        }
        assert_eq!(leases.take(4, 7, 7), Err(Full));
        leases.next();
        assert_eq!(leases.take(4, 7, 7), Ok(()));
    }

    #[test]
    fn a_duplicate_needs_no_room() {
        let mut leases = Leases::default();
        for number in 0..4 {
            leases.take(number, 0, 0).unwrap();
        }
        assert_eq!(leases.take(2, 0, 0), Ok(()));
    }

    /// The sixteen-bit numbers come round; an old one must not be taken for a duplicate.
    #[test]
    fn numbers_may_be_used_again() {
        let mut leases = Leases::default();
        for number in (0..=REMEMBERED as u16).chain([0]) {
            leases.take(number, 5, 5).unwrap();
            assert_eq!(leases.next(), Some(5));
        }
    }
}
