//! The collector: takes in what the cores send, hands out what is left to do, and ends when the picture is complete.
//!
//! ```text
//!   socket ──> intake (is it ours?) ──> leases (is it new?) ──> film (add)
//!                                          │
//!   socket <── LEASE <─────────────────────┘        fleet: who has ended?
//! ```
//!
//! Everything happens in the caller's thread: one packet is taken, judged and answered before the next. What decides is the
//! [engine], which knows neither socket nor clock nor fleet, and its parts: [`leases`], [`intake`], [`sequence`], [`silence`]. Time is
//! that in which somebody looked at the socket ([`attended`]). Whoever wants to watch gets [events](Event): the [progress](Progress)
//! that people see is one that does, in a thread of its own.

pub mod attended;
pub mod cores;
pub mod engine;
pub mod events;
pub mod intake;
pub mod leases;
pub mod pace;
mod progress;
mod run;
pub mod sequence;
pub mod silence;
mod socket;

use std::io;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::image::film::{Film, FilmError};

pub use cores::{Cause, CoreRecord};
pub use events::Event;
pub use progress::Progress;
pub use run::collect;
pub use socket::{BindError, bind};

/// Why a collection could not go on.
#[derive(Debug, thiserror::Error)]
pub enum CollectError {
    /// The socket failed.
    #[error("the collector's socket failed")]
    Socket(#[from] io::Error),
    /// A unit could not be added.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The picture is cut into more units than there are numbers for.
    #[error("the picture has more than 2^32 units; choose a smaller --size or --spp")]
    TooManyUnits,
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Packets {
    /// Pixel packets that arrived.
    pub received: u64,
    /// Of those, units that were already in the film.
    pub duplicate: u64,
    /// Packets that were not understood, or belong to another session, scene or epoch.
    pub rejected: u64,
    /// Gaps in the cores' running numbers.
    pub lost: u64,
    /// The share of what arrived that was duplicate: work done twice, or packets that the network doubled.
    pub duplicate_share: f64,
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
mod leases_simulation;
#[cfg(test)]
mod tests;
