//! The time in which the collector attended to its socket: the only time in which a silence means something.

use std::time::Duration;

/// What passes at most between two looks at the socket while the host is merely busy. Anything more is a time in which the collector
/// was stopped: by Ctrl-Z, or with the machine's lid closed. Whatever the cores said meanwhile, nobody was there to hear it.
const MOST_BETWEEN_LOOKS: Duration = Duration::from_millis(100);

/// A clock that stands still while nobody looks at the socket.
#[derive(Debug, Default)]
pub struct Attended {
    last_look: Duration,
    total: Duration,
}

impl Attended {
    /// The collector looks at the socket at the time `now`. Returns the time attended until then.
    pub fn look(&mut self, now: Duration) -> Duration {
        let since = now.saturating_sub(self.last_look);
        self.last_look = now;
        self.total += since.min(MOST_BETWEEN_LOOKS);
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_in_which_nobody_looked_does_not_count() {
        let mut attended = Attended::default();
        let ms = Duration::from_millis;
        assert_eq!(attended.look(ms(10)), ms(10));
        assert_eq!(attended.look(ms(30)), ms(30));
        assert_eq!(attended.look(ms(8_030)), ms(130), "stopped for eight seconds");
        assert_eq!(attended.look(ms(8_040)), ms(140));
    }
}
