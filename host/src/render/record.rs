//! A render on one core whose execution is recorded: what is profiled.
//!
//! The core is one of a real session, and what it renders is counted and thrown away: the recording is what is kept.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use cycles::file::{self, FileError};
use cycles::flow::Recording;

use super::options::{PictureOptions, Reference};
use super::{Job, RenderError};
use crate::collector::{self, CollectError, Collection, End, Progress};
use crate::firmware::board::Board;
use crate::firmware::plugin::{self, PluginError, Recorder};
use crate::firmware::symbols::unit_renderer;
use crate::firmware::{FirmwareError, Image};
use crate::fleet::session::{Route, Session};
use crate::fleet::{Core, QemuFleet};
use crate::platform::interrupt;
use crate::platform::setup::{self, Install, SetupError, Wanted};

/// How long a core that has been told to stop may take until its recording is written.
const END_WITHIN: Duration = Duration::from_secs(30);

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// There is nothing to record with.
    #[error(transparent)]
    Plugin(#[from] PluginError),
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
    let plugin = plugin::ready(qemu)?;
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
            entries: vec![entry],
            each: false,
            file: recording.clone(),
        }),
        ..Core::new(0, board, &elf, boot_block)
    };
    job.clear()?;
    interrupt::finish_first();
    let fleet = QemuFleet::start(qemu, &[core], &job.out().join("cores")).map_err(RenderError::from)?;
    let collection = collect(&session, &socket, fleet, interrupted)?;
    let recording = file::read(&recording)?;
    let (found, expected) = (recording.calls(), session.plan.units().unwrap_or_default().into());
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
        End::Deserted(why) => Err(RecordError::Died(why.clone())),
    }
}
