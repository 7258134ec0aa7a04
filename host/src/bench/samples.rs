//! What a whole sample costs on a core, how wrong it is and how noisy: the same small picture by every board, profile, integrator,
//! sampler and way to end a path.
//!
//! *Efficiency* is what a picture of a given error costs less: the geometric mean over pixels of cycles times variance of the published
//! system's profile, with roulette on the same board, over that of the row.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use serde::Serialize;
use tracer::unit::{Plan, Termination};

use crate::firmware::SoftFloat;
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::oracle::noise::{self, Noise};
use crate::platform::interrupt::LastAct;
use crate::render::options::{Backend, End, PictureOptions, Pixels, RenderOptions, Size};
use crate::render::report::Report;
use crate::render::{self, RenderError};
use crate::scene::{Integrator, Scene, compile, samples_per_unit};

/// The picture that is rendered again and again.
#[derive(Clone, Debug)]
pub struct Series {
    /// The scene's file.
    pub scene: PathBuf,
    /// The boards.
    pub boards: Vec<Board>,
    /// The picture's size.
    pub size: Size,
    /// Samples per pixel.
    pub spp: u32,
    /// Samples per pixel of the reference.
    pub reference_spp: u32,
    /// Samples per pixel by which noise is told; with fewer than four units of a pixel it is not.
    pub noise_spp: u32,
    /// What is rendered.
    pub kinds: Kinds,
    /// Cores.
    pub cores: u16,
    /// Whether `precise` is rendered in soft float, too.
    pub soft_float: bool,
    /// Whether set-up must leave the machine as it is.
    pub no_install: bool,
}

/// What is rendered on every board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinds {
    /// Each profile by each integrator with each sampler.
    All,
    /// Each profile as published, and ours looking for light with samples that keep apart.
    Few,
}

/// Ways to end a path: by chance, and after as many surfaces as chance always leaves.
const TERMINATIONS: [Termination; 2] = [Termination::Roulette, Termination::Depth(5)];

/// Of the random numbers by which noise is told.
const NOISE_SEED: u64 = 2;

/// A row of the list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The board.
    pub board: Board,
    /// The arithmetic.
    pub profile: String,
    /// The scene.
    pub scene: String,
    /// `path` or `next-event`.
    pub integrator: Integrator,
    /// `independent` or `kronecker`.
    pub sampler: Sampler,
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// The version of the compiler that made the image.
    pub compiler: Option<String>,
    /// Bytes of code, constants and first values of the image.
    pub itcm_bytes: Option<u64>,
    /// Instructions.
    pub instructions_per_sample: Option<f64>,
    /// Cycles of the board's processor.
    pub cycles_per_sample: Option<f64>,
    /// The least that they may be, by what the model does not see.
    pub cycles_per_sample_low: Option<f64>,
    /// The most.
    pub cycles_per_sample_high: Option<f64>,
    /// Rays.
    pub rays_per_sample: Option<f64>,
    /// (mean - reference mean) / reference mean, noise and all.
    pub bias: Option<f64>,
    /// Upper bound of the standard error of `bias`.
    pub bias_standard_error: Option<f64>,
    /// The same against the same paths in double precision: of arithmetic alone.
    pub lockstep_bias: Option<f64>,
    /// Upper bound of the standard error of `lockstep_bias`.
    pub lockstep_bias_standard_error: Option<f64>,
    /// Noise-corrected root of the mean squared error; 0 where noise hides it.
    pub rmse: Option<f64>,
    /// The largest `rmse` that the noise leaves room for: two standard errors up.
    pub rmse_at_most: Option<f64>,
    /// Variance of one sample, over all pixels.
    pub variance_mean: Option<f64>,
    /// Of the pixel in the middle.
    pub variance_median: Option<f64>,
    /// Of the pixel that is noisier than 95 of 100.
    pub variance_p95: Option<f64>,
    /// How many times fewer cycles a picture of the same noise takes than by `paper` with roulette on this board.
    pub efficiency: Option<f64>,
    /// The picture, which is the same on every board.
    pub image_sha256: String,
}

/// Renders the series, and compares the boards' pictures.
pub fn measure(series: &Series, interrupted: &AtomicBool) -> Result<Vec<Row>, SeriesError> {
    let folder = tempfile::tempdir().map_err(SeriesError::Folder)?;
    let place = folder.path().to_owned();
    // Whatever of it stays, it is in a folder for what may go away.
    let _removes = LastAct::new(move || drop(std::fs::remove_dir_all(&place)));
    let mut rows: Vec<Row> = Vec::new();
    let mut published = None;
    for kind in series.kinds.each(series.soft_float) {
        let first = rows.len();
        let noise = series.noise(kind)?;
        // The first of all kinds.
        let published = published.get_or_insert_with(|| noise.clone());
        for &board in &series.boards {
            let options = series.options(board, kind, folder.path());
            let mut row = Row::new(board, kind, &render::render(&options, interrupted)?.report);
            if let (Some(noise), Some(published)) = (&noise, published.as_ref()) {
                row.add_noise(noise, published, rows.iter().find(|row| row.board == board));
            }
            rows.push(row);
        }
        let others = rows[first..].windows(2);
        if let Some(pair) = others
            .into_iter()
            .find(|pair| pair[0].image_sha256 != pair[1].image_sha256)
        {
            return Err(SeriesError::Picture(Box::new([pair[0].clone(), pair[1].clone()])));
        }
    }
    Ok(rows)
}

/// A kind of picture.
#[derive(Clone, Copy)]
struct Kind {
    profile: Arithmetic,
    integrator: Integrator,
    sampler: Sampler,
    end: Termination,
    soft_float: Option<SoftFloat>,
}

impl Kind {
    /// As published, by this profile.
    const fn published(profile: Arithmetic, end: Termination) -> Self {
        Self {
            profile,
            integrator: Integrator::Path,
            sampler: Sampler::Independent,
            end,
            soft_float: None,
        }
    }
}

impl Kinds {
    /// The first is the published system's profile with roulette.
    fn each(self, soft_float: bool) -> Vec<Kind> {
        let published = Arithmetic::ALL
            .into_iter()
            .flat_map(|profile| TERMINATIONS.map(|end| Kind::published(profile, end)));
        let ways = Integrator::ALL
            .into_iter()
            .flat_map(|integrator| Sampler::ALL.map(|sampler| (integrator, sampler)));
        let ways = ways.filter(|way| *way != (Integrator::Path, Sampler::Independent));
        let mut kinds: Vec<Kind> = published.collect();
        match self {
            Self::All => {
                for (integrator, sampler) in ways {
                    for kind in 0..4 {
                        kinds.push(Kind {
                            integrator,
                            sampler,
                            ..kinds[kind]
                        });
                    }
                }
            }
            Self::Few => kinds.push(Kind {
                integrator: Integrator::NextEvent,
                sampler: Sampler::Kronecker,
                ..Kind::published(Arithmetic::Precise, Termination::Roulette)
            }),
        }
        let formats = SoftFloat::ALL.into_iter().filter(|_| soft_float);
        kinds.extend(formats.map(|format| Kind {
            soft_float: Some(format),
            ..Kind::published(Arithmetic::Precise, Termination::Roulette)
        }));
        kinds
    }
}

/// Why there is no list.
#[derive(Debug, thiserror::Error)]
pub enum SeriesError {
    /// There is no folder for the pictures.
    #[error("cannot make a folder for temporary files (set TMPDIR to one with room)")]
    Folder(io::Error),
    /// A render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Two boards disagree.
    #[error(
        "profile {} with {} gives another picture on {} than on {}: one of the two computes something else; compare them with \
         `cargo xtask bench ops --board`",
        .0[0].profile, .0[0].termination, .0[1].board, .0[0].board
    )]
    Picture(Box<[Row; 2]>),
}

impl Series {
    fn options(&self, board: Board, kind: Kind, out: &Path) -> RenderOptions {
        RenderOptions {
            picture: PictureOptions {
                scene: Some(self.scene.clone()),
                size: self.size,
                spp: self.spp,
                cores: self.cores,
                profile: kind.profile,
                integrator: Some(kind.integrator),
                sampler: Some(kind.sampler),
                epsilon: None,
                termination: End(kind.end),
                pixels: Pixels::Leased,
                seed: 1,
                reference: None,
                reference_spp: Some(self.reference_spp),
                patience: None,
                reference_cache: None,
                out: Some(out.to_owned()),
            },
            boards: vec![board],
            backend: Backend::Qemu,
            log: None,
            cycles: true,
            code_access: 0,
            soft_float: kind.soft_float,
            choice: None,
            port: None,
            no_install: self.no_install,
        }
    }
}

impl Series {
    /// The noise of a kind; the same on every board, and of soft float that of its profile.
    fn noise(&self, kind: Kind) -> Result<Option<Noise>, SeriesError> {
        let scene = Scene::load(&self.scene).map_err(RenderError::from)?;
        let compiled = compile(&scene, self.size.width, self.size.height, kind.integrator);
        let plan = Plan {
            width: self.size.width,
            height: self.size.height,
            spp: self.noise_spp,
            samples_per_unit: samples_per_unit(&scene, self.noise_spp, kind.end),
            seed: NOISE_SEED,
            termination: kind.end,
            epsilon: kind.profile.epsilon(scene.scale().magnification),
        };
        Ok(noise::noise(kind.profile, kind.sampler, &compiled, &plan, |_| ()))
    }
}

impl Row {
    fn new(board: Board, kind: Kind, report: &Report) -> Self {
        let lockstep = report.lockstep_error;
        Self {
            board,
            profile: report.profile.clone(),
            scene: report.scene.clone(),
            integrator: kind.integrator,
            sampler: kind.sampler,
            termination: report.termination.clone(),
            compiler: report.images.first().and_then(|image| image.compiler.clone()),
            itcm_bytes: report.images.first().map(|image| image.size.itcm_bytes),
            instructions_per_sample: report.cost.instructions_per_sample,
            cycles_per_sample: report.cost.cycles_per_sample,
            cycles_per_sample_low: report.cost.cycles_per_sample_low,
            cycles_per_sample_high: report.cost.cycles_per_sample_high,
            rays_per_sample: report.cost.rays_per_sample,
            bias: report.error.bias,
            bias_standard_error: report.error.bias_standard_error,
            lockstep_bias: lockstep.and_then(|lockstep| lockstep.bias),
            lockstep_bias_standard_error: lockstep.and_then(|lockstep| lockstep.bias_standard_error),
            rmse: report.error.rmse,
            rmse_at_most: report.error.rmse_at_most,
            variance_mean: None,
            variance_median: None,
            variance_p95: None,
            efficiency: None,
            image_sha256: report.image_sha256.clone(),
        }
    }

    /// Says how noisy it is, beside the published system's noise and its row, which is none for that itself.
    fn add_noise(&mut self, noise: &Noise, published: &Noise, its_row: Option<&Self>) {
        self.variance_mean = Some(noise.mean());
        self.variance_median = Some(noise.quantile(0.5));
        self.variance_p95 = Some(noise.quantile(0.95));
        let its_cycles = its_row.map_or(self.cycles_per_sample, |row| row.cycles_per_sample);
        let fewer = its_cycles
            .zip(self.cycles_per_sample)
            .map(|(theirs, ours)| theirs / ours);
        self.efficiency = fewer.map(|fewer| fewer * noise.less_than(published));
    }

    /// Board, profile, integrator, sampler and way to end a path.
    pub fn name(&self) -> String {
        format!(
            "{} {} {} {} {}",
            self.board, self.profile, self.integrator, self.sampler, self.termination
        )
    }

    /// Its cycles, and by how much they may be more or less where the model leaves that open.
    fn cycles(&self) -> String {
        let Some(cycles) = self.cycles_per_sample else {
            return "-".to_owned();
        };
        let bounds = [self.cycles_per_sample_low, self.cycles_per_sample_high];
        let most = bounds
            .into_iter()
            .flatten()
            .map(|bound| (bound / cycles - 1.0).abs())
            .fold(0.0, f64::max);
        if most < 5e-4 {
            format!("{cycles:.1}")
        } else {
            format!("{cycles:.0} ± {:.1} %", 100.0 * most)
        }
    }
}

/// The list for people, boards side by side, what is behind a `±` being one standard error at most.
pub fn table(rows: &[Row]) -> String {
    let mut lines = vec![format!(
        "{:14} {:10} {:11} {:8} {:11} {:>6} {:>12} {:>15} {:>5} {:>18} {:>18} {:>8} {:>8} {:>8} {:>8} {:>10}",
        "profile",
        "integrator",
        "sampler",
        "paths",
        "board",
        "code",
        "instructions",
        "cycles",
        "rays",
        "bias",
        "arithmetic bias",
        "rmse <=",
        "variance",
        "median",
        "95 %",
        "efficiency"
    )];
    let percent = |share: Option<f64>, error: Option<f64>| match (share, error) {
        (Some(share), Some(error)) => format!("{:+.3} ± {:.3} %", 100.0 * share, 100.0 * error),
        (Some(share), None) => format!("{:+.3} %", 100.0 * share),
        (None, _) => "-".to_owned(),
    };
    let figure =
        |value: Option<f64>, digits| value.map_or("-".to_owned(), |value| format!("{value:.digits$}"));
    lines.extend(rows.iter().map(|row| {
        format!(
            "{:14} {:10} {:11} {:8} {:11} {:>6} {:>12} {:>15} {:>5} {:>18} {:>18} {:>8} {:>8} {:>8} {:>8} {:>10}",
            row.profile,
            row.integrator,
            row.sampler,
            row.termination,
            row.board,
            row.itcm_bytes.map_or("-".to_owned(), |bytes| bytes.to_string()),
            figure(row.instructions_per_sample, 1),
            row.cycles(),
            figure(row.rays_per_sample, 2),
            percent(row.bias, row.bias_standard_error),
            percent(row.lockstep_bias, row.lockstep_bias_standard_error),
            figure(row.rmse_at_most, 5),
            figure(row.variance_mean, 4),
            figure(row.variance_median, 4),
            figure(row.variance_p95, 4),
            figure(row.efficiency, 1),
        )
    }));
    lines.join("\n")
}
