//! How far it is: a bar on a terminal, a line every few seconds elsewhere.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressStyle};

use crate::platform::console::note;

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// How far a collection is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Time since the start.
    pub elapsed: Duration,
    /// Units in.
    pub units: u64,
    /// Samples in.
    pub samples: u64,
    /// Samples wanted.
    pub wanted: u64,
    /// Pixel packets received.
    pub packets: u64,
}

impl State {
    /// Samples/s, packets/s and the time left, once there is something to go by.
    fn describe(&self) -> String {
        let seconds = self.elapsed.as_secs_f64();
        if self.samples == 0 || seconds <= 0.0 {
            return "waiting for the first unit".to_owned();
        }
        let rate = self.samples as f64 / seconds;
        let left = Duration::from_secs_f64(self.wanted.saturating_sub(self.samples) as f64 / rate);
        format!(
            "{} units, {} samples/s, {:.0} packets/s, {} left",
            HumanCount(self.units),
            HumanCount(rate as u64),
            self.packets as f64 / seconds,
            HumanDuration(left),
        )
    }
}

/// Says how far it is.
#[derive(Debug)]
pub enum Progress {
    /// A bar, redrawn in place.
    Bar(ProgressBar),
    /// Lines; holds the time of the last one.
    Lines(Duration),
    /// Nothing at all.
    Silent,
}

impl Progress {
    /// A bar if there is a terminal to draw it on, else lines.
    pub fn on_stderr() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::Lines(Duration::ZERO);
        }
        let style = ProgressStyle::with_template("{wide_bar} {percent}% {msg}");
        // The template is a constant; were it wrong, the default style would still say how far it is.
        Self::Bar(ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())))
    }

    /// Shows the state.
    pub fn show(&mut self, state: &State) {
        match self {
            Self::Bar(bar) => {
                bar.set_length(state.wanted);
                bar.set_position(state.samples.min(state.wanted));
                bar.set_message(state.describe());
            }
            Self::Lines(last) if state.elapsed.saturating_sub(*last) >= LINE_EVERY => {
                *last = state.elapsed;
                let percent = 100 * state.samples.min(state.wanted) / state.wanted.max(1);
                note(format!("{percent:3} % {}", state.describe()));
            }
            Self::Lines(_) | Self::Silent => {}
        }
    }

    /// Says something besides.
    pub fn say(&self, text: &str) {
        match self {
            Self::Bar(bar) => bar.println(text),
            Self::Lines(_) => note(text),
            Self::Silent => {}
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_time_left_are_said_once_they_are_known() {
        let mut state = State {
            elapsed: Duration::from_secs(2),
            units: 0,
            samples: 0,
            wanted: 30_000,
            packets: 1,
        };
        assert_eq!(state.describe(), "waiting for the first unit");
        state = State {
            units: 10,
            samples: 10_000,
            packets: 12,
            ..state
        };
        assert_eq!(
            state.describe(),
            "10 units, 5,000 samples/s, 6 packets/s, 4 seconds left"
        );
    }
}
