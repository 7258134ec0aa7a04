//! A render on one core whose execution is recorded: what is profiled.
//!
//! The core is one of a real session, and what it renders is counted and thrown away: the recording is what is kept.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use cycles::file::{self, FileError};
use cycles::flow::{Flow, Recording};
use fixedmath::I16F16;

use super::options::{PictureOptions, Reference};
use super::{Job, Kind, RenderError};
use crate::collector::{self, CollectError, Collection, End, Progress};
use crate::firmware::board::Board;
use crate::firmware::plugin::{self, PluginError, Recorder};
use crate::firmware::symbols::unit_renderer;
use crate::firmware::{FirmwareError, Image, SoftFloat};
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
    /// It is empty.
    #[error("there is nothing to profile: the core executed nothing of the function that renders a unit")]
    Nothing,
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
    /// Something else ran in between, whose cost cannot be told apart.
    #[error(
        "an exception of the processor came between the instructions at {before:#010x} and {after:#010x}: render once more"
    )]
    Interrupted {
        /// The instruction before it.
        before: u32,
        /// The instruction after it.
        after: u32,
    },
}

/// A render, and what its core executed.
#[derive(Debug)]
pub struct Recorded {
    /// The image.
    pub elf: PathBuf,
    /// The scene's name.
    pub scene: String,
    /// A core's self-intersection epsilon.
    pub epsilon: I16F16,
    /// Samples of the picture.
    pub samples: u64,
    /// Rays traced for them.
    pub rays: u64,
    /// What ran while units were rendered.
    pub flow: Flow,
}

/// Renders a picture on one core of a board, whatever number of cores the options name, and records what it executes. Files are in
/// the options' folder for results.
pub fn record(
    options: &PictureOptions,
    board: Board,
    soft_float: Option<SoftFloat>,
    install: Install,
    interrupted: &AtomicBool,
) -> Result<Recorded, RecordError> {
    let kind = Kind {
        log: None,
        soft_float,
        choice: None,
    };
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
    let Image { elf, .. } = job.image(toolchain, board, kind)?;
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
    let units = session.plan.units().unwrap_or_default();
    let flow = flow_of(file::read(&recording)?, units.into())?;
    Ok(Recorded {
        elf,
        scene: job.scene.name,
        epsilon: job.plan.epsilon,
        samples: session.samples(),
        rays: collection.rays(),
        flow,
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

/// The flow of a recording, which must be of all that was rendered, and of nothing else.
fn flow_of(recording: Recording, expected: u64) -> Result<Flow, RecordError> {
    let found = recording.calls();
    // One, because calls are not told apart.
    let flow = recording
        .segments
        .into_iter()
        .find(|flow| flow.instructions() > 0);
    let flow = flow.ok_or(RecordError::Nothing)?;
    if found != expected {
        return Err(RecordError::Calls { found, expected });
    }
    match flow.interruption() {
        Some((before, after)) => Err(RecordError::Interrupted { before, after }),
        None => Ok(flow),
    }
}

#[cfg(test)]
mod tests {
    use cycles::flow::{Block, Edge, Instruction, Isa};

    use super::*;

    /// A function of one instruction, `bx lr`, that was called so often.
    fn recording(calls: u64) -> Recording {
        let instruction = Instruction {
            address: 0x100,
            encoding: 0xe12f_ff1e,
            bytes: 4,
        };
        let block = Block {
            instructions: vec![instruction],
            passed: vec![0],
            from_code: vec![0],
        };
        let edge = Edge {
            from: None,
            to: 0,
            count: calls,
        };
        let flow = Flow {
            isa: Isa::Arm,
            blocks: vec![block],
            edges: vec![edge],
        };
        Recording { segments: vec![flow] }
    }

    #[test]
    fn only_a_recording_of_all_units_is_taken() {
        assert!(flow_of(recording(12), 12).is_ok());
        let error = flow_of(recording(11), 12)
            .expect_err("a unit is missing")
            .to_string();
        assert!(
            error.contains("11 calls") && error.contains("12 units"),
            "{error}"
        );
        for nothing in [recording(0), Recording { segments: Vec::new() }] {
            let error = flow_of(nothing, 12).expect_err("nothing").to_string();
            assert!(error.contains("nothing to profile"), "{error}");
        }
    }

    #[test]
    fn a_recording_with_an_exception_in_it_is_refused() {
        let mut recording = recording(1);
        let flow = &mut recording.segments[0];
        // An addition, behind which something else ran than what stands there.
        flow.blocks[0].instructions[0].encoding = 0xe080_0001;
        flow.blocks.push(flow.blocks[0].clone());
        flow.blocks[1].instructions[0].address = 0x18;
        flow.edges.push(Edge {
            from: Some(0),
            to: 1,
            count: 1,
        });
        let error = flow_of(recording, 1).expect_err("an exception").to_string();
        assert!(error.contains("0x00000100 and 0x00000018"), "{error}");
    }
}
