//! Samples a joule, and pictures a joule: of machines whose speed is measured or published, and whose power is assumed.
//!
//! A *picture of a given error* is one whose typical pixel (the geometric mean over pixels, as in `bench trace`) has that standard
//! error. How many samples it takes depends on the estimator alone, what they cost on the machine alone.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde::Serialize;
use tracer::unit::{Plan, Termination};

use super::published::{
    Assumption, CHIP_POWER, CHIP_RENDERERS, CLOCK, CORE_RATE, CORES, M3_CLOCK, M3_CURRENT, M3_VOLTAGE,
    PROCESSOR_POWER, PROCESSOR_RATE, THREAD_POWER,
};
use super::runs::{Picture, Subject};
use super::{ScalingError, rounded};
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::oracle::direct;
use crate::oracle::noise::{self, Noise};
use crate::platform::console::{note, patiently};
use crate::render::RenderError;
use crate::render::options::Size;
use crate::render::timed::{Recorded, Stand};
use crate::scene::{Integrator, Scene, compile, samples_per_unit};

/// The standard error of the typical pixel, in linear radiance.
const ERROR: f64 = 0.01;
/// The picture's pixels: those of the README's.
const PICTURE: Size = Size {
    width: 256,
    height: 192,
};
/// Samples of a pixel by which cycles are counted.
const COUNTED_SAMPLES: u16 = 16;
/// Of the random numbers by which noise is told.
const NOISE_SEED: u64 = 2;

/// Processors by the name in `/proc/cpuinfo`, with their makers' thermal design power in watts and their threads.
const PROCESSORS: [(&str, f64, f64); 6] = [
    ("AMD EPYC 7763", 280.0, 128.0),
    ("AMD EPYC 9654", 360.0, 192.0),
    ("AMD Ryzen 9 5950X", 105.0, 32.0),
    ("Intel(R) Xeon(R) Platinum 8380", 270.0, 80.0),
    ("Intel(R) Core(TM) i7-3770", 77.0, 8.0),
    ("Intel(R) Core(TM) i9-9900K", 95.0, 16.0),
];

/// What is measured for it.
#[derive(Clone, Debug)]
pub(super) struct Measurement {
    pub(super) scene: PathBuf,
    pub(super) size: Size,
    /// Samples of a pixel by which noise is told.
    pub(super) noise_spp: u32,
    pub(super) out: PathBuf,
}

/// A way to find a pixel's radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Estimator {
    profile: Arithmetic,
    integrator: Integrator,
    sampler: Sampler,
}

const ESTIMATORS: [Estimator; 4] = [
    Estimator::new(Arithmetic::Paper, Integrator::Path, Sampler::Independent),
    Estimator::new(Arithmetic::Precise, Integrator::Path, Sampler::Independent),
    Estimator::new(Arithmetic::Precise, Integrator::NextEvent, Sampler::Independent),
    Estimator::new(Arithmetic::Precise, Integrator::NextEvent, Sampler::Kronecker),
];

/// Samples and pictures a joule.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Energy {
    /// What it rests on besides what is measured.
    pub assumptions: Vec<Assumption>,
    /// The standard error of the typical pixel, in linear radiance.
    pub error: f64,
    /// Width and height of the picture that is counted, in pixels.
    pub picture: [u16; 2],
    /// The estimators, with what they take.
    pub estimators: Vec<Cost>,
    /// The processor of this host, and threads that it has here.
    pub processor: String,
    /// As said.
    pub threads: usize,
    /// All machines with all estimators.
    pub rows: Vec<Row>,
}

/// What an estimator takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Profile, integrator and sampler.
    pub estimator: String,
    /// Cycles of a sample on an ARM9E-S.
    pub arm9_cycles: f64,
    /// On a Cortex-M3.
    pub cortex_m3_cycles: f64,
    /// Variance of a sample: the geometric mean over pixels.
    pub variance: f64,
    /// Samples of a pixel that bring the error about.
    pub samples_of_a_pixel: f64,
    /// Samples a second of this host without an emulator. It depends on the host and what else it does.
    pub host_rate: f64,
}

/// A machine with an estimator.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The machine.
    pub machine: &'static str,
    /// The estimator.
    pub estimator: String,
    /// Samples a second.
    pub samples_per_second: f64,
    /// Watts.
    pub watts: f64,
    /// Samples a joule.
    pub samples_per_joule: f64,
    /// Pictures of the given error a joule.
    pub pictures_per_joule: f64,
}

impl Estimator {
    const fn new(profile: Arithmetic, integrator: Integrator, sampler: Sampler) -> Self {
        Self {
            profile,
            integrator,
            sampler,
        }
    }

    fn name(self) -> String {
        format!("{} {} {}", self.profile, self.integrator, self.sampler)
    }

    /// Cycles of a sample on a board.
    fn cycles(
        self,
        measurement: &Measurement,
        board: Board,
        stand: &mut Stand,
        interrupted: &AtomicBool,
    ) -> Result<f64, ScalingError> {
        let subject = Subject {
            scene: measurement.scene.clone(),
            size: measurement.size,
            termination: Termination::Roulette,
            samples: COUNTED_SAMPLES,
            profile: self.profile,
            integrator: self.integrator,
            sampler: self.sampler,
            board,
            out: measurement.out.clone(),
        };
        let picture = Picture::render(subject, stand, &[1], Recorded::Units, interrupted)?;
        let price = picture.price()?.ok_or(ScalingError::NoPackets)?;
        let instructions = picture
            .runs
            .first()
            .map_or(0.0, |run| run.instructions_per_sample);
        Ok(rounded(instructions * price.likely))
    }

    /// Its noise, and samples a second of this host.
    fn noise(self, measurement: &Measurement) -> Result<(Noise, f64), ScalingError> {
        let Size { width, height } = measurement.size;
        let scene = Scene::load(&measurement.scene).map_err(RenderError::from)?;
        let compiled = compile(&scene, width, height, self.integrator);
        let plan = Plan {
            width,
            height,
            spp: measurement.noise_spp,
            samples_per_unit: samples_per_unit(&scene, measurement.noise_spp, Termination::Roulette),
            seed: NOISE_SEED,
            termination: Termination::Roulette,
            epsilon: self.profile.epsilon(scene.scale().magnification),
        };
        let noise = noise::noise(self.profile, self.sampler, &compiled, &plan, |_| ());
        let noise = noise.ok_or(ScalingError::NoNoise {
            least: noise::FEWEST_UNITS,
        })?;
        let start = Instant::now();
        let film = direct::film_as(self.profile, self.sampler, &compiled, &plan);
        let rate = film.samples() as f64 / start.elapsed().as_secs_f64();
        Ok((noise, rate))
    }

    fn cost(
        self,
        measurement: &Measurement,
        stand: &mut Stand,
        interrupted: &AtomicBool,
    ) -> Result<Cost, ScalingError> {
        note(format!("energy: {}", self.name()));
        let [arm9_cycles, cortex_m3_cycles] = [
            self.cycles(measurement, Board::Versatilepb, stand, interrupted)?,
            self.cycles(measurement, Board::Mps2An385, stand, interrupted)?,
        ];
        let (noise, host_rate) = patiently("telling noise", || self.noise(measurement))?;
        let variance = typical(&noise);
        Ok(Cost {
            estimator: self.name(),
            arm9_cycles,
            cortex_m3_cycles,
            variance: rounded(variance),
            samples_of_a_pixel: rounded(variance / (ERROR * ERROR)),
            host_rate,
        })
    }
}

/// The geometric mean over pixels.
fn typical(noise: &Noise) -> f64 {
    let one = Noise {
        variance: vec![1.0; noise.variance.len()],
    };
    1.0 / noise.less_than(&one)
}

impl Energy {
    /// Measures what the estimators take, and works the rest out.
    pub(super) fn measure(
        measurement: &Measurement,
        stand: &mut Stand,
        interrupted: &AtomicBool,
    ) -> Result<Self, ScalingError> {
        let costs = ESTIMATORS.map(|estimator| estimator.cost(measurement, stand, interrupted));
        let estimators = costs.into_iter().collect::<Result<Vec<_>, _>>()?;
        let processor = processor();
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let known = thermal_design_power(&processor, threads as f64);
        let host_watts = known.unwrap_or(threads as f64 * THREAD_POWER.value);
        let mut assumptions = vec![
            CLOCK,
            CHIP_POWER,
            CHIP_RENDERERS,
            CORE_RATE,
            PROCESSOR_RATE,
            PROCESSOR_POWER,
            M3_CURRENT,
            M3_VOLTAGE,
            M3_CLOCK,
        ];
        assumptions.extend(known.is_none().then_some(THREAD_POWER));
        Ok(Self {
            assumptions,
            error: ERROR,
            picture: [PICTURE.width, PICTURE.height],
            rows: rows(&estimators, host_watts),
            estimators,
            processor,
            threads,
        })
    }
}

fn rows(costs: &[Cost], host_watts: f64) -> Vec<Row> {
    let cores = f64::from(CORES);
    let machine_watts = cores / CHIP_RENDERERS.value * CHIP_POWER.value;
    // uA/MHz times V is 10^-12 J a cycle.
    let m3_watts = M3_CURRENT.value * M3_VOLTAGE.value * 1e-12 * M3_CLOCK.value;
    let mut rows = Vec::new();
    if let [published, plain, ..] = costs {
        let rate = cores * CORE_RATE.value;
        rows.push(Row::of(
            "published machine, as published",
            published,
            rate,
            machine_watts,
        ));
        // Its noise is that of double precision, which is `precise`'s.
        rows.push(Row::of(
            "published processor",
            plain,
            PROCESSOR_RATE.value,
            PROCESSOR_POWER.value,
        ));
    }
    for cost in costs {
        let arm9 = cores * CLOCK.value / cost.arm9_cycles;
        rows.push(Row::of("136 SpiNNaker cores", cost, arm9, machine_watts));
    }
    for cost in costs {
        let m3 = M3_CLOCK.value / cost.cortex_m3_cycles;
        rows.push(Row::of("one Cortex-M3", cost, m3, m3_watts));
    }
    for cost in costs {
        rows.push(Row::of("this host", cost, cost.host_rate, host_watts));
    }
    rows
}

impl Row {
    fn of(machine: &'static str, cost: &Cost, samples_per_second: f64, watts: f64) -> Self {
        let samples_per_joule = samples_per_second / watts;
        let samples = f64::from(PICTURE.width) * f64::from(PICTURE.height) * cost.samples_of_a_pixel;
        Self {
            machine,
            estimator: cost.estimator.clone(),
            samples_per_second,
            watts,
            samples_per_joule,
            pictures_per_joule: samples_per_joule / samples,
        }
    }
}

/// What Linux calls this host's processor.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text.lines().find(|line| line.starts_with("model name"));
    let name = model.and_then(|line| line.split_once(':'));
    name.map_or_else(|| "unknown".to_owned(), |(_, name)| name.trim().to_owned())
}

/// The share of a known processor's thermal design power that so many of its threads have.
fn thermal_design_power(processor: &str, threads: f64) -> Option<f64> {
    let known = PROCESSORS.iter().find(|(name, ..)| processor.contains(name));
    known.map(|(_, watts, all)| watts * (threads / all).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(estimator: &str, arm9_cycles: f64, samples_of_a_pixel: f64) -> Cost {
        Cost {
            estimator: estimator.to_owned(),
            arm9_cycles,
            cortex_m3_cycles: arm9_cycles,
            variance: 0.0,
            samples_of_a_pixel,
            host_rate: 1e6,
        }
    }

    /// 136 cores of 200 MHz and 8 W at 2,000 cycles a sample make 13.6 million samples a second, 1.7 million a joule.
    #[test]
    fn energy_is_power_over_speed() {
        let rows = rows(&[cost("a", 2000.0, 10.0), cost("b", 1000.0, 1.0)], 4.0);
        let of = |machine: &str| {
            rows.iter()
                .filter(|row| row.machine == machine)
                .collect::<Vec<_>>()
        };
        let machine = of("136 SpiNNaker cores");
        assert_eq!(machine[0].samples_per_joule, 1.7e6);
        assert_eq!(machine[0].pictures_per_joule, 1.7e6 / (256.0 * 192.0 * 10.0));
        assert_eq!(machine[1].pictures_per_joule, 3.4e6 / (256.0 * 192.0));
        assert_eq!(of("this host")[0].samples_per_joule, 1e6 / 4.0);
        // 219 uA/MHz at 3 V are 657 pJ a cycle.
        let m3 = of("one Cortex-M3")[0].samples_per_joule;
        assert!((m3 * 657e-12 * 2000.0 - 1.0).abs() < 1e-12, "{m3}");
        let published = of("published machine, as published")[0].samples_per_joule;
        assert_eq!(published, 530_226.0 / 4.0 / 8.0);
    }

    #[test]
    fn power_is_known_of_known_processors_only() {
        assert_eq!(
            thermal_design_power("AMD EPYC 7763 64-Core Processor", 64.0),
            Some(140.0)
        );
        assert_eq!(thermal_design_power("AMD EPYC", 2.0), None);
    }

    #[test]
    fn the_typical_pixel_is_the_geometric_mean() {
        let noise = Noise {
            variance: vec![1.0, 4.0, 16.0],
        };
        assert!((typical(&noise) - 4.0).abs() < 1e-12);
    }
}
