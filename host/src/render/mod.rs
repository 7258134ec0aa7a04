//! A render from start to end: what `cargo xtask render` and the collector do.
//!
//! Whatever can be known to fail is looked at before anything slow starts: the flags, the scene, the folder for the
//! results, the reference file, the port, the programs that are needed. Then the image is built, the fleet started
//! and the picture collected; then it is judged and written.

mod debug;
mod folder;
pub mod options;
mod record;
pub mod report;
mod results;
mod trace;

use std::net::{Ipv4Addr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use tracer::scene::Capability;
use tracer::unit::{Plan, Termination};
use wire::Name;

use crate::collector::{self, BindError, CollectError, Collection, End, Progress};
use crate::firmware::Level;
use crate::firmware::board::Board;
use crate::firmware::{self, FirmwareError, Image, Recipe};
use crate::fleet::capture::CaptureError;
use crate::fleet::session::{Route, Session, boot_block_len};
use crate::fleet::{Core, Elsewhere, Fleet, FleetError, NativeFleet, QemuFleet};
use crate::image::openexr::{self, ReadError};
use crate::image::picture::Estimate;
use crate::oracle::compare::CompareError;
use crate::platform::console::{note, patiently};
use crate::platform::file::WriteError;
use crate::platform::interrupt;
use crate::platform::memory;
use crate::platform::setup::{self, Install, SetupError, Toolchain, Tools, Wanted};
use crate::platform::workspace::{self, NoWorkspace};
use crate::scene::{CompiledScene, Scene, SceneError, compile, samples_per_unit};
use folder::Folder;
use options::{Backend, PictureOptions, Reference, RenderOptions};
use report::Report;

pub use debug::{DebugOptions, debug};
pub use record::{RecordError, Recorded, record};
pub use trace::{TraceOptions, Traced, trace};

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
        let plan = options.plan(samples_per_unit(&scene, options.spp, options.termination.0));
        plan.units().ok_or(RenderError::TooManyUnits)?;
        let out = Folder::open(options.out(&scene.name)?)?;
        let reference = match &options.reference {
            Some(Reference::File(path)) => Some(read_reference(path, (width, height))?),
            Some(Reference::None) | None => None,
        };
        let compiled = compile(&scene, width, height);
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
            profile: Name::new(self.options.profile.name()),
        }
    }

    /// The image that this job's cores need.
    pub fn recipe(&self) -> Recipe {
        Recipe {
            profile: self.options.profile,
            needs: match self.options.termination.0 {
                Termination::Roulette => self.compiled.needs.with(Capability::Roulette),
                Termination::Depth(_) => self.compiled.needs,
            },
            log: None,
        }
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
        self.conclude(&collection, origin, wall, memory)
    }

    /// Judges and writes what was collected.
    fn conclude(
        &self,
        collection: &Collection,
        origin: Origin,
        wall: Duration,
        memory: Option<u64>,
    ) -> Result<Finished, RenderError> {
        let results = results::Results {
            job: self,
            collection,
            origin,
            wall,
            memory,
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
        let images = self.build(&tools, &options.boards, options.log)?;
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
                let fleet = QemuFleet::start(qemu, &cores, &self.out.path().join("cores"))?;
                let origin = Origin {
                    backend: "qemu",
                    boards: options.boards.clone(),
                    images: images.iter().map(report::Image::from).collect(),
                    counts_instructions: true,
                    log: fleet.log().map(Path::to_owned),
                };
                (Box::new(fleet) as Box<dyn Fleet>, origin)
            }
            None => {
                let fleet = NativeFleet::start(&blocks, options.picture.profile)?;
                let origin = Origin {
                    backend: "native",
                    boards: Vec::new(),
                    images: Vec::new(),
                    counts_instructions: false,
                    log: None,
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
    fn build(
        &self,
        tools: &Tools,
        boards: &[Board],
        log: Option<Level>,
    ) -> Result<Vec<(Board, Image)>, RenderError> {
        let Some(toolchain) = &tools.firmware else {
            return Ok(Vec::new());
        };
        let build = |&board: &Board| Ok((board, self.image(toolchain, board, log)?));
        boards.iter().map(build).collect()
    }

    /// The image of a board.
    fn image(&self, toolchain: &Toolchain, board: Board, log: Option<Level>) -> Result<Image, RenderError> {
        let recipe = Recipe { log, ..self.recipe() };
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
