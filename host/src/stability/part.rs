//! What a part is given, and what it gives.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use indicatif::ProgressBar;

use tracer::unit::{Plan, Termination};

use super::{Plot, Sheet, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::oracle::reference::{self, Rendered};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Scene};

/// Why a part could not be measured.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

/// Standard errors by which a bound must be passed to be taken for broken: by chance, once in 30,000 times.
pub(super) const SURE: f64 = 4.0;

/// Something to measure.
pub struct Part {
    /// Its name on the command line and in the names of its files.
    pub name: &'static str,
    /// What it measures, in a line.
    pub about: &'static str,
    /// Measures it.
    pub measure: fn(&Effort) -> Result<Findings, Error>,
}

/// How much work a part may do, and who watches.
pub struct Effort {
    divisor: u64,
    bar: ProgressBar,
}

impl Effort {
    /// One of so many parts of the full work. The bar is told of work done.
    ///
    /// # Panics
    /// If there are no parts.
    pub fn new(divisor: u64, bar: ProgressBar) -> Self {
        assert!(divisor > 0, "no part of the work");
        Self { divisor, bar }
    }

    /// Whether only a part is wanted.
    pub fn is_quick(&self) -> bool {
        self.divisor > 1
    }

    /// The same bar, for one of so many parts of this work.
    ///
    /// # Panics
    /// If there are no parts.
    #[must_use]
    pub fn one_of(&self, parts: u64) -> Self {
        Self::new(self.divisor * parts, self.bar.clone())
    }

    /// Of how many parts of the full work this is one.
    pub fn parts(&self) -> u64 {
        self.divisor
    }

    /// What is to be done of `full` work: at least 1.
    pub fn of(&self, full: u64) -> u64 {
        (full / self.divisor).max(1)
    }

    /// So much more work is ahead, in whatever unit the part counts.
    pub fn expect(&self, work: u64) {
        self.bar.inc_length(work);
    }

    /// So much of it is done.
    pub fn done(&self, work: u64) {
        self.bar.inc(work);
    }
}

/// What a part has found.
#[derive(Debug, Default)]
pub struct Findings {
    /// What it counted.
    pub tables: Vec<Table>,
    /// The same to look at.
    pub plots: Vec<Plot>,
    /// What it rendered.
    pub sheets: Vec<Sheet>,
    /// What should have held and did not, a line each.
    pub faults: Vec<String>,
}

/// Where those scenes are that are hard for the arithmetic.
pub(super) const HARD_SCENES: &str = "scenes/hard";
/// Where the repository has scenes.
pub const SCENE_FOLDERS: [&str; 4] = ["scenes", "scenes/extra", HARD_SCENES, "tests/scenes"];

/// The scenes' files of these folders, in the order of their names.
pub fn scene_files(folders: &[&str]) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for folder in folders {
        for entry in fs::read_dir(workspace::file(folder)?)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// How `arithmetic` renders a picture of `width` by `height` unless users say otherwise.
pub(super) fn plan(
    arithmetic: Arithmetic,
    compiled: &CompiledScene,
    [width, height]: [u16; 2],
    spp: u32,
) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: spp.min(64) as u16,
        seed: 1,
        termination: Termination::Roulette,
        epsilon: arithmetic.epsilon(compiled.scale.magnification),
    }
}

/// The reference of a picture of `width` by `height` with `spp` samples a pixel; the effort hears of them.
pub(super) fn reference(effort: &Effort, scene: &Scene, [width, height]: [u16; 2], spp: u32) -> Rendered {
    let job = reference::Job {
        width,
        height,
        spp,
        termination: reference::Termination::Roulette,
        seed: 1,
    };
    let done = AtomicU64::new(0);
    reference::render(scene, &job, |samples| {
        let before = done.fetch_max(samples, Ordering::Relaxed);
        effort.done(samples.saturating_sub(before));
    })
}
