//! A picture rendered on emulated cores for what its units cost: each unit's ticks of its core's clock, which counts instructions, and by
//! QEMU's plugin what all of them cost in cycles.
//!
//! Units are leased as in any render, but only once every core has said that it is there: all take part, however slowly this host
//! starts them.

use std::collections::BTreeSet;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::AsFd;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use cycles::Cycles;
use cycles::flow::{Flow, Recording};
use tracer::unit::Plan;
use wire::{MAX_PAYLOAD, Message};

use super::cycles::Meter;
use super::options::PictureOptions;
use super::{Job, Kind, RenderError, boot_blocks};
use crate::collector::intake::judge;
use crate::collector::{self, CollectError, Collection, End, Event, Progress};
use crate::firmware::board::Board;
use crate::firmware::symbols::functions;
use crate::firmware::{FirmwareError, Recipe};
use crate::fleet::session::{Route, Session};
use crate::fleet::{Core, Fleet, QemuFleet};
use crate::oracle::direct;
use crate::platform::interrupt;
use crate::platform::setup::{self, Install, SetupError, Toolchain, Wanted};
use crate::platform::wait;

/// Time between two looks whether cores have ended before they said a word.
const TICK: Duration = Duration::from_millis(20);
/// The function of a core's loop that puts a packet together and sends it.
const SENDER: &str = "node::worker::Worker>::send";

/// What is recorded of cores, to be priced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorded {
    /// Nothing: cores have twice the speed.
    Nothing,
    /// The rendering of units.
    Units,
    /// The sending of packets.
    Packets,
}

/// A picture whose units are to be timed.
#[derive(Clone, Debug)]
pub struct TimedPicture {
    /// The picture. It is compared with nothing.
    pub picture: PictureOptions,
    /// Samples of a pixel in one unit: a multiple of 4, at most [`wire::MAX_SAMPLES`].
    pub samples_per_unit: u16,
    /// The board of all cores.
    pub board: Board,
    /// What is recorded.
    pub recorded: Recorded,
}

/// What was recorded of a core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Calls of the recorded function.
    pub calls: u64,
    /// Instructions that they executed.
    pub instructions: u64,
    /// What these cost by the processor's model.
    pub cycles: Cycles,
}

/// A unit, once rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimedUnit {
    /// The core that did it.
    pub core: u16,
    /// Ticks of its clock of 24 MHz, in which an instruction is a nanosecond.
    pub ticks: u32,
}

/// A picture whose units were timed.
#[derive(Clone, Debug)]
pub struct Timed {
    /// The scene's name.
    pub scene: String,
    /// How it was cut.
    pub plan: Plan,
    /// SHA-256 of the film's integer sums and counts.
    pub image_sha256: String,
    /// All units, by their ids.
    pub units: Vec<TimedUnit>,
    /// What was recorded of each core, in order of their numbers; none where nothing was to be.
    pub counted: Vec<Counted>,
    /// Sums that were greater than a packet holds.
    pub saturated_sums: u64,
    /// Seconds of this host until all cores were there, and from then on until the last unit was in.
    pub wall: [Duration; 2],
}

impl Timed {
    /// Samples of the picture.
    pub fn samples(&self) -> u64 {
        u64::from(self.plan.width) * u64::from(self.plan.height) * u64::from(self.plan.spp)
    }

    /// Cores that rendered something.
    pub fn cores_at_work(&self) -> usize {
        let cores: BTreeSet<u16> = self.units.iter().map(|unit| unit.core).collect();
        cores.len()
    }
}

/// The emulator and the images that were built for it.
#[derive(Debug)]
pub struct Stand {
    qemu: PathBuf,
    toolchain: Toolchain,
    built: Vec<(Board, Recipe, PathBuf)>,
}

impl Stand {
    /// Finds the programs, or installs them.
    pub fn new(install: Install) -> Result<Self, RenderError> {
        let wanted = Wanted {
            qemu: true,
            firmware: true,
            ..Wanted::default()
        };
        let tools = setup::ensure(wanted, install)?;
        match (tools.qemu, tools.firmware) {
            (Some(qemu), Some(toolchain)) => Ok(Self {
                qemu,
                toolchain,
                built: Vec::new(),
            }),
            _ => Err(SetupError::StillMissing("QEMU or a compiler".to_owned()).into()),
        }
    }

    /// Renders the picture on its cores. Files are in the picture's folder for results.
    pub fn render(&mut self, timed: &TimedPicture, interrupted: &AtomicBool) -> Result<Timed, RenderError> {
        let job = timed.job()?;
        let elf = self.image(&job, timed.board)?;
        let socket = collector::bind(Ipv4Addr::LOCALHOST, 0)?;
        let port = socket.local_addr().map_err(CollectError::Socket)?.port();
        let session = job.session();
        let blocks = boot_blocks(&session, &Route::qemu(port))?;
        job.clear()?;
        let numbered = (0..).zip(blocks);
        let mut cores: Vec<Core> = numbered
            .map(|(number, block)| Core::new(number, timed.board, &elf, block))
            .collect();
        let folder = job.out().join("cores");
        let meter = (timed.recorded != Recorded::Nothing)
            .then(|| Meter::attach(&self.qemu, &mut cores, &folder, 0))
            .transpose()?;
        if timed.recorded == Recorded::Packets {
            let senders = functions(&elf, SENDER).map_err(FirmwareError::from)?;
            let recorders = cores.iter_mut().filter_map(|core| core.recorder.as_mut());
            recorders.for_each(|recorder| recorder.entries.clone_from(&senders));
        }
        interrupt::finish_first();
        let start = Instant::now();
        let mut fleet = QemuFleet::start(&self.qemu, &cores, &folder)?;
        muster(&session, &socket, &mut fleet, interrupted)?;
        let mustered = start.elapsed();
        let (units, collection) = collect(&session, &socket, &mut fleet, interrupted)?;
        let wall = [mustered, collection.elapsed];
        let _warnings_of_nobody = fleet.end();
        let recordings = meter.map_or(Ok(Vec::new()), |meter| meter.read(&fleet))?;
        interrupt::end_at_once("nothing was kept".to_owned());
        Ok(Timed {
            scene: job.scene.name.clone(),
            plan: job.plan,
            image_sha256: collection.film.sha256(),
            units,
            counted: recordings.iter().map(Counted::of).collect(),
            saturated_sums: collection.film.saturated(),
            wall,
        })
    }

    /// The job's image, built once.
    fn image(&mut self, job: &Job, board: Board) -> Result<PathBuf, RenderError> {
        let recipe = job.recipe();
        let known = self
            .built
            .iter()
            .find(|(of, by, _)| (*of, *by) == (board, recipe));
        if let Some((.., elf)) = known {
            return Ok(elf.clone());
        }
        let image = job.image(&self.toolchain, board, Kind::default())?;
        self.built.push((board, recipe, image.elf.clone()));
        Ok(image.elf)
    }
}

impl TimedPicture {
    fn job(&self) -> Result<Job, RenderError> {
        let mut job = Job::new(&self.picture)?;
        job.plan.samples_per_unit = self.samples_per_unit;
        job.plan.units().ok_or(RenderError::TooManyUnits)?;
        Ok(job)
    }

    /// The SHA-256 of the film that any fleet must end with, rendered by this host.
    pub fn expected_sha256(&self) -> Result<String, RenderError> {
        let job = self.job()?;
        let (profile, sampler) = (self.picture.profile, self.picture.sampler());
        Ok(direct::film_as(profile, sampler, &job.compiled, &job.plan).sha256())
    }
}

impl Counted {
    fn of(recording: &Recording) -> Self {
        let flows = &recording.segments;
        Self {
            calls: recording.calls(),
            instructions: flows.iter().map(Flow::instructions).sum(),
            cycles: flows.iter().map(|flow| cycles::cycles(flow, 0)).sum(),
        }
    }
}

/// Waits until every core has said that it has nothing to do. They say it again once somebody answers.
fn muster(
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut QemuFleet,
    interrupted: &AtomicBool,
) -> Result<(), RenderError> {
    let mut present = BTreeSet::new();
    let mut buffer = [0; MAX_PAYLOAD + 1];
    socket.set_nonblocking(true).map_err(CollectError::Socket)?;
    while present.len() < usize::from(session.cores) {
        if interrupted.load(Ordering::Relaxed) {
            return Err(RenderError::Interrupted("nothing was kept".to_owned()));
        }
        // An error means that nothing has come yet; a broken socket is the collector's to report.
        if let Ok((len, _)) = socket.recv_from(&mut buffer) {
            let said = judge(session, &buffer[..len]).ok();
            present.extend(
                said.filter(|said| matches!(said.message, Message::Hello(_)))
                    .map(|said| said.core),
            );
            continue;
        }
        if let Some(&core) = fleet.newly_ended().first() {
            let lines = fleet.last_output(core).join("\n    ");
            return Err(RenderError::Deserted {
                why: format!("core {core} said no word: {}\n    {lines}", fleet.how_ended(core)),
                kept: "nothing was kept".to_owned(),
            });
        }
        wait([socket.as_fd()], TICK);
    }
    Ok(())
}

/// Collects the picture, and what each of its units took.
fn collect(
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut QemuFleet,
    interrupted: &AtomicBool,
) -> Result<(Vec<TimedUnit>, Collection), RenderError> {
    let count = session.plan.units().ok_or(RenderError::TooManyUnits)?;
    let mut units = vec![TimedUnit::default(); count as usize];
    let progress = Progress::on_stderr();
    let collection = collector::collect(
        session,
        socket,
        fleet,
        None,
        interrupted,
        &mut |event| match event {
            Event::Unit { core, unit, ticks } => {
                if let Some(timed) = units.get_mut(unit as usize) {
                    *timed = TimedUnit { core, ticks };
                }
            }
            other => progress.see(other),
        },
    );
    progress.finish();
    let collection = collection?;
    let kept = "nothing was kept".to_owned();
    match &collection.end {
        End::Complete => Ok((units, collection)),
        End::Interrupted => Err(RenderError::Interrupted(kept)),
        End::Deserted(why) => Err(RenderError::Deserted {
            why: why.clone(),
            kept,
        }),
    }
}
