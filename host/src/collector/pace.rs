//! How long a core usually takes for a unit, from when its units arrive.

use std::collections::VecDeque;
use std::time::Duration;

/// Arrivals that are looked at.
const WINDOW: usize = 16;

/// The times between a core's last few arrivals.
#[derive(Debug, Default)]
pub struct Pace {
    gaps: VecDeque<Duration>,
    /// The arrival before, unless the core had nothing to do since.
    last: Option<Duration>,
}

impl Pace {
    /// A unit came in.
    pub fn unit_done(&mut self, now: Duration) {
        if let Some(last) = self.last.replace(now) {
            self.gaps.push_back(now.saturating_sub(last));
            if self.gaps.len() > WINDOW {
                self.gaps.pop_front();
            }
        }
    }

    /// The core has nothing to do: the time until its next unit says nothing about its pace.
    pub fn pause(&mut self) {
        self.last = None;
    }

    /// The mean time of a unit; `None` before two have come in a row. (The mean, because arrivals come in bursts
    /// when the host was busy: most gaps are then near zero, and the mean alone is still right.)
    pub fn usual(&self) -> Option<Duration> {
        let gaps = u32::try_from(self.gaps.len()).ok().filter(|&gaps| gaps > 0)?;
        Some(self.gaps.iter().sum::<Duration>() / gaps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    #[test]
    fn a_burst_does_not_change_the_pace() {
        let mut pace = Pace::default();
        assert_eq!(pace.usual(), None);
        pace.unit_done(ms(100));
        assert_eq!(pace.usual(), None);
        for now in [110, 120, 160, 160, 160, 160, 170] {
            pace.unit_done(ms(now));
        }
        assert_eq!(pace.usual(), Some(ms(10)));
    }

    #[test]
    fn idle_time_is_not_counted_and_old_times_are_forgotten() {
        let mut pace = Pace::default();
        pace.unit_done(ms(0));
        pace.unit_done(ms(10));
        pace.pause();
        pace.unit_done(ms(5_000));
        assert_eq!(pace.usual(), Some(ms(10)));
        for unit in 1..=WINDOW as u64 {
            pace.unit_done(ms(5_000 + 3 * unit));
        }
        assert_eq!(pace.usual(), Some(ms(3)));
    }
}
