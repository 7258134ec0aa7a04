//! A render from start to end: what `cargo xtask render` and the collector do.
//!
//! Whatever can be known to fail is looked at before anything slow starts: the flags, the scene, the folder for the
//! results, the reference file, the port, the programs that are needed. Then the image is built, the fleet started
//! and the picture collected; then it is judged and written.

mod cycles;
mod debug;
mod error;
mod folder;
pub mod options;
mod record;
pub mod report;
mod results;
pub mod timed;
mod trace;

use std::net::{Ipv4Addr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use ::cycles::flow::Recording;
use tracer::unit::Plan;
use wire::Name;

use crate::collector::{self, CollectError, Collection, End, Progress};
use crate::firmware::board::Board;
use crate::firmware::{self, Image, Recipe};
use crate::firmware::{Choice, Level, SoftFloat};
use crate::fleet::session::{Route, Session, boot_block_len};
use crate::fleet::{Core, Elsewhere, Fleet, NativeFleet, QemuFleet};
use crate::image::openexr;
use crate::image::picture::Estimate;
use crate::oracle::compare::CompareError;
use crate::platform::console::{note, patiently};
use crate::platform::interrupt;
use crate::platform::memory;
use crate::platform::setup::{self, Install, Toolchain, Tools, Wanted};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Scene, compile, samples_per_unit};
use cycles::Meter;
use folder::Folder;
use options::{Backend, PictureOptions, Reference, RenderOptions};
use report::Report;

pub use cycles::CyclesError;
pub use debug::{DebugOptions, debug};
pub use error::RenderError;
pub use record::{RecordError, Recorded, record};
pub use trace::{TraceOptions, Traced, trace};

/// A job whose flags, scene and folder are sound.
#[derive(Debug)]
pub struct Job {
    options: PictureOptions,
    scene: Scene,
    compiled: CompiledScene,
    plan: Plan,
    reference: Option<Estimate>,
    out: Folder,
}

/// A picture that is complete, judged and written.
#[derive(Clone, Debug)]
pub struct Finished {
    /// What `report.json` says.
    pub report: Report,
    /// The same in a few lines for people.
    pub summary: String,
}

/// How the cores were run, for the report.
#[derive(Clone, Debug)]
struct Origin {
    backend: &'static str,
    boards: Vec<Board>,
    images: Vec<report::Image>,
    /// The ticks count instructions: one is one virtual nanosecond.
    counts_instructions: bool,
    /// What they logged.
    log: Option<PathBuf>,
    /// What they computed in instead of fixed point.
    soft_float: Option<SoftFloat>,
    /// What was the published system's where all else was ours.
    choice: Option<Choice>,
    /// What records their flows.
    meter: Option<Meter>,
}

impl Origin {
    /// The boards' names, if there are any.
    fn boards(&self) -> Option<String> {
        let names: Vec<&str> = self.boards.iter().map(|board| board.name()).collect();
        (!names.is_empty()).then(|| names.join(","))
    }
}

impl Job {
    /// Checks everything that can be checked at once.
    pub fn new(options: &PictureOptions) -> Result<Self, RenderError> {
        let scene = Scene::load(&workspace::scene(options.scene.as_deref())?)?;
        let (width, height) = (options.size.width, options.size.height);
        scene.check_frame(width, height)?;
        let units = samples_per_unit(&scene, options.spp, options.termination.0);
        let plan = options.plan(units, scene.scale())?;
        plan.units().ok_or(RenderError::TooManyUnits)?;
        let out = Folder::open(options.out(&scene.name)?)?;
        let reference = match &options.reference {
            Some(Reference::File(path)) => Some(read_reference(path, (width, height))?),
            Some(Reference::None) | None => None,
        };
        let compiled = compile(&scene, width, height, options.integrator());
        Ok(Self {
            options: options.clone(),
            scene,
            compiled,
            plan,
            reference,
            out,
        })
    }

    /// The folder for the results.
    pub fn out(&self) -> &Path {
        self.out.path()
    }

    /// Removes what earlier runs into that folder left of their cores. For a run that is about to start; pictures stay until
    /// there are new ones.
    pub fn clear(&self) -> Result<(), RenderError> {
        self.out.clear()
    }

    /// A new run of this job.
    pub fn session(&self) -> Session {
        Session {
            id: Session::fresh_id(),
            cores: self.options.cores,
            camera: bytemuck::bytes_of(&self.compiled.camera).to_vec(),
            scene: self.compiled.blob.bytes().to_vec(),
            scene_id: self.compiled.id,
            exponent: self.compiled.exponent,
            epoch: 0,
            plan: self.plan,
            order: self.options.pixels.into(),
            profile: Name::new(self.options.profile.wire_name(self.options.sampler())),
        }
    }

    /// The image that this job's cores need.
    pub fn recipe(&self) -> Recipe {
        let options = &self.options;
        Recipe::of(
            options.profile,
            options.sampler(),
            &self.compiled,
            options.termination.0,
        )
    }

    /// Collects from cores that somebody else starts.
    pub fn collect_elsewhere(
        &self,
        session: &Session,
        socket: &UdpSocket,
        board: Board,
        interrupted: &AtomicBool,
    ) -> Result<Finished, RenderError> {
        interrupt::finish_first();
        let origin = Origin {
            backend: "elsewhere",
            boards: vec![board],
            images: Vec::new(),
            counts_instructions: false,
            log: None,
            soft_float: None,
            choice: None,
            meter: None,
        };
        self.collect(
            session,
            socket,
            Box::new(Elsewhere),
            origin,
            Instant::now(),
            interrupted,
        )
    }

    fn collect(
        &self,
        session: &Session,
        socket: &UdpSocket,
        mut fleet: Box<dyn Fleet>,
        origin: Origin,
        start: Instant,
        interrupted: &AtomicBool,
    ) -> Result<Finished, RenderError> {
        let progress = Progress::on_stderr();
        let before = start.elapsed();
        let patience = self.options.patience.map(Duration::from_secs);
        let collection = collector::collect(
            session,
            socket,
            &mut *fleet,
            patience,
            interrupted,
            &mut |event| {
                progress.see(event);
            },
        );
        progress.finish();
        let collection = collection?;
        let wall = before + collection.elapsed;
        let memory = memory::peak(fleet.peak_memory());
        for warning in fleet.end() {
            note(&warning);
        }
        // A picture without its cycles is a picture.
        let recordings = origin
            .meter
            .as_ref()
            .map_or(Ok(Vec::new()), |meter| meter.read(&*fleet));
        let known = recordings.as_ref().map_or(&[][..], Vec::as_slice);
        let finished = self.conclude(&collection, origin, wall, memory, known)?;
        recordings?;
        Ok(finished)
    }

    /// Judges and writes what was collected.
    fn conclude(
        &self,
        collection: &Collection,
        origin: Origin,
        wall: Duration,
        memory: Option<u64>,
        recordings: &[Recording],
    ) -> Result<Finished, RenderError> {
        let results = results::Results {
            job: self,
            collection,
            origin,
            wall,
            memory,
            recordings,
        };
        match &collection.end {
            End::Complete => {
                // Judging takes a while and ends with an interruption; the picture is not to be lost with it.
                let mut report = results.write_here(None)?;
                interrupt::end_at_once(format!(
                    "the picture is complete, {}, and not compared",
                    self.out().join("image.png").display()
                ));
                if let Some(verdict) = results.judge()? {
                    report = results.write_here(Some(&verdict))?;
                }
                let summary = results.summary(&report);
                Ok(Finished { report, summary })
            }
            End::Interrupted => Err(RenderError::Interrupted(results.keep_partial()?)),
            End::Deserted(why) => Err(RenderError::Deserted {
                why: why.clone(),
                kept: results.keep_partial()?,
            }),
        }
    }
}

/// Renders a picture on cores of this host.
pub fn render(options: &RenderOptions, interrupted: &AtomicBool) -> Result<Finished, RenderError> {
    Job::new(&options.picture)?.render(options, None, interrupted)
}

/// What kind of image the cores have.
#[derive(Clone, Copy, Debug, Default)]
struct Kind {
    log: Option<Level>,
    soft_float: Option<SoftFloat>,
    choice: Option<Choice>,
}

/// Whose packets are to be recorded, and where.
struct Capture {
    core: u16,
    file: PathBuf,
}

impl Job {
    fn render(
        &self,
        options: &RenderOptions,
        capture: Option<&Capture>,
        interrupted: &AtomicBool,
    ) -> Result<Finished, RenderError> {
        if options.backend == Backend::Native && options.log.is_some() {
            return Err(RenderError::NoLog);
        }
        if options.backend == Backend::Native && options.soft_float.is_some() {
            return Err(RenderError::NoSoftFloat);
        }
        if options.backend == Backend::Native && options.choice.is_some() {
            return Err(RenderError::NoChoice);
        }
        if options.backend == Backend::Native && options.cycles {
            return Err(RenderError::NoCycles);
        }
        let socket = collector::bind(Ipv4Addr::LOCALHOST, options.port.unwrap_or(0))?;
        let port = socket.local_addr().map_err(CollectError::Socket)?.port();
        let session = self.session();
        let emulated = options.backend == Backend::Qemu;
        let wanted = Wanted {
            qemu: emulated,
            firmware: emulated,
            ..Wanted::default()
        };
        let tools = setup::ensure(wanted, Install::unless(options.no_install))?;
        let kind = Kind {
            log: options.log,
            soft_float: options.soft_float,
            choice: options.choice,
        };
        let images = self.build(&tools, &options.boards, kind)?;
        let route = if emulated {
            Route::qemu(port)
        } else {
            Route::loopback(port)
        };
        let blocks = boot_blocks(&session, &route)?;
        self.clear()?;
        interrupt::finish_first();
        let start = Instant::now();
        let (fleet, origin) = match &tools.qemu {
            Some(qemu) => {
                let mut cores = cores(&images, blocks, capture);
                for core in &mut cores {
                    core.logs = options.log.is_some();
                }
                let folder = self.out.path().join("cores");
                let meter = options
                    .cycles
                    .then(|| Meter::attach(qemu, &mut cores, &folder, options.code_access))
                    .transpose()?;
                let fleet = QemuFleet::start(qemu, &cores, &folder)?;
                let origin = Origin {
                    backend: "qemu",
                    boards: options.boards.clone(),
                    images: images.iter().map(report::Image::from).collect(),
                    counts_instructions: true,
                    log: fleet.log().map(Path::to_owned),
                    soft_float: options.soft_float,
                    choice: options.choice,
                    meter,
                };
                (Box::new(fleet) as Box<dyn Fleet>, origin)
            }
            None => {
                let fleet = NativeFleet::start(&blocks, options.picture.profile, options.picture.sampler())?;
                let origin = Origin {
                    backend: "native",
                    boards: Vec::new(),
                    images: Vec::new(),
                    counts_instructions: false,
                    log: None,
                    soft_float: None,
                    choice: None,
                    meter: None,
                };
                (Box::new(fleet) as Box<dyn Fleet>, origin)
            }
        };
        self.collect(&session, &socket, fleet, origin, start, interrupted)
    }

    /// Refuses a core that this job does not have.
    fn check_core(&self, core: u16) -> Result<(), RenderError> {
        let cores = self.options.cores;
        if core < cores {
            Ok(())
        } else {
            Err(RenderError::NoSuchCore { core, cores })
        }
    }

    /// The image of each board, where there is a toolchain for it.
    fn build(&self, tools: &Tools, boards: &[Board], kind: Kind) -> Result<Vec<(Board, Image)>, RenderError> {
        let Some(toolchain) = &tools.firmware else {
            return Ok(Vec::new());
        };
        let build = |&board: &Board| Ok((board, self.image(toolchain, board, kind)?));
        boards.iter().map(build).collect()
    }

    /// The image of a board.
    fn image(&self, toolchain: &Toolchain, board: Board, kind: Kind) -> Result<Image, RenderError> {
        let recipe = Recipe {
            log: kind.log,
            soft_float: kind.soft_float,
            choice: kind.choice,
            ..self.recipe()
        };
        note(format!(
            "building the image for {} on {board} with {}",
            self.scene.name,
            recipe.describe()
        ));
        let mut image = patiently("building the image", || {
            firmware::build(toolchain, board, &recipe)
        })?;
        image.size = image.size.with_boot_block(boot_block_len(&self.compiled));
        note(&image.size);
        Ok(image)
    }
}

/// One core a boot block; the boards take turns.
fn cores(images: &[(Board, Image)], blocks: Vec<Vec<u8>>, capture: Option<&Capture>) -> Vec<Core> {
    let turns = (0..).zip(images.iter().cycle()).zip(blocks);
    let core = |((number, (board, image)), boot_block): ((u16, &(Board, Image)), _)| Core {
        capture: capture
            .filter(|capture| capture.core == number)
            .map(|capture| capture.file.clone()),
        ..Core::new(number, *board, &image.elf, boot_block)
    };
    turns.map(core).collect()
}

/// The boot blocks of all cores.
pub fn boot_blocks(session: &Session, route: &Route) -> Result<Vec<Vec<u8>>, RenderError> {
    let blocks = (0..session.cores).map(|core| session.boot_block(core, route));
    blocks.collect::<Result<_, _>>().map_err(RenderError::TooLong)
}

fn read_reference(path: &Path, size: (u16, u16)) -> Result<Estimate, RenderError> {
    let reference = openexr::read(path)?;
    if reference.picture.size() == size {
        Ok(reference)
    } else {
        Err(CompareError::Size {
            picture: size,
            reference: reference.picture.size(),
        }
        .into())
    }
}

#[cfg(test)]
mod tests;
