//! The collector: takes in what the cores send, hands out what is left to do, and ends when the picture is complete.
//!
//! ```text
//!   socket ──> intake (is it ours?) ──> leases (is it new?) ──> film (add)
//!                                          │
//!   socket <── LEASE <─────────────────────┘        fleet: who has ended?
//! ```
//!
//! Everything happens in the caller's thread: one packet is taken, judged and answered before the next. What decides
//! is in parts that know neither socket nor clock: [`leases`], [`intake`], [`sequence`], [`silence`]. Their time is the one in which
//! somebody looked at the socket ([`attended`]).

pub mod attended;
pub mod intake;
pub mod leases;
pub mod pace;
mod progress;
mod run;
pub mod sequence;
pub mod silence;
mod socket;

use std::net::SocketAddr;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use wire::{Farewell, Name};

use crate::fleet::Fleet;
use crate::image::film::Film;
use sequence::Sequence;

pub use progress::Progress;
pub use run::{CollectError, collect};
pub use socket::{BindError, bind};

/// What the collector knows of one core.
#[derive(Clone, Debug, Default)]
pub struct CoreRecord {
    /// The core's number.
    pub core: u16,
    /// Where its last packet came from. That may change within a run; a core is known by what its packets say.
    pub source: Option<SocketAddr>,
    /// When its last packet came, in time [attended](attended::Attended).
    pub heard: Option<Duration>,
    /// Units of it that counted.
    pub units: u64,
    /// 24 MHz ticks it spent on them.
    pub ticks: u64,
    /// Rays it traced for them.
    pub rays: u64,
    /// Its packet numbers.
    pub sequence: Sequence,
    /// Its board, as it says itself.
    pub board: Option<Name>,
    /// What it said when it was told to stop.
    pub farewell: Option<Farewell>,
    /// What it said when it failed, in the life it has or had last.
    pub last_words: Option<String>,
    /// How it ended for good before it was told to, by its own or the fleet's word.
    pub ended: Option<String>,
    /// Why it was started again, each time.
    pub restarts: Vec<String>,
}

impl CoreRecord {
    /// The last thing that went wrong with it.
    pub fn fault(&self) -> Option<&str> {
        let latest = self.last_words.as_ref().or(self.ended.as_ref());
        latest.or(self.restarts.last()).map(String::as_str)
    }

    /// What is known about its end, `now`.
    fn describe(&self, fleet: &Fleet, now: Duration) -> String {
        let heard = match self.heard {
            Some(heard) => format!("last heard {:.1} s ago", now.saturating_sub(heard).as_secs_f64()),
            None => "never heard".to_owned(),
        };
        let mut text = format!("\n  core {}: {}, {heard}", self.core, fleet.how_ended(self.core));
        if !self.restarts.is_empty() {
            text.push_str(&format!(", started again {} times", self.restarts.len()));
        }
        if let Some(words) = &self.last_words {
            text.push_str(&format!("\n    its last words: {words}"));
        }
        for line in fleet.last_output(self.core) {
            text.push_str(&format!("\n    {line}"));
        }
        text
    }

    /// It has a new life, because its last one ended with `why`: it numbers its packets anew, and nobody knows yet where it is.
    fn start_again(&mut self, why: String) {
        self.restarts.push(why);
        self.sequence.start_again();
        (self.last_words, self.source) = (None, None);
    }
}

/// How a collection ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// Every unit is in.
    Complete,
    /// The caller asked to end early.
    Interrupted,
    /// No core is left that says anything; the text says why and names the cores.
    Deserted(String),
}

/// Packet counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packets {
    /// Pixel packets that arrived.
    pub received: u64,
    /// Of those, units that were already in the film.
    pub duplicate: u64,
    /// Packets that were not understood, or belong to another session, scene or epoch.
    pub rejected: u64,
    /// Gaps in the cores' running numbers.
    pub lost: u64,
}

/// What was collected; complete or not, as `end` says.
#[derive(Debug)]
pub struct Collection {
    /// The picture as far as it came.
    pub film: Film,
    /// How it ended.
    pub end: End,
    /// The packets' accounts.
    pub packets: Packets,
    /// The cores, in order of their numbers.
    pub cores: Vec<CoreRecord>,
    /// From the start to the last unit.
    pub elapsed: Duration,
}

impl Collection {
    /// 24 MHz ticks that the cores spent on the units of the picture.
    pub fn ticks(&self) -> u64 {
        self.cores.iter().map(|core| core.ticks).sum()
    }

    /// Rays traced for the units of the picture.
    pub fn rays(&self) -> u64 {
        self.cores.iter().map(|core| core.rays).sum()
    }

    /// The most stack any core used and the size of that stack, where a core measured it.
    pub fn stack(&self) -> Option<(u32, u32)> {
        let measured = self
            .cores
            .iter()
            .filter_map(|core| core.farewell)
            .filter(|farewell| farewell.stack_size > 0);
        measured
            .map(|farewell| (farewell.stack_used, farewell.stack_size))
            .max()
    }
}

#[cfg(test)]
mod faulty_network;
#[cfg(test)]
mod tests;
