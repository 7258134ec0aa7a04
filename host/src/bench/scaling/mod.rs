//! How samples a second grow with cores: figure 4 of the published system, in virtual time, and on paper a machine of a million cores and
//! the energy of a sample.
//!
//! What is *run*: every unit of the picture, by emulated cores, as many as the figure has, up to 136 at once. Each unit's instructions are
//! counted by its core's clock, and QEMU's plugin records what they cost in cycles (`runs`).
//!
//! What is *modelled*: the processor's cycles (the tables of `cycles`), the way out of the machine (a queue with one server), and the time
//! until the collector's answer is there. The leases are the collector's own, by its own table ([`machine`]).
//!
//! Units are assigned in virtual time. In the emulated fleet they go to whichever core this host lets run; a unit costs the same
//! wherever it is rendered, which is checked to the tick, so who rendered it there does not matter, and how busy the host was neither.

mod curve;
pub mod energy;
pub mod machine;
pub mod million;
pub mod published;
mod runs;
mod table;

use std::io;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use serde::Serialize;
use tracer::unit::{SPAN, Termination};

pub use curve::{Derivation, Point, Series, Sweep};
pub use energy::Energy;
pub use million::Million;
pub use runs::{Price, Run};
pub use table::table;

use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::platform::interrupt::LastAct;
use crate::platform::setup::Install;
use crate::render::RenderError;
use crate::render::options::{End, Size};
use crate::render::timed::{Recorded, Stand};
use crate::scene::Integrator;
use curve::Work;
use energy::Measurement;
use published::{CLOCK, WIRE};
use runs::{Picture, Subject};

/// Pixels in a packet.
const PACKET_PIXELS: u32 = SPAN as u32;
/// From when a packet has left the machine until the collector's answer has reached its core. Assumed: a switch, a host that
/// answers in well under a millisecond, and the way through the machine. Cores hold three leases, so it hides behind their work.
const ANSWER: Duration = Duration::from_millis(1);
/// Ways to end a path.
const TERMINATIONS: [Termination; 2] = [Termination::Roulette, Termination::Depth(4)];
/// Samples of a pixel are a multiple of this: one for each sub-pixel.
const SUBPIXELS: u32 = 4;
/// A picture of 192 packets, by which their cycles are counted; four shorter ones are among them, HELLO and FAREWELL.
const PACKETS: Size = Size {
    width: 64,
    height: 48,
};
/// Samples of a pixel in the project's usual unit.
const USUAL: u16 = 64;
/// Digits of a figure. A tick of a core's clock is 42 instructions, so the sixth would depend on where a tick falls.
const DIGITS: usize = 5;

/// What to run.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The scene's file.
    pub scene: PathBuf,
    /// Numbers of cores.
    pub cores: Vec<u16>,
    /// The picture's size in pixels.
    pub size: Size,
    /// Samples of a pixel in the unit that is run on each number of cores, a multiple of 4.
    pub samples: u16,
    /// Whether larger units are run, too, on the most cores; else they cost in proportion.
    pub runs_larger: bool,
    /// The size of the picture by which noise and cycles of estimators are told, and its samples of a pixel; none where energy is not
    /// measured.
    pub energy: Option<(Size, u32)>,
    /// Whether set-up may change the machine.
    pub install: Install,
}

impl Experiment {
    /// Up to 136 cores, on a picture large enough for each to have 79 units.
    ///
    /// Its size is not the published one, of which we know nothing: a picture ends with cores that wait for the last unit, for most of a unit each,
    /// and with the start that is 0.6 to 1.8 % of 79.
    pub fn full(scene: PathBuf, cores: Vec<u16>, install: Install) -> Self {
        let size = |width, height| Size { width, height };
        Self {
            scene,
            cores,
            size: size(480, 360),
            samples: 16,
            runs_larger: true,
            energy: Some((size(64, 48), 1024)),
            install,
        }
    }

    /// A few seconds: a small picture on a few cores, and no energy, which takes eight images.
    pub fn quick(scene: PathBuf, cores: Vec<u16>, install: Install) -> Self {
        let size = |width, height| Size { width, height };
        Self {
            size: size(96, 72),
            samples: 4,
            energy: None,
            ..Self::full(scene, cores, install)
        }
    }
}

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum ScalingError {
    /// There is no folder for the pictures.
    #[error("cannot make a folder for temporary files (set TMPDIR to one with room)")]
    Folder(#[source] io::Error),
    /// A render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// There is nothing to run.
    #[error("no number of cores was given: name some, as in --cores 1,8,136")]
    NoCores,
    /// The light of so many samples does not fit a packet.
    #[error(
        "the light of {samples} samples does not fit a packet in this scene, and what was cut off is another picture: choose a dimmer scene"
    )]
    Saturated {
        /// Samples in a packet.
        samples: u32,
    },
    /// A picture differs.
    #[error(
        "{cores} emulated cores give another picture than this host does: one of the two computes something else; compare them with \
         `cargo xtask bench ops`"
    )]
    Picture {
        /// The cores.
        cores: u16,
    },
    /// A unit's cost differs.
    #[error(
        "a unit took {ticks} ticks more or less on {cores} cores than before, so what it costs depends on more than the unit: is QEMU \
         the one of Debian 12, with -icount?"
    )]
    Ticks {
        /// The cores.
        cores: u16,
        /// The difference.
        ticks: u32,
    },
    /// Two counts of instructions differ.
    #[error(
        "the cores' clocks and QEMU's plugin differ about instructions by {:.2} %: run `cargo xtask test`, which tests both",
        100.0 * apart
    )]
    Counts {
        /// The clocks' share over the plugin's.
        apart: f64,
    },
    /// The recording of packets is empty.
    #[error(
        "nothing was recorded, so there are no cycles to count with: has a function of the core's loop another name?"
    )]
    NoPackets,
    /// Too few samples.
    #[error("noise is told by {least} units of a pixel at least: take more samples")]
    NoNoise {
        /// Units.
        least: u32,
    },
}

/// All figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Figure 4.
    pub scaling: Scaling,
    /// The machine of a million cores, for each way to end a path.
    pub million: Vec<Million>,
    /// Samples and pictures a joule, where they were measured.
    pub energy: Option<Energy>,
}

/// Figure 4.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scaling {
    /// The scene.
    pub scene: String,
    /// Width and height in pixels.
    pub size: [u16; 2],
    /// The board, and the processor that its cycles are of.
    pub board: Board,
    /// Arithmetic.
    pub profile: String,
    /// What is run and what is modelled, in words.
    pub method: Vec<String>,
    /// What the model takes for granted.
    pub assumptions: Vec<published::Assumption>,
    /// Seconds until the collector's answer is there.
    pub answer_seconds: f64,
    /// Cycles that a core takes for a packet.
    pub packet_cycles: f64,
    /// Cycles of an instruction, for each way to end a path.
    pub prices: Vec<Price>,
    /// What was really rendered.
    pub runs: Vec<Run>,
    /// Samples a second against cores: for each way to end a path and number of samples in a packet, without the limit and with it.
    pub series: Vec<Series>,
    /// How many samples a packet needs, for each way to end a path.
    pub derivations: Vec<Derivation>,
}

/// Runs the experiment.
pub fn measure(experiment: &Experiment, interrupted: &AtomicBool) -> Result<Outcome, ScalingError> {
    let folder = tempfile::tempdir().map_err(ScalingError::Folder)?;
    let place = folder.path().to_owned();
    // Whatever of it stays, it is in a folder for what may go away.
    let _removes = LastAct::new(move || drop(std::fs::remove_dir_all(&place)));
    let mut stand = Stand::new(experiment.install)?;
    let mut bench = Bench {
        experiment,
        out: folder.path().to_owned(),
        stand: &mut stand,
        interrupted,
    };
    let (scaling, rates) = bench.scaling()?;
    let usual = PACKET_PIXELS * u32::from(USUAL);
    let million = TERMINATIONS.iter().zip(rates);
    let million = million.map(|(&end, rate)| Million::of(&End(end).to_string(), rate, usual));
    let million = million.collect();
    let measurement = experiment.energy.map(|(size, noise_spp)| Measurement {
        scene: experiment.scene.clone(),
        size,
        noise_spp,
        out: folder.path().to_owned(),
    });
    let energy = measurement.map(|measurement| Energy::measure(&measurement, &mut stand, interrupted));
    let energy = energy.transpose()?;
    Ok(Outcome {
        scaling,
        million,
        energy,
    })
}

struct Bench<'a> {
    experiment: &'a Experiment,
    out: PathBuf,
    stand: &'a mut Stand,
    interrupted: &'a AtomicBool,
}

impl Bench<'_> {
    fn subject(&self, size: Size, termination: Termination, samples: u16) -> Subject {
        Subject {
            scene: self.experiment.scene.clone(),
            size,
            termination,
            samples,
            profile: Arithmetic::Precise,
            integrator: Integrator::Path,
            sampler: Sampler::Independent,
            board: Board::Versatilepb,
            out: self.out.clone(),
        }
    }

    /// Figure 4, and samples a second of one core for each way to end a path.
    fn scaling(&mut self) -> Result<(Scaling, Vec<f64>), ScalingError> {
        let size = self.experiment.size;
        let subject = self.subject(PACKETS, Termination::Roulette, SUBPIXELS as u16);
        let packet_cycles = runs::packet_cycles(&subject, self.stand, self.interrupted)?;
        let mut scaling = Scaling {
            scene: String::new(),
            size: [size.width, size.height],
            board: subject.board,
            profile: subject.profile.to_string(),
            method: table::METHOD.map(str::to_owned).to_vec(),
            assumptions: vec![CLOCK, WIRE],
            answer_seconds: ANSWER.as_secs_f64(),
            packet_cycles,
            prices: Vec::new(),
            runs: Vec::new(),
            series: Vec::new(),
            derivations: Vec::new(),
        };
        let mut rates = Vec::new();
        for termination in TERMINATIONS {
            rates.push(self.add(&mut scaling, termination)?);
        }
        Ok((scaling, rates))
    }

    /// Adds all of one way to end a path; gives samples a second of one core.
    fn add(&mut self, scaling: &mut Scaling, termination: Termination) -> Result<f64, ScalingError> {
        let mut cores = self.experiment.cores.clone();
        cores.sort_unstable();
        cores.dedup();
        let &most = cores.last().ok_or(ScalingError::NoCores)?;
        let small = self.subject(self.experiment.size, termination, self.experiment.samples);
        let picture = Picture::render(small, self.stand, &cores, Recorded::Units, self.interrupted)?;
        picture.scene().clone_into(&mut scaling.scene);
        let price = picture.price()?.ok_or(ScalingError::NoPackets)?;
        scaling.prices.push(price);
        let mut work = scaling.work(&picture, price);
        scaling.draw(&work, &cores, &cores);
        scaling.runs.extend(picture.runs);
        let mut derivation = work.derivation(most);
        let mut larger = |work: &mut Work, samples: u16| -> Result<(), ScalingError> {
            if samples <= work.samples_of_a_pixel {
                return Ok(());
            }
            if !self.experiment.runs_larger {
                *work = work.with_samples(samples);
                scaling.draw(work, &cores, &[]);
                return Ok(());
            }
            let subject = self.subject(self.experiment.size, termination, samples);
            let picture = Picture::render(subject, self.stand, &[most], Recorded::Nothing, self.interrupted)?;
            *work = scaling.work(&picture, price);
            scaling.draw(work, &cores, &[most]);
            scaling.runs.extend(picture.runs);
            Ok(())
        };
        if USUAL < derivation.samples_of_a_pixel {
            larger(&mut work, USUAL)?;
        }
        work.sweep(&mut derivation);
        larger(&mut work, derivation.chosen())?;
        scaling.derivations.push(derivation);
        Ok(work.core_rate())
    }
}

impl Scaling {
    fn work(&self, picture: &Picture, price: Price) -> Work {
        Work {
            termination: picture.subject.termination,
            samples_of_a_pixel: picture.subject.samples,
            samples: picture.samples(),
            costs: picture.costs(price, self.packet_cycles),
            packet: Duration::from_secs_f64(self.packet_cycles / CLOCK.value),
        }
    }

    /// Adds the curves of a picture that so many cores have really rendered, without the limit and with it.
    fn draw(&mut self, work: &Work, cores: &[u16], run: &[u16]) {
        for limit in [None, Some(WIRE.value as u32)] {
            self.series.push(work.series(cores, limit, run));
        }
    }
}

/// The least multiple of 4 samples of a pixel that makes so many samples in a packet.
fn samples_of_a_pixel(samples_per_packet: f64) -> u32 {
    let strata = f64::from(PACKET_PIXELS * SUBPIXELS);
    SUBPIXELS * ((samples_per_packet / strata).ceil() as u32).max(1)
}

/// A figure to as many digits as it is known to.
fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    // By way of text, which has the nearest number that is written so; a division by a power of ten need not.
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests;
