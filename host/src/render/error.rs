//! What can go wrong with a render.

use std::path::PathBuf;

use super::cycles::CyclesError;
use super::options::EpsilonError;
use crate::collector::{BindError, CollectError};
use crate::firmware::FirmwareError;
use crate::fleet::FleetError;
use crate::fleet::capture::CaptureError;
use crate::image::openexr::ReadError;
use crate::oracle::compare::CompareError;
use crate::platform::file::WriteError;
use crate::platform::setup::SetupError;
use crate::platform::workspace::NoWorkspace;
use crate::scene::SceneError;

/// Why there is no complete picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// There is no default scene, or no place for the results.
    #[error("a scene and a folder (with --out) must be named here")]
    NoWorkspace(#[from] NoWorkspace),
    /// The scene is unusable.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The folder for the results is.
    #[error("cannot write to the folder {} (choose another with --out)", path.display())]
    Out {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },
    /// Another render has it.
    #[error(
        "another render is writing its results to {}: wait until it has ended, or choose another folder with --out", .0.display()
    )]
    Busy(PathBuf),
    /// The folder did not take the results.
    #[error("{why}\nthe results are in {} instead", folder.display())]
    Elsewhere {
        /// Why.
        why: String,
        /// Where they are.
        folder: PathBuf,
    },
    /// The scene is of another size than the epsilon.
    #[error(transparent)]
    Epsilon(#[from] EpsilonError),
    /// The picture has more units than there are ids.
    #[error("the picture has more than 2^32 work units: choose a smaller --size or --spp")]
    TooManyUnits,
    /// The scene does not fit a core.
    #[error("{0}")]
    TooLong(wire::boot::TooLong),
    /// The reference file is unusable.
    #[error("the reference is of no use")]
    Reference(#[from] ReadError),
    /// The two cannot be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// The port is.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// A program is missing.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The image could not be built.
    #[error(transparent)]
    Firmware(#[from] FirmwareError),
    /// The cores could not be started.
    #[error(transparent)]
    Fleet(#[from] FleetError),
    /// The collector failed.
    #[error(transparent)]
    Collect(#[from] CollectError),
    /// A result could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A core that the session does not have.
    #[error("there is no core {core}: {cores} cores are numbered 0 to {last}; choose another --core, or more --cores",
        last = cores - 1)]
    NoSuchCore {
        /// The core asked for.
        core: u16,
        /// The session's cores.
        cores: u16,
    },
    /// Threads have no network card whose packets could be recorded.
    #[error("a core's packets can only be recorded in QEMU: leave out --backend native")]
    NoNetwork,
    /// Threads have no log.
    #[error("cores keep a log only in QEMU: leave out --log, or --backend native")]
    NoLog,
    /// Threads have no cycles.
    #[error("cycles are counted only in QEMU: leave out --cycles, or --backend native")]
    NoCycles,
    /// Threads have a floating-point unit.
    #[error("soft float is for cores in QEMU: leave out --soft-float, or --backend native")]
    NoSoftFloat,
    /// Threads have the profiles' own choices.
    #[error("a single choice is measured on cores in QEMU: leave out --choice, or --backend native")]
    NoChoice,
    /// The cycles could not be counted.
    #[error(transparent)]
    Cycles(#[from] CyclesError),
    /// The recorded packets could not be read.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The debugger could not be run.
    #[error("cannot run {}", program.display())]
    Debugger {
        /// The program.
        program: PathBuf,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },
    /// The cores are gone.
    #[error("{why}\n{kept}")]
    Deserted {
        /// Why, naming the cores.
        why: String,
        /// Where the partial picture is.
        kept: String,
    },
    /// The user wanted it to end.
    #[error("interrupted; {0}")]
    Interrupted(String),
}
