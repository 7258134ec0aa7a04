//! What a core says to somebody who looks for a fault: `defmt`'s macros with the feature `log`, nothing without.
//!
//! The levels: `error` before a core ends, `warn` for what should not happen, `info` for a core's life, `debug` for its work, and
//! `trace` for every packet.

#[cfg(feature = "log")]
pub(crate) use defmt::{debug, info, trace, warn};

/// Leaves no byte in the image: the arguments are only checked, and count as used.
#[cfg(not(feature = "log"))]
macro_rules! nothing {
    ($text:literal $(, $argument:expr)* $(,)?) => {
        if false {
            $(let _ = &$argument;)*
        }
    };
}

#[cfg(not(feature = "log"))]
pub(crate) use {nothing as debug, nothing as info, nothing as trace, nothing as warn};

/// The time that a line of the log is stamped with: what a counter that wraps has counted in all.
///
/// It must be asked at least once in each turn of the counter, or that turn is lost.
#[cfg(any(feature = "log", test))]
#[derive(Clone, Copy, Debug, Default)]
pub struct Uptime {
    /// The counter at the last full microsecond.
    counted: u32,
    micros: u64,
}

#[cfg(any(feature = "log", test))]
impl Uptime {
    /// No time has passed, and the counter is zero.
    pub const fn new() -> Self {
        Self {
            counted: 0,
            micros: 0,
        }
    }

    /// Microseconds until the counter, which has so many megahertz, came to `count`.
    pub const fn micros(&mut self, count: u32, megahertz: u32) -> u64 {
        let passed = count.wrapping_sub(self.counted) / megahertz;
        self.counted = self.counted.wrapping_add(passed * megahertz);
        self.micros += passed as u64;
        self.micros
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_on_when_the_counter_wraps() {
        let mut uptime = Uptime::new();
        for minutes in 1..=12 {
            let micros = minutes * 60_000_000;
            assert_eq!(uptime.micros((micros * 24) as u32, 24), micros);
        }
    }

    #[test]
    fn parts_of_a_microsecond_are_not_lost() {
        let mut uptime = Uptime::new();
        let times = (1..=100).map(|n| uptime.micros(n * 7, 24));
        assert_eq!(times.last(), Some(700 / 24));
    }
}
