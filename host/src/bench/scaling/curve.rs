//! Figure 4: samples a second against cores, and how many samples a packet must carry so that the wire does not bend it.

use std::time::Duration;

use serde::Serialize;
use tracer::unit::Termination;

use super::machine::{Course, Machine, simulate};
use super::published::WIRE;
use super::{ANSWER, PACKET_PIXELS, rounded, samples_of_a_pixel};
use crate::collector::leases::LEASES_PER_CORE;
use crate::render::options::End;

/// Shares of the derived number of samples at which the simulation is run besides.
const SHARES: [f64; 9] = [0.0625, 0.125, 0.25, 0.5, 0.9, 1.1, 1.25, 1.5, 2.0];
/// The share of linear that is wanted.
const WANTED: f64 = 0.98;

/// Units, and what they are of.
#[derive(Clone, Debug)]
pub(super) struct Work {
    pub(super) termination: Termination,
    /// Samples of a pixel in each unit.
    pub(super) samples_of_a_pixel: u16,
    /// Samples in all.
    pub(super) samples: u64,
    /// What each unit costs a core, packet and all.
    pub(super) costs: Vec<Duration>,
    /// What of that the packet is.
    pub(super) packet: Duration,
}

/// Samples a second against cores.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// Samples in a packet.
    pub samples_per_packet: u32,
    /// Packets that leave the machine in a second at most; null where the limit is off.
    pub packets_per_second: Option<u32>,
    /// In order of their cores.
    pub points: Vec<Point>,
}

/// A machine of so many cores.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Its cores.
    pub cores: u16,
    /// Whether this picture was really rendered by so many emulated cores; else its units' costs are those of other runs.
    pub run: bool,
    /// Samples a second, from the cores' start to the arrival of the last unit.
    pub samples_per_second: f64,
    /// By how many times those of one core without a limit.
    pub share_of_linear: f64,
    /// Packets a second, HELLOs among them.
    pub packets_per_second: f64,
    /// Samples a second if cores that wait for work did not say so: what the wire carries where it is the units' alone.
    pub quiet_samples_per_second: f64,
    /// Virtual seconds of the whole picture.
    pub seconds: f64,
    /// Virtual seconds that a packet waited for the wire at most, its own time on it included.
    pub longest_wait: f64,
}

/// How many samples a packet needs.
///
/// All cores together send cores over seconds-a-packet packets in a second, and a packet takes a core its samples' time and its own. That
/// they are not more than the wire carries needs cores over packets-a-second seconds a packet, less its own time, over seconds a sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Derivation {
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// Cores.
    pub cores: u16,
    /// Packets a second at most.
    pub packets_per_second: u32,
    /// Samples a second that a core renders, packets apart: in the mean over the picture, and where it is quickest, over as many units in
    /// a row as the cores hold in leases.
    pub samples_per_second_a_core: [f64; 2],
    /// Samples that a packet needs by either.
    pub samples_per_packet_needed: [f64; 2],
    /// The least 16 pixels of a multiple of 4 samples that are as many as the latter.
    pub samples_per_packet: u32,
    /// That many samples of a pixel.
    pub samples_of_a_pixel: u16,
    /// The fewest samples in a packet, of those in `sweep`, that give 0.98 of linear with all HELLOs.
    pub enough: Option<u32>,
    /// The same machine with fewer and more samples in a packet: units cost in proportion to their samples, which is modelled.
    pub sweep: Vec<Sweep>,
}

/// The machine with another number of samples in a packet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// Samples in a packet.
    pub samples_per_packet: u32,
    /// What the wire carries of them: samples a second.
    pub wire: f64,
    /// Samples a second.
    pub samples_per_second: f64,
    /// If cores that wait for work did not say so.
    pub quiet_samples_per_second: f64,
    /// By how many times `samples_per_second` is that of one core.
    pub share_of_linear: f64,
}

impl Derivation {
    /// Samples of a pixel that this machine shall have in a packet.
    pub(super) fn chosen(&self) -> u16 {
        let enough = self.enough.map(|packet| packet / PACKET_PIXELS);
        enough
            .and_then(|samples| u16::try_from(samples).ok())
            .unwrap_or(self.samples_of_a_pixel)
    }
}

impl Work {
    /// The same work in units of another number of samples: as many units, each of which costs in proportion.
    pub(super) fn with_samples(&self, samples_of_a_pixel: u16) -> Self {
        let more = f64::from(samples_of_a_pixel) / f64::from(self.samples_of_a_pixel);
        let cost = |&cost: &Duration| cost.saturating_sub(self.packet).mul_f64(more) + self.packet;
        Self {
            samples_of_a_pixel,
            samples: self.samples / u64::from(self.samples_of_a_pixel) * u64::from(samples_of_a_pixel),
            costs: self.costs.iter().map(cost).collect(),
            ..self.clone()
        }
    }

    pub(super) fn samples_per_packet(&self) -> u32 {
        PACKET_PIXELS * u32::from(self.samples_of_a_pixel)
    }

    fn rate(&self, cores: u16, packets_per_second: Option<u32>, quiet: bool) -> f64 {
        self.rate_of(&self.course(cores, packets_per_second, quiet))
    }

    fn course(&self, cores: u16, packets_per_second: Option<u32>, quiet: bool) -> Course {
        let machine = Machine {
            cores,
            packets_per_second,
            answer: ANSWER,
            quiet,
        };
        simulate(machine, &self.costs)
    }

    fn rate_of(&self, course: &Course) -> f64 {
        self.samples as f64 / course.last.as_secs_f64()
    }

    /// Samples a second of one core without a limit.
    pub(super) fn core_rate(&self) -> f64 {
        self.rate(1, None, false)
    }

    /// Samples a second against cores. `run` says on how many cores it was really rendered.
    pub(super) fn series(&self, cores: &[u16], packets_per_second: Option<u32>, run: &[u16]) -> Series {
        let linear = self.core_rate();
        let point = |&cores: &u16| {
            let course = self.course(cores, packets_per_second, false);
            let rate = self.rate_of(&course);
            Point {
                cores,
                run: run.contains(&cores),
                samples_per_second: rounded(rate),
                share_of_linear: rounded(rate / (f64::from(cores) * linear)),
                packets_per_second: rounded(course.packets as f64 / course.last.as_secs_f64()),
                quiet_samples_per_second: rounded(self.rate(cores, packets_per_second, true)),
                seconds: rounded(course.last.as_secs_f64()),
                longest_wait: rounded(course.longest_wait.as_secs_f64()),
            }
        };
        Series {
            termination: End(self.termination).to_string(),
            samples_per_packet: self.samples_per_packet(),
            packets_per_second,
            points: cores.iter().map(point).collect(),
        }
    }

    /// How many samples a packet of this machine needs, by the costs of this work.
    pub(super) fn derivation(&self, cores: u16) -> Derivation {
        let rates = self.rendering_rates(cores);
        let own = self.packet.as_secs_f64();
        let needed = rates.map(|rate| (f64::from(cores) / WIRE.value - own) * rate);
        let derived = samples_of_a_pixel(needed[1]).min(wire::MAX_SAMPLES.into());
        Derivation {
            termination: End(self.termination).to_string(),
            cores,
            packets_per_second: WIRE.value as u32,
            samples_per_second_a_core: rates.map(rounded),
            samples_per_packet_needed: needed.map(rounded),
            samples_per_packet: PACKET_PIXELS * derived,
            samples_of_a_pixel: derived as u16,
            enough: None,
            sweep: Vec::new(),
        }
    }

    /// Samples a second that a core renders: in the mean, and over the quickest units in a row that are as many as the cores' leases.
    fn rendering_rates(&self, cores: u16) -> [f64; 2] {
        let seconds: Vec<f64> = self
            .costs
            .iter()
            .map(|cost| cost.saturating_sub(self.packet).as_secs_f64())
            .collect();
        let held = (usize::from(cores) * LEASES_PER_CORE).clamp(1, seconds.len().max(1));
        let quickest = seconds.windows(held).map(|units| units.iter().sum::<f64>());
        let quickest = quickest.fold(f64::INFINITY, f64::min);
        let unit = self.samples as f64 / seconds.len() as f64;
        [
            self.samples as f64 / seconds.iter().sum::<f64>(),
            unit * held as f64 / quickest,
        ]
    }

    /// Adds this machine with as many samples in a packet as were derived, by either rate, and with fewer and more.
    pub(super) fn sweep(&self, derivation: &mut Derivation) {
        let [mean, _] = derivation.samples_per_packet_needed;
        let packet = f64::from(derivation.samples_per_packet);
        let others = SHARES.iter().map(|share| share * packet).chain([mean]);
        let others = others.filter_map(|samples| u16::try_from(samples_of_a_pixel(samples)).ok());
        let mut sizes: Vec<u16> = others
            .filter(|&samples| samples <= wire::MAX_SAMPLES)
            .chain([derivation.samples_of_a_pixel])
            .collect();
        sizes.sort_unstable();
        sizes.dedup();
        let swept = |samples| self.with_samples(samples).swept(derivation.cores);
        derivation.sweep = sizes.into_iter().map(swept).collect();
        let enough = derivation
            .sweep
            .iter()
            .find(|sweep| sweep.share_of_linear >= WANTED);
        derivation.enough = enough.map(|sweep| sweep.samples_per_packet);
    }

    fn swept(&self, cores: u16) -> Sweep {
        let limit = Some(WIRE.value as u32);
        let rate = self.rate(cores, limit, false);
        Sweep {
            samples_per_packet: self.samples_per_packet(),
            wire: WIRE.value * f64::from(self.samples_per_packet()),
            samples_per_second: rounded(rate),
            quiet_samples_per_second: rounded(self.rate(cores, limit, true)),
            share_of_linear: rounded(rate / (f64::from(cores) * self.core_rate())),
        }
    }
}
