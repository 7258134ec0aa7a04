//! What a collection tells whoever watches it: a progress bar, a log, a page.

use std::time::Duration;

use super::cores::Cause;

/// Something that happened, as it happens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// How far it is, many times a second.
    State(State),
    /// A unit is in that was not in before.
    Unit {
        /// The core that rendered it.
        core: u16,
        /// Its id.
        unit: u32,
        /// Ticks of the core's clock of 24 MHz that it took.
        ticks: u32,
    },
    /// A core has failed and is started again.
    Restarted {
        /// The core.
        core: u16,
        /// Which time that is.
        time: usize,
        /// How often it may be.
        most: usize,
        /// Why.
        cause: Cause,
    },
    /// A core is gone for good; its units go to the others.
    Retired {
        /// The core.
        core: u16,
        /// Why.
        cause: Cause,
    },
    /// A core has said nothing for so long that its units go to the others.
    Late {
        /// The core.
        core: u16,
    },
    /// No core has said anything for so long that the user should know it.
    Silence {
        /// How long.
        lasts: Duration,
    },
    /// A core has logged a warning or an error.
    Logged(String),
}

/// How far a collection is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Time since the start.
    pub elapsed: Duration,
    /// Units in.
    pub units: usize,
    /// Samples in.
    pub samples: u64,
    /// Samples wanted.
    pub wanted: u64,
    /// Pixel packets received.
    pub packets: u64,
}
