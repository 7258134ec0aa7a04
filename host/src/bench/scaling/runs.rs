//! Pictures that emulated cores really render, again and again on more of them: what each unit cost, and that nothing depends on how many
//! there were.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use serde::Serialize;
use tracer::unit::Termination;

use super::published::CLOCK;
use super::{PACKET_PIXELS, ScalingError, rounded};
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::{Board, INSTRUCTIONS_PER_TICK};
use crate::platform::console::note;
use crate::render::options::{End, PictureOptions, Pixels, Reference, Size};
use crate::render::timed::{Counted, Recorded, Stand, Timed, TimedPicture};
use crate::scene::Integrator;

/// Ticks by which two runs of a unit may differ: where its beginning falls between two ticks.
const TICKS_APART: u32 = 1;
/// The share by which the cores' clocks and QEMU's plugin may differ about instructions: a few dozen of a unit's are outside the
/// function that is recorded.
const COUNTS_APART: f64 = 0.005;
const NANOSECONDS: f64 = 1e9;

/// What is rendered.
#[derive(Clone, Debug)]
pub(super) struct Subject {
    pub(super) scene: PathBuf,
    pub(super) size: Size,
    pub(super) termination: Termination,
    /// Samples of a pixel: all of them in one unit.
    pub(super) samples: u16,
    pub(super) profile: Arithmetic,
    pub(super) integrator: Integrator,
    pub(super) sampler: Sampler,
    pub(super) board: Board,
    pub(super) out: PathBuf,
}

/// One picture, really rendered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// Samples in a packet.
    pub samples_per_packet: u32,
    /// Emulated cores that were started, and that rendered at least one unit.
    pub cores: u16,
    /// As said.
    pub cores_at_work: usize,
    /// Units of the picture, a packet each.
    pub units: usize,
    /// Instructions of a sample, by the cores' clocks.
    pub instructions_per_sample: f64,
    /// The most ticks of 24 MHz by which a unit differs from the picture's first run.
    pub most_ticks_apart: u32,
    /// What QEMU's plugin counted on each core, where it did: cycles per instruction of the core with fewest and most.
    pub cycles_per_instruction: Option<[f64; 2]>,
    /// The picture: the same for every number of cores, and of this host without an emulator.
    pub image_sha256: String,
    /// Seconds of this host until all cores were there, and from then on. They depend on its load; nothing else does.
    pub host_seconds: [f64; 2],
}

impl Subject {
    pub(super) fn timed(&self, cores: u16, recorded: Recorded) -> TimedPicture {
        TimedPicture {
            picture: PictureOptions {
                scene: Some(self.scene.clone()),
                size: self.size,
                spp: self.samples.into(),
                cores,
                profile: self.profile,
                integrator: Some(self.integrator),
                sampler: Some(self.sampler),
                epsilon: None,
                termination: End(self.termination),
                pixels: Pixels::Leased,
                seed: 1,
                reference: Some(Reference::None),
                reference_spp: None,
                patience: None,
                reference_cache: None,
                out: Some(self.out.clone()),
            },
            samples_per_unit: self.samples,
            board: self.board,
            recorded,
        }
    }

    pub(super) fn samples_per_packet(&self) -> u32 {
        PACKET_PIXELS * u32::from(self.samples)
    }

    /// Renders it on so many cores.
    fn render(
        &self,
        stand: &mut Stand,
        cores: u16,
        recorded: Recorded,
        interrupted: &AtomicBool,
    ) -> Result<Timed, ScalingError> {
        let end = End(self.termination);
        let cut = self.samples_per_packet();
        note(format!("cores: {cores}, {end}, {cut} samples a packet"));
        let timed = stand.render(&self.timed(cores, recorded), interrupted)?;
        if timed.saturated_sums > 0 {
            return Err(ScalingError::Saturated { samples: cut });
        }
        Ok(timed)
    }
}

/// A picture whose units have been timed, and all its runs.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) subject: Subject,
    /// The first run.
    first: Timed,
    pub(super) runs: Vec<Run>,
}

impl Picture {
    /// Renders it on each number of cores in turn. The first and the last fleet are recorded, if any is to be.
    pub(super) fn render(
        subject: Subject,
        stand: &mut Stand,
        fleets: &[u16],
        recorded: Recorded,
        interrupted: &AtomicBool,
    ) -> Result<Self, ScalingError> {
        let (&least, more) = fleets.split_first().ok_or(ScalingError::NoCores)?;
        let first = subject.render(stand, least, recorded, interrupted)?;
        let expected = subject.timed(least, recorded).expected_sha256()?;
        let mut picture = Self {
            subject,
            first,
            runs: Vec::new(),
        };
        picture.add(least, &picture.first.clone(), &expected)?;
        for &cores in more {
            let is_last = more.last() == Some(&cores);
            let recorded = if is_last { recorded } else { Recorded::Nothing };
            let timed = picture.subject.render(stand, cores, recorded, interrupted)?;
            picture.add(cores, &timed, &expected)?;
        }
        Ok(picture)
    }

    /// Adds a run, which must be of the same picture, to the bit and to the tick.
    fn add(&mut self, cores: u16, timed: &Timed, expected: &str) -> Result<(), ScalingError> {
        let run = Run {
            termination: End(self.subject.termination).to_string(),
            samples_per_packet: self.subject.samples_per_packet(),
            cores,
            cores_at_work: timed.cores_at_work(),
            units: timed.units.len(),
            instructions_per_sample: rounded(instructions(timed) / timed.samples() as f64),
            most_ticks_apart: most_ticks_apart(&self.first, timed),
            cycles_per_instruction: between(&timed.counted),
            image_sha256: timed.image_sha256.clone(),
            host_seconds: timed.wall.map(|wall| wall.as_secs_f64()),
        };
        if run.image_sha256 != expected {
            return Err(ScalingError::Picture { cores });
        }
        if run.most_ticks_apart > TICKS_APART {
            let ticks = run.most_ticks_apart;
            return Err(ScalingError::Ticks { cores, ticks });
        }
        self.runs.push(run);
        Ok(())
    }

    /// The scene's name.
    pub(super) fn scene(&self) -> &str {
        &self.first.scene
    }

    /// Samples of the whole picture.
    pub(super) fn samples(&self) -> u64 {
        self.first.samples()
    }

    /// What the first run's recording says, where it was recorded.
    pub(super) fn price(&self) -> Result<Option<Price>, ScalingError> {
        let all = self
            .first
            .counted
            .iter()
            .fold(Counted::default(), |sum, core| Counted {
                calls: sum.calls + core.calls,
                instructions: sum.instructions + core.instructions,
                cycles: sum.cycles + core.cycles,
            });
        if all.instructions == 0 {
            return Ok(None);
        }
        // A unit that was rendered twice was recorded twice.
        let once = self.first.units.len() as f64 / all.calls as f64;
        let apart = instructions(&self.first) / (all.instructions as f64 * once) - 1.0;
        if apart.abs() > COUNTS_APART {
            return Err(ScalingError::Counts { apart });
        }
        let by = |cycles: u64| cycles as f64 / all.instructions as f64;
        Ok(Some(Price {
            low: by(all.cycles.low),
            likely: by(all.cycles.likely),
            high: by(all.cycles.high),
        }))
    }

    /// What each unit costs a core: its instructions by the core's clock, at so many cycles each, and a packet.
    pub(super) fn costs(&self, price: Price, packet_cycles: f64) -> Vec<Duration> {
        let units = self.first.units.iter();
        units
            .map(|unit| {
                let cycles = f64::from(unit.ticks) * INSTRUCTIONS_PER_TICK * price.likely + packet_cycles;
                Duration::from_nanos((cycles / CLOCK.value * NANOSECONDS).round() as u64)
            })
            .collect()
    }
}

/// Cycles of an instruction of the tracer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Price {
    /// The least that it may be, by what the processor's model does not see.
    pub low: f64,
    /// The figure that all others rest on.
    pub likely: f64,
    /// The most.
    pub high: f64,
}

/// Instructions of all units by their cores' clocks.
fn instructions(timed: &Timed) -> f64 {
    let ticks: u64 = timed.units.iter().map(|unit| u64::from(unit.ticks)).sum();
    ticks as f64 * INSTRUCTIONS_PER_TICK
}

fn most_ticks_apart(first: &Timed, other: &Timed) -> u32 {
    let pairs = first.units.iter().zip(&other.units);
    pairs
        .map(|(first, other)| first.ticks.abs_diff(other.ticks))
        .max()
        .unwrap_or_default()
}

/// Cycles per instruction of the core with fewest and of the one with most.
fn between(counted: &[Counted]) -> Option<[f64; 2]> {
    let at_work = counted.iter().filter(|core| core.instructions > 0);
    let each = at_work.map(|core| core.cycles.likely as f64 / core.instructions as f64);
    each.fold(None, |range, one| {
        let [least, most] = range.unwrap_or([one, one]);
        Some([least.min(one), most.max(one)])
    })
    .map(|range| range.map(rounded))
}

/// Cycles that a core takes to put a packet together and to hand it to the network card, by a recording of just that.
pub(super) fn packet_cycles(
    subject: &Subject,
    stand: &mut Stand,
    interrupted: &AtomicBool,
) -> Result<f64, ScalingError> {
    let timed = subject.render(stand, 1, Recorded::Packets, interrupted)?;
    let (calls, cycles) = timed.counted.iter().fold((0, 0), |(calls, cycles), core| {
        (calls + core.calls, cycles + core.cycles.likely)
    });
    if calls == 0 {
        return Err(ScalingError::NoPackets);
    }
    Ok(rounded(cycles as f64 / calls as f64))
}
