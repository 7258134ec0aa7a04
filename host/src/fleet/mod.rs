//! The cores of a run: started together, watched, and ended when the run ends, however it ends.

pub mod capture;
mod core;
mod elsewhere;
mod log;
mod native;
mod qemu;
pub mod session;

pub use self::core::{Core, capture_of};
pub use elsewhere::Elsewhere;
pub use native::NativeFleet;
pub(crate) use qemu::bound_to_this_process;
#[cfg(test)]
pub(crate) use qemu::tests::{cores, fake_qemu};
pub use qemu::{QemuFleet, run_recorded, run_to_end, run_with_peer};

use std::io;
use std::path::Path;

/// Times an emulated core is started again at most.
pub const RESTARTS: usize = 3;

/// What is said of a core that has not ended.
const RUNNING: &str = "still running";

/// Lines of a core's output that are kept for a report of its end.
const LAST_LINES: usize = 5;

/// Why a fleet could not be started.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// A core's files could not be written.
    #[error("cannot write {path} (give another --out or make room)")]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },
    /// What a core logs could not be read.
    #[error(transparent)]
    Log(#[from] crate::firmware::log::LogError),
    /// The emulator could not be started.
    #[error("core {core}: cannot start {program}")]
    Start {
        /// The core.
        core: u16,
        /// The program.
        program: String,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },
}

/// What becomes of an error at a core's file.
fn unusable(path: &Path) -> impl FnOnce(io::Error) -> FleetError {
    let path = path.to_owned();
    move |cause| FleetError::File { path, cause }
}

/// The cores of a run. Dropping it ends them.
///
/// Another kind of fleet is another file here, and a line where [`crate::render`] chooses one.
pub trait Fleet {
    /// What may be concluded from its cores' ends and silences.
    fn policy(&self) -> Policy;

    /// Cores that ended since the last call.
    fn newly_ended(&mut self) -> Vec<u16> {
        Vec::new()
    }

    /// What is known about a core's life or its end, in words.
    fn how_ended(&self, core: u16) -> String;

    /// Starts a core that has ended again, where that may help, and says whether it did.
    fn start_again(&mut self, _core: u16) -> Result<bool, FleetError> {
        Ok(false)
    }

    /// The image that a core runs, where it is a file.
    fn image(&self, _core: u16) -> Option<&Path> {
        None
    }

    /// The last lines that a core wrote on its console.
    fn last_output(&self, _core: u16) -> Vec<String> {
        Vec::new()
    }

    /// Warnings and errors that the cores have logged since the last call. With all else they go to the fleet's log, too.
    fn warnings(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Ends the cores, and returns their last warnings.
    fn end(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// The sum of the peak memory of the cores' own processes, in bytes.
    fn peak_memory(&self) -> u64 {
        0
    }
}

/// What a collector may conclude from the ends and silences of a fleet's cores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Policy {
    /// Times that a core which fails is started again at most.
    pub restarts: usize,
    /// Whether the fleet sees a core end, so that a core's own word of it need not be taken for the end.
    pub sees_ends: bool,
    /// How long all cores may be silent.
    pub patience: Patience,
}

/// How long all cores of a fleet may be silent before it is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// For ever: somebody looks at them, and they stand still meanwhile.
    Endless,
    /// For as long as they live; the user may want it to be shorter.
    WhileTheyLive,
    /// For long in comparison to what their units took, because nobody sees whether they live; the user may want it otherwise.
    InUnits,
}
