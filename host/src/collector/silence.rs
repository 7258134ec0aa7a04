//! When a fleet of which no core says a word is given up, and when the user hears of it.
//!
//! A core is mute while it works at a unit, and nobody knows beforehand how long that takes. So as long as somebody sees whether
//! the cores live, their silence ends nothing; only the user may say that it has lasted long enough. Of cores that were started
//! elsewhere nobody sees the end: they are given up after a time that is long in comparison to what their units took.

use std::time::Duration;

use crate::fleet::Patience;

/// The least silence after which cores elsewhere are given up.
const LEAST: Duration = Duration::from_secs(60);
/// The same in the longest time that a unit took.
const IN_UNITS: u32 = 20;
/// The user hears of a silence of this length, or of three units'.
const WORTH_A_WORD: Duration = Duration::from_secs(20);
const WORTH_A_WORD_IN_UNITS: u32 = 3;

/// What is known about a fleet's silences.
#[derive(Debug, Default)]
pub struct Silence {
    /// How long the user wants to wait, whatever may be.
    patience: Option<Duration>,
    /// The longest that a core said nothing before a unit of it came.
    longest_unit: Option<Duration>,
    /// The silence that the user has heard of began at this time.
    announced: Option<Duration>,
}

impl Silence {
    /// Nothing is known yet but how long the user wants to wait, if they said so.
    pub fn new(patience: Option<Duration>) -> Self {
        Self {
            patience,
            ..Self::default()
        }
    }

    /// A unit came from a core that had said nothing for so long.
    pub fn unit_after(&mut self, silence: Duration) {
        self.longest_unit = self.longest_unit.max(Some(silence));
    }

    /// How long a silence of all cores has to last for the fleet to be given up, if any is long enough.
    pub fn limit(&self, fleets: Patience) -> Option<Duration> {
        match fleets {
            Patience::Endless => None,
            Patience::WhileTheyLive => self.patience,
            // Before its first unit a core may take any time: somebody starts it by hand.
            Patience::InUnits => {
                let of_units = self.longest_unit.map(|unit| LEAST.max(unit * IN_UNITS));
                self.patience.or(of_units)
            }
        }
    }

    /// How long the silence that began at `began` has lasted, once, where the user should hear of it.
    pub fn worth_a_word(&mut self, fleets: Patience, began: Duration, now: Duration) -> Option<Duration> {
        let long = WORTH_A_WORD.max(self.longest_unit.unwrap_or_default() * WORTH_A_WORD_IN_UNITS);
        let lasts = now.saturating_sub(began);
        if fleets == Patience::Endless || lasts < long || self.announced == Some(began) {
            return None;
        }
        self.announced = Some(began);
        Some(lasts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn nothing_ends_the_wait_for_cores_that_are_seen_to_live_but_the_user() {
        let fleet = Patience::WhileTheyLive;
        let mut silence = Silence::new(None);
        silence.unit_after(SECOND / 100);
        assert_eq!(silence.limit(fleet), None);
        assert_eq!(Silence::new(Some(SECOND)).limit(fleet), Some(SECOND));
    }

    #[test]
    fn cores_elsewhere_have_a_minute_or_twenty_units() {
        let mut silence = Silence::new(None);
        assert_eq!(silence.limit(Patience::InUnits), None, "they are being started");
        silence.unit_after(SECOND / 10);
        assert_eq!(silence.limit(Patience::InUnits), Some(60 * SECOND));
        silence.unit_after(5 * SECOND);
        silence.unit_after(SECOND);
        assert_eq!(silence.limit(Patience::InUnits), Some(100 * SECOND));
        silence.patience = Some(3 * SECOND);
        assert_eq!(silence.limit(Patience::InUnits), Some(3 * SECOND));
    }

    #[test]
    fn a_long_silence_is_told_once() {
        let mut silence = Silence::new(None);
        let told = |silence: &mut Silence, began: u32, now: u32| {
            silence.worth_a_word(Patience::InUnits, began * SECOND, now * SECOND)
        };
        assert_eq!(told(&mut silence, 1, 20), None);
        assert_eq!(told(&mut silence, 1, 21), Some(20 * SECOND));
        assert_eq!(told(&mut silence, 1, 90), None);
        silence.unit_after(10 * SECOND);
        assert_eq!(told(&mut silence, 100, 129), None);
        assert_eq!(told(&mut silence, 100, 130), Some(30 * SECOND));
        assert_eq!(
            silence.worth_a_word(Patience::Endless, SECOND, 900 * SECOND),
            None
        );
    }
}
