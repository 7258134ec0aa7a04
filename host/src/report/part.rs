//! What makes a section, and what it has to work with.

use std::cell::OnceCell;
use std::sync::atomic::AtomicBool;

use super::section::Section;
use crate::bench::samples::{self, Kinds, Row, Series};
use crate::bench::scaling::published::FIGURE_4;
use crate::bench::scaling::{self, Experiment, Outcome};
use crate::firmware::board::Board;
use crate::platform::setup::Install;
use crate::platform::workspace;
use crate::render::options::Size;
use crate::stability::Effort;

/// Why a section could not be made.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

/// What makes a section.
pub struct Part {
    /// The section's name in links.
    pub name: &'static str,
    /// What it measures, in a line.
    pub about: &'static str,
    /// Measures it. The effort hears of work done on the host.
    pub make: fn(&Workshop<'_>, &Effort) -> Result<Section, Error>,
}

/// What all sections share.
pub struct Workshop<'a> {
    /// Whether little work is enough, because nobody reads the figures.
    pub quick: bool,
    /// Whether set-up may install what is missing.
    pub install: Install,
    /// What an interruption sets.
    pub interrupted: &'a AtomicBool,
    rows: OnceCell<Vec<Row>>,
    scaling: OnceCell<Outcome>,
}

/// The scene of all that is measured on cores.
pub(super) const SCENE: &str = "scenes/cornell.toml";

/// The size of a quick run's pictures.
const QUICK_SIZE: Size = Size { width: 8, height: 6 };

impl<'a> Workshop<'a> {
    /// A workshop in which nothing has been measured.
    pub fn new(quick: bool, install: Install, interrupted: &'a AtomicBool) -> Self {
        Self {
            quick,
            install,
            interrupted,
            rows: OnceCell::new(),
            scaling: OnceCell::new(),
        }
    }

    /// `full` work, or in a quick run `little`.
    pub fn either<T>(&self, full: T, little: T) -> T {
        if self.quick { little } else { full }
    }

    /// What `cargo xtask bench trace --soft-float` measures; in a quick run of few kinds, on one board.
    pub fn samples(&self) -> Result<&[Row], Error> {
        if let Some(rows) = self.rows.get() {
            return Ok(rows);
        }
        let rows = samples::measure(&self.series()?, self.interrupted)?;
        Ok(self.rows.get_or_init(|| rows))
    }

    /// What `cargo xtask bench scaling` measures, but that larger units than the smallest are not run.
    pub fn scaling(&self) -> Result<&Outcome, Error> {
        if let Some(outcome) = self.scaling.get() {
            return Ok(outcome);
        }
        let scene = workspace::file(SCENE)?;
        let experiment = if self.quick {
            Experiment {
                energy: Some((QUICK_SIZE, 256)),
                ..Experiment::quick(scene, vec![1, 2], self.install)
            }
        } else {
            Experiment::full(scene, FIGURE_4.to_vec(), self.install)
        };
        let experiment = Experiment {
            runs_larger: false,
            ..experiment
        };
        let outcome = scaling::measure(&experiment, self.interrupted)?;
        Ok(self.scaling.get_or_init(|| outcome))
    }

    /// The version of the compiler that made the images.
    pub fn compiler(&self) -> Result<String, Error> {
        let known = self.samples()?.iter().find_map(|row| row.compiler.clone());
        Ok(known.ok_or("no image says which compiler made it")?)
    }

    /// The picture that [`Workshop::samples`] is measured on.
    pub fn series(&self) -> Result<Series, Error> {
        let size = |width, height| Size { width, height };
        Ok(Series {
            scene: workspace::file(SCENE)?,
            boards: self.either(Board::ALL.to_vec(), vec![Board::Versatilepb]),
            size: self.either(size(64, 48), QUICK_SIZE),
            spp: self.either(64, 16),
            reference_spp: self.either(512, 64),
            noise_spp: self.either(4096, 256),
            kinds: self.either(Kinds::All, Kinds::Few),
            cores: 2,
            soft_float: true,
            no_install: self.install == Install::Forbidden,
        })
    }
}
