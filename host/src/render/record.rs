//! A render on one core whose execution is recorded: what is profiled.
//!
//! The core is one of a real session, and what it renders is counted and thrown away: the recording is what is kept.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use std::{env, io};

use cycles::file::{self, FileError};
use cycles::flow::{Flow, Recording};

use super::options::{PictureOptions, Reference};
use super::{Job, RenderError};
use crate::collector::{self, CollectError, Collection, End, Progress};
use crate::firmware::board::Board;
use crate::firmware::symbols::unit_renderer;
use crate::firmware::{FirmwareError, Image};
use crate::fleet::session::{Route, Session};
use crate::fleet::{Core, Fleet, QemuFleet, Recorder};
use crate::platform::interrupt;
use crate::platform::setup::{self, Install, SetupError, Wanted};

/// The plugin, which lies beside the program that uses it.
const PLUGIN: &str = "libcycles_plugin.so";
/// How long a core that has been told to stop may take until its recording is written.
const END_WITHIN: Duration = Duration::from_secs(30);

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The plugin has not been built.
    #[error("the plugin {} is not there: start this by `cargo xtask`, which builds it", .0.display())]
    NoPlugin(PathBuf),
    /// This program does not know where it lies.
    #[error("cannot find out where this program lies, to look for the plugin beside it")]
    NoPlace(#[source] io::Error),
    /// The emulator has no plugins, or others.
    #[error(
        "this QEMU does not take the plugin that records what a core executes, made for version 1 of QEMU's plugin interface as \
         in Debian 12's qemu-system-arm 7.2; it said: {0}"
    )]
    Refused(String),
    /// The core ended too early.
    #[error("the core ended while it was recorded, so nothing is said of what it cost: {0}")]
    Died(String),
    /// The recording is of no use.
    #[error(transparent)]
    File(#[from] FileError),
    /// The recording is of something else than what was rendered.
    #[error(
        "the recording has {found} calls of the function that renders a unit, and {expected} units were rendered"
    )]
    Calls {
        /// As recorded.
        found: u64,
        /// As rendered.
        expected: u64,
    },
}

/// A render, and what its core executed.
#[derive(Debug)]
pub struct Recorded {
    /// The image.
    pub elf: PathBuf,
    /// The scene's name.
    pub scene: String,
    /// Samples of the picture.
    pub samples: u64,
    /// Rays traced for them.
    pub rays: u64,
    /// What ran while units were rendered.
    pub recording: Recording,
}

/// Renders a picture on one core of a board, whatever number of cores the options name, and records what it executes. Files are in
/// the options' folder for results.
pub fn record(
    options: &PictureOptions,
    board: Board,
    install: Install,
    interrupted: &AtomicBool,
) -> Result<Recorded, RecordError> {
    let plugin = plugin()?;
    let job = Job::new(&PictureOptions {
        cores: 1,
        reference: Some(Reference::None),
        ..options.clone()
    })?;
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, install).map_err(RenderError::from)?;
    let (Some(qemu), Some(toolchain)) = (&tools.qemu, &tools.firmware) else {
        let missing = SetupError::StillMissing("QEMU or a compiler".to_owned());
        return Err(RenderError::from(missing).into());
    };
    let Image { elf, .. } = job.image(toolchain, board, None)?;
    let entry = unit_renderer(&elf).map_err(|error| RenderError::from(FirmwareError::from(error)))?;
    let socket = collector::bind(Ipv4Addr::LOCALHOST, 0).map_err(RenderError::from)?;
    let port = socket
        .local_addr()
        .map_err(|cause| RenderError::from(CollectError::Socket(cause)))?;
    let session = job.session();
    let boot_block = session
        .boot_block(0, &Route::qemu(port.port()))
        .map_err(RenderError::TooLong)?;
    let recording = job.out().join("flow");
    let core = Core {
        recorder: Some(Recorder {
            plugin,
            entry,
            file: recording.clone(),
        }),
        ..Core::new(0, board, &elf, boot_block)
    };
    job.clear()?;
    interrupt::finish_first();
    let fleet = QemuFleet::start(qemu, &[core], &job.out().join("cores")).map_err(RenderError::from)?;
    let collection = collect(&session, &socket, fleet, interrupted)?;
    let recording = file::read(&recording)?;
    let (found, expected) = (calls(&recording), session.plan.units().unwrap_or_default().into());
    if found != expected {
        return Err(RecordError::Calls { found, expected });
    }
    Ok(Recorded {
        elf,
        scene: job.scene.name,
        samples: session.samples(),
        rays: collection.rays(),
        recording,
    })
}

/// Collects the picture, until its core has ended by itself.
fn collect(
    session: &Session,
    socket: &UdpSocket,
    mut fleet: QemuFleet,
    interrupted: &AtomicBool,
) -> Result<Collection, RecordError> {
    let progress = Progress::on_stderr();
    let collection = collector::collect(session, socket, &mut fleet, None, interrupted, &mut |event| {
        progress.see(event);
    });
    progress.finish();
    let collection = collection.map_err(RenderError::from)?;
    match &collection.end {
        End::Complete => match fleet.await_ends(END_WITHIN) {
            Ok(()) => Ok(collection),
            Err(how) => Err(RecordError::Died(how)),
        },
        End::Interrupted => Err(RenderError::Interrupted("nothing was kept".to_owned()).into()),
        End::Deserted(why) => {
            let refusal = fleet
                .last_output(0)
                .into_iter()
                .find(|line| line.contains("plugin"));
            Err(refusal.map_or_else(|| RecordError::Died(why.clone()), RecordError::Refused))
        }
    }
}

/// Where the plugin is.
fn plugin() -> Result<PathBuf, RecordError> {
    let program = env::current_exe().map_err(RecordError::NoPlace)?;
    let plugin = program.parent().unwrap_or(Path::new("/")).join(PLUGIN);
    if plugin.is_file() {
        Ok(plugin)
    } else {
        Err(RecordError::NoPlugin(plugin))
    }
}

/// How often the recorded function was called.
fn calls(recording: &Recording) -> u64 {
    let begins = |flow: &Flow| -> u64 {
        let first = flow.edges.iter().filter(|edge| edge.from.is_none());
        first.map(|edge| edge.count).sum()
    };
    recording.segments.iter().map(begins).sum()
}
