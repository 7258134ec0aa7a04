//! How far it is: a bar on a terminal, a line every few seconds elsewhere.

use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressStyle};

use super::events::{Event, State};
use crate::platform::console::note;

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

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
            HumanCount(self.units as u64),
            HumanCount(rate as u64),
            self.packets as f64 / seconds,
            HumanDuration(left),
        )
    }
}

/// Says how far a collection is and what happens to its cores, in a thread of its own: it may take its time over a terminal, and over
/// the place in an image where a core failed.
#[derive(Debug)]
pub struct Progress {
    events: Sender<Event>,
    thread: JoinHandle<()>,
}

impl Progress {
    /// A bar on standard error if that is a terminal, else lines.
    pub fn on_stderr() -> Self {
        let (events, received) = channel();
        let thread = thread::spawn(move || Display::on_stderr().follow(&received));
        Self { events, thread }
    }

    /// Shows this, soon.
    pub fn see(&self, event: Event) {
        // Of units there are too many for people, who see their number.
        if matches!(event, Event::Unit { .. }) {
            return;
        }
        // It has ended only if it panicked, which the user has seen.
        let _gone = self.events.send(event);
    }

    /// Shows what is left to be shown, and takes the bar away.
    pub fn finish(self) {
        drop(self.events);
        let _panicked = self.thread.join();
    }
}

/// What people see.
#[derive(Debug)]
enum Display {
    /// A bar, redrawn in place.
    Bar(ProgressBar),
    /// Lines; holds the time of the last one.
    Lines(Duration),
}

impl Display {
    fn on_stderr() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::Lines(Duration::ZERO);
        }
        let style = ProgressStyle::with_template("{wide_bar} {percent}% {msg}");
        // The template is a constant; were it wrong, the default style would still say how far it is.
        Self::Bar(ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())))
    }

    fn follow(mut self, events: &Receiver<Event>) {
        for event in events {
            match event {
                Event::State(state) => self.show(&state),
                other => self.say(&described(&other)),
            }
        }
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }

    fn show(&mut self, state: &State) {
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
            Self::Lines(_) => {}
        }
    }

    fn say(&self, text: &str) {
        match self {
            Self::Bar(bar) => bar.println(text),
            Self::Lines(_) => note(text),
        }
    }
}

/// An event in words.
fn described(event: &Event) -> String {
    match event {
        Event::State(state) => state.describe(),
        Event::Unit { core, unit, ticks } => format!("core {core} took {ticks} ticks for unit {unit}"),
        Event::Restarted {
            core,
            time,
            most,
            cause,
        } => format!(
            "core {core} is started again ({time} of {most}): {}",
            cause.explained()
        ),
        Event::Retired { core, cause } => format!("core {core} is gone: {}", cause.explained()),
        Event::Late { core } => format!("core {core} is silent; its work goes to the others"),
        Event::Silence { lasts } => format!(
            "no core has said anything for {:.0} s; they may be at work, and are waited for. Ctrl-C ends this and keeps what \
             there is of the picture; --patience SECONDS would say how long to wait",
            lasts.as_secs_f64()
        ),
        Event::Logged(line) => line.clone(),
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

    #[test]
    fn a_long_silence_comes_with_what_the_user_can_do() {
        let lasts = Duration::from_secs(20);
        let said = described(&Event::Silence { lasts });
        assert!(said.contains("for 20 s") && said.contains("--patience"), "{said}");
    }
}
