//! Where the cycles of a sample go: one core renders a small picture while its flow of execution is recorded, and what it cost is
//! said by function, by class of instruction, by line and by basic block.
//!
//! Inlined functions are told apart by the image's line tables. How calls between functions of the image are shared out, `calls`
//! says.

mod account;
mod blocks;
mod brief;
mod calls;
mod code;
pub mod compare;
mod cost;
mod flame_graph;
pub mod run;
pub mod table;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cycles::{Assumptions, Estimate};
use fixedmath::I16F16;

use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::firmware::{ElfError, SoftFloat};
use crate::platform::interrupt::LastAct;
use crate::platform::setup::{self, Install, SetupError, Wanted};
use crate::platform::workspace::{self, NoWorkspace};
use crate::render::options::{
    End, Epsilon, EpsilonError, PictureOptions, Pixels, Reference, Size, samples_per_pixel,
};
use crate::render::{RecordError, Recorded, record};
use crate::scene::{Integrator, Scene, SceneError};
use code::Code;
use run::{FORMAT, Run, Subject};

pub use blocks::DisassemblyError;
pub use cost::Cost;

/// What is rendered while a core is watched.
#[derive(Clone, Debug, clap::Args)]
pub struct ProfileOptions {
    /// Scene file [default: scenes/cornell.toml of the checkout]
    pub scene: Option<PathBuf>,
    /// Board of the core
    #[arg(long, value_enum, default_value_t)]
    pub board: Board,
    /// Arithmetic
    #[arg(long, value_enum, default_value_t)]
    pub profile: Arithmetic,
    /// Compute in soft float instead of fixed point, by the profile's formulas, in an image that does not fit a core's memory
    #[arg(long, value_name = "f32|f64", value_enum)]
    pub soft_float: Option<SoftFloat>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "64x48")]
    pub size: Size,
    /// Samples per pixel in all, a multiple of 4
    #[arg(long, value_name = "N", default_value = "16", value_parser = samples_per_pixel, allow_negative_numbers = true)]
    pub spp: u32,
    /// How radiance is found: by paths that meet light, or that look for it as well [default: the profile's own]
    #[arg(long, value_enum)]
    pub integrator: Option<Integrator>,
    /// Where random numbers come from [default: the profile's own]
    #[arg(long, value_enum)]
    pub sampler: Option<Sampler>,
    /// How far from a surface a new ray starts at least [default: the profile's own]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub epsilon: Option<Epsilon>,
    /// When a path ends: `roulette`, or `depth:N` after N surfaces
    #[arg(long, value_name = "roulette|depth:N", default_value = "roulette")]
    pub termination: End,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value = "1", allow_negative_numbers = true)]
    pub seed: u64,
    /// Cycles that an access to a literal or a table takes longer where it lies in instruction memory
    #[arg(
        long,
        value_name = "CYCLES",
        default_value = "0",
        allow_negative_numbers = true
    )]
    pub code_access: u32,
}

/// A profile, and what its flame graph is drawn from.
pub struct Profile {
    /// What was found.
    pub run: Run,
    stacks: Vec<calls::Node>,
    code: Code,
}

/// Why there is no profile.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// There is no default scene.
    #[error("a scene must be named here")]
    NoWorkspace(#[from] NoWorkspace),
    /// The scene is unusable.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// It is of another size than the epsilon.
    #[error(transparent)]
    Epsilon(#[from] EpsilonError),
    /// There is no folder for the picture.
    #[error("cannot make a folder for temporary files (set TMPDIR to one with room)")]
    Folder(#[source] io::Error),
    /// There is no recording.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The image's line tables are of no use.
    #[error(transparent)]
    Elf(#[from] ElfError),
    /// A program is missing.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Nobody says what the instructions are.
    #[error(transparent)]
    Disassembly(#[from] DisassemblyError),
}

impl ProfileOptions {
    /// What these options render. The scene's name is in its file.
    pub fn subject(&self) -> Result<Subject, ProfileError> {
        let scene = Scene::load(&workspace::scene(self.scene.as_deref())?)?;
        let epsilon = match self.epsilon {
            Some(epsilon) => epsilon.for_core(scene.scale().exponent)?,
            None => self.profile.epsilon(scene.scale().magnification),
        };
        Ok(self.subject_of(scene.name, epsilon))
    }

    fn subject_of(&self, scene: String, epsilon: I16F16) -> Subject {
        Subject {
            board: self.board.name().to_owned(),
            profile: SoftFloat::profile(self.profile, self.soft_float),
            scene,
            size: [self.size.width, self.size.height],
            spp: self.spp,
            integrator: self.integrator.unwrap_or(self.profile.integrator()).to_string(),
            sampler: self.sampler.unwrap_or(self.profile.sampler()).to_string(),
            termination: self.termination.to_string(),
            epsilon_bits: epsilon.to_bits(),
            seed: self.seed,
            code_access: self.code_access,
        }
    }

    fn picture(&self, scene: PathBuf, out: &Path) -> PictureOptions {
        PictureOptions {
            scene: Some(scene),
            size: self.size,
            spp: self.spp,
            cores: 1,
            profile: self.profile,
            integrator: self.integrator,
            sampler: self.sampler,
            epsilon: self.epsilon,
            termination: self.termination,
            pixels: Pixels::Leased,
            seed: self.seed,
            reference: Some(Reference::None),
            reference_spp: None,
            patience: None,
            reference_cache: None,
            out: Some(out.to_owned()),
        }
    }
}

/// Profiles a render, with so many of the hottest blocks disassembled.
pub fn profile(
    options: &ProfileOptions,
    blocks: usize,
    install: Install,
    interrupted: &AtomicBool,
) -> Result<Profile, ProfileError> {
    let scene = workspace::scene(options.scene.as_deref())?;
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        gdb: blocks > 0,
        ..Wanted::default()
    };
    let debugger = setup::ensure(wanted, install)?.gdb;
    let folder = tempfile::tempdir().map_err(ProfileError::Folder)?;
    let place = folder.path().to_owned();
    let _removes = LastAct::new(move || drop(std::fs::remove_dir_all(&place)));
    let picture = options.picture(scene, folder.path());
    let recorded = record(&picture, options.board, options.soft_float, install, interrupted)?;
    let mut profile = account(options, &recorded, blocks)?;
    if let Some(debugger) = debugger {
        blocks::disassemble(&debugger, &recorded.elf, &mut profile.run.blocks)?;
    }
    Ok(profile)
}

/// Prices a recording and says what cost how much; its blocks have no words yet.
fn account(options: &ProfileOptions, recorded: &Recorded, blocks: usize) -> Result<Profile, ProfileError> {
    let Recorded {
        elf,
        scene,
        epsilon,
        samples,
        rays,
        flow,
    } = recorded;
    let assumptions = Assumptions {
        code_access: options.code_access,
        ..Assumptions::default()
    };
    let prices = cycles::price(flow, assumptions);
    let costs = account::by_address(&prices);
    let total = account::total(costs.values());
    let code = Code::of(elf, costs.keys().copied())?;
    let stacks = calls::stacks(flow, &costs, &code);
    let bound = |estimate| -> u64 {
        let prices = cycles::price(
            flow,
            Assumptions {
                estimate,
                ..assumptions
            },
        );
        prices.iter().map(|priced| priced.cycles).sum()
    };
    let a = |count: u64, of: u64| count as f64 / of as f64;
    let run = Run {
        format: FORMAT,
        subject: options.subject_of(scene.clone(), *epsilon),
        samples: *samples,
        rays: *rays,
        total,
        cycles_at_least: bound(Estimate::Low),
        cycles_at_most: bound(Estimate::High),
        blind_spots: account::blind_spots(flow, total),
        cycles_per_sample: a(total.cycles, *samples),
        instructions_per_sample: a(total.instructions, *samples),
        cycles_per_ray: a(total.cycles, *rays),
        instructions_per_ray: a(total.instructions, *rays),
        functions: account::functions(&costs, &stacks, &code),
        classes: account::classes(&prices),
        lines: account::lines(&costs, &code),
        blocks: blocks::hottest(flow, &costs, &code, blocks),
    };
    Ok(Profile { run, stacks, code })
}

impl Profile {
    /// The flame graph, as SVG.
    pub fn flame_graph(&self) -> String {
        flame_graph::svg(&self.run, &self.stacks, &self.code)
    }
}
