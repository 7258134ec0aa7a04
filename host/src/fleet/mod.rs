//! The cores of a run: started together, watched, and ended when the run ends, however it ends.

pub mod capture;
mod core;
mod log;
mod native;
mod qemu;
pub mod session;

pub use self::core::{Core, capture_of};
pub use native::NativeFleet;
pub(crate) use qemu::bound_to_this_process;
#[cfg(test)]
pub(crate) use qemu::tests::{cores, fake_qemu};
pub use qemu::{QemuFleet, run_to_end, run_with_peer};

use std::io;
use std::path::Path;

/// Times a core is started again at most.
pub const RESTARTS: usize = 3;

/// Lines of a core's output that are kept for a report of its end.
const LAST_LINES: usize = 5;

/// Why a fleet could not be started.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// A core's files could not be written.
    #[error("cannot write {path}: {cause}; give another --out or make room")]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// What a core logs could not be read.
    #[error(transparent)]
    Log(#[from] crate::firmware::log::LogError),
    /// The emulator could not be started.
    #[error("core {core}: cannot start {program}: {cause}")]
    Start {
        /// The core.
        core: u16,
        /// The program.
        program: String,
        /// What the system said.
        cause: std::io::Error,
    },
}

/// What becomes of an error at a core's file.
fn unusable(path: &Path) -> impl FnOnce(io::Error) -> FleetError {
    let path = path.to_owned();
    move |cause| FleetError::File { path, cause }
}

/// The cores of a run. Dropping it ends them.
#[derive(Debug)]
pub enum Fleet {
    /// One QEMU process a core.
    Qemu(QemuFleet),
    /// The same under a debugger, which may make it stand still for any time.
    Debugged(QemuFleet),
    /// One thread of this host a core.
    Native(NativeFleet),
    /// Somebody else starts and ends them.
    Elsewhere,
}

impl Fleet {
    /// Cores that ended since the last call.
    pub fn newly_ended(&mut self) -> Vec<u16> {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.newly_ended(),
            Self::Native(fleet) => fleet.newly_ended(),
            Self::Elsewhere => Vec::new(),
        }
    }

    /// What is known about the end of a core, in words.
    pub fn how_ended(&self, core: u16) -> String {
        let known = match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.how_ended(core),
            Self::Native(fleet) => fleet.how_ended(core),
            Self::Elsewhere => return "started elsewhere".to_owned(),
        };
        known.unwrap_or_else(|| "still running".to_owned())
    }

    /// Starts a core that has ended again, where that may help, and says whether it did.
    ///
    /// A thread of this host is not started again, as it runs the very program that looks after it; nor is a core under a debugger,
    /// whose end somebody looks at.
    pub fn start_again(&mut self, core: u16) -> Result<bool, FleetError> {
        match self {
            Self::Qemu(fleet) => fleet.start_again(core),
            Self::Debugged(_) | Self::Native(_) | Self::Elsewhere => Ok(false),
        }
    }

    /// Whether a core that fails tells it to the fleet too, by its end.
    pub fn sees_ends(&self) -> bool {
        !matches!(self, Self::Elsewhere)
    }

    /// The image that a core runs.
    pub fn image(&self, core: u16) -> Option<&Path> {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.image(core),
            Self::Native(_) | Self::Elsewhere => None,
        }
    }

    /// The last lines that a core wrote on its console.
    pub fn last_output(&self, core: u16) -> Vec<String> {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.last_output(core),
            Self::Native(_) | Self::Elsewhere => Vec::new(),
        }
    }

    /// Warnings and errors that the cores have logged since the last call. With all else they go to the fleet's log, too.
    pub fn warnings(&mut self) -> Vec<String> {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.warnings(),
            Self::Native(_) | Self::Elsewhere => Vec::new(),
        }
    }

    /// Ends the cores, and returns their last warnings.
    pub fn end(self) -> Vec<String> {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.end(),
            Self::Native(_) | Self::Elsewhere => Vec::new(),
        }
    }

    /// The sum of the peak memory of the cores' own processes, in bytes.
    pub fn peak_memory(&self) -> u64 {
        match self {
            Self::Qemu(fleet) | Self::Debugged(fleet) => fleet.peak_memory(),
            Self::Native(_) | Self::Elsewhere => 0,
        }
    }
}
