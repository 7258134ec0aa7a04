//! What the collector knows of each core.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use wire::{Farewell, FaultInfo, Name};

use super::sequence::Sequence;
use crate::firmware::symbols;
use crate::fleet::Fleet;

/// Why a core ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// It said so itself.
    Fault(Fault),
    /// The fleet saw it, and says this.
    Ended(String),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fault(fault) => &fault.reason,
            Self::Ended(how) => how,
        })
    }
}

impl Cause {
    /// In words; for a fault, with the place in the source where the image tells it. That reads the image's debug information: not
    /// for a loop that has a socket to empty.
    pub fn explained(&self) -> String {
        match self {
            Self::Fault(fault) => fault.explained(),
            Self::Ended(how) => how.clone(),
        }
    }
}

/// What a core said when it failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Its words.
    pub reason: String,
    /// Where it happened, if it knows.
    pub address: Option<u32>,
    /// Its image.
    pub image: Option<PathBuf>,
}

impl Fault {
    fn explained(&self) -> String {
        let (reason, address) = (self.reason.as_str(), self.address);
        match &self.image {
            Some(elf) => symbols::explained(elf, &FaultInfo { reason, address }),
            None => reason.to_owned(),
        }
    }
}

/// What the collector knows of one core.
#[derive(Clone, Debug, Default)]
pub struct CoreRecord {
    /// The core's number.
    pub core: u16,
    /// Its image, where it is a file.
    pub image: Option<PathBuf>,
    /// Where its last packet came from. That may change within a run; a core is known by what its packets say.
    pub source: Option<SocketAddr>,
    /// When its last packet came, in time [attended](super::attended::Attended).
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
    pub failed: Option<Fault>,
    /// How it ended for good before it was told to.
    pub ended: Option<Cause>,
    /// Why it was started again, each time.
    pub restarts: Vec<Cause>,
}

impl CoreRecord {
    /// What it says, with the image it says it of.
    pub(super) fn fault(&self, said: &FaultInfo<'_>) -> Fault {
        Fault {
            reason: said.reason.to_owned(),
            address: said.address,
            image: self.image.clone(),
        }
    }

    /// The last thing that went wrong with it.
    pub fn trouble(&self) -> Option<Cause> {
        let fault = self.failed.clone().map(Cause::Fault);
        fault
            .or_else(|| self.ended.clone())
            .or_else(|| self.restarts.last().cloned())
    }

    /// Why it has ended: by its own word, or the fleet's, which is `how`.
    pub(super) fn cause(&self, how: impl FnOnce() -> String) -> Cause {
        let fault = self.failed.clone().map(Cause::Fault);
        fault.unwrap_or_else(|| Cause::Ended(how()))
    }

    /// It has a new life, because its last one ended by `cause`: it numbers its packets anew, and nobody knows yet where it is.
    pub(super) fn start_again(&mut self, cause: Cause) {
        self.restarts.push(cause);
        self.sequence.start_again();
        (self.failed, self.source) = (None, None);
    }

    /// What is known about its end, `now`.
    pub(super) fn describe(&self, fleet: &dyn Fleet, now: Duration) -> String {
        let heard = match self.heard {
            Some(heard) => format!("last heard {:.1} s ago", now.saturating_sub(heard).as_secs_f64()),
            None => "never heard".to_owned(),
        };
        let mut text = format!("\n  core {}: {}, {heard}", self.core, fleet.how_ended(self.core));
        if !self.restarts.is_empty() {
            text.push_str(&format!(", started again {} times", self.restarts.len()));
        }
        if let Some(fault) = &self.failed {
            text.push_str(&format!("\n    its last words: {}", fault.explained()));
        }
        for line in fleet.last_output(self.core) {
            text.push_str(&format!("\n    {line}"));
        }
        text
    }
}
