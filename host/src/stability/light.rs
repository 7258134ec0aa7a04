//! Whether looking for light finds what there is: every scene of the repository, by paths that look for it, beside the reference.

use super::part::{SCENE_FOLDERS, SURE, plan, reference, scene_files};
use super::table::figure;
use super::{Effort, Error, Findings, Part, Table};
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::oracle::compare::{Comparison, compare, sidak_threshold};
use crate::oracle::lockstep;
use crate::platform::console::note;
use crate::scene::{Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "light",
    about: "every scene by paths that look for light, beside the reference: as bright, and in every tile",
    measure,
};

const SIZE: [u16; 2] = [32, 24];
/// Samples a pixel of the pilot, and the most.
const PILOT: u64 = 1024;
const MOST: u64 = 1 << 12;
/// What a picture may be off by, as a share of its mean.
const BIAS: f64 = 2e-4;
/// The standard error that is aimed at.
const AIM: f64 = 1e-4;

const UNITS: &str = "Bias: of `precise` with `--integrator next-event --sampler kronecker` from the reference of as many samples, in per cent of the mean, with its \
    standard error. Arithmetic: from the same samples in double precision, likewise. z: the largest of 36 tiles and channels, of what chance allows in all scenes \
    together. Emitters: how many caps and balls are looked for.";
const HEAD: [&str; 6] = ["scene", "emitters", "samples", "bias, %", "arithmetic, %", "z"];

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let files = scene_files(&SCENE_FOLDERS)?;
    let mut table = Table::new("Looking for light", UNITS, &HEAD);
    let (mut faults, mut all) = (Vec::new(), Pooled::default());
    for file in &files {
        let scene = Scene::load(file)?;
        let found = Found::of(effort, &scene)?;
        let row = found.row(&scene.name, files.len());
        // At once, because all scenes take long.
        note(row.join("  "));
        table.push(row);
        faults.extend(found.faults(&scene.name, files.len()));
        if found.emitters != [0, 0] {
            all.add(&found.independent);
        }
    }
    table.push(all.row());
    faults.extend(all.fault());
    Ok(Findings {
        tables: vec![table],
        faults,
        ..Findings::default()
    })
}

/// The biases of all scenes that have something to look for, each with the weight that its noise gives it: what one scene alone is too noisy to tell.
#[derive(Default)]
struct Pooled {
    weights: f64,
    biases: f64,
}

impl Pooled {
    fn add(&mut self, found: &Comparison) {
        if let (Some(bias), Some(error)) = (found.bias, found.bias_standard_error)
            && error > 0.0
        {
            let weight = 1.0 / (error * error);
            self.weights += weight;
            self.biases += weight * bias;
        }
    }

    /// The bias, and its standard error.
    fn bias(&self) -> (f64, f64) {
        (self.biases / self.weights, self.weights.sqrt().recip())
    }

    fn row(&self) -> Vec<String> {
        let (bias, error) = self.bias();
        let bias = format!("{} ± {}", figure(100.0 * bias), figure(100.0 * error));
        let nothing = String::new;
        vec![
            "those with emitters".to_owned(),
            nothing(),
            nothing(),
            bias,
            nothing(),
            nothing(),
        ]
    }

    fn fault(&self) -> Option<String> {
        let (bias, error) = self.bias();
        let is_off = bias.abs() > BIAS + SURE * error;
        is_off.then(|| format!("scenes with emitters together: the mean is off by {bias:+.6} ± {error:.6}"))
    }
}

/// A scene beside its reference.
struct Found {
    spp: u32,
    emitters: [usize; 2],
    /// From the reference.
    independent: Comparison,
    /// From the same samples in double precision.
    arithmetic: Comparison,
}

impl Found {
    /// With as many samples as the aim takes, by a pilot that is not used again.
    fn of(effort: &Effort, scene: &Scene) -> Result<Self, Error> {
        let (pilot, most) = (samples(effort.of(PILOT)), samples(effort.of(MOST)));
        let found = Self::with(effort, scene, pilot)?;
        let error = found.independent.bias_standard_error.unwrap_or_default();
        let wanted = f64::from(pilot) * (error / AIM).powi(2);
        // Casts saturate.
        let wanted = samples(wanted as u64).clamp(pilot, most);
        if wanted == pilot {
            return Ok(found);
        }
        Self::with(effort, scene, wanted)
    }

    fn with(effort: &Effort, scene: &Scene, spp: u32) -> Result<Self, Error> {
        let compiled = compile(scene, SIZE[0], SIZE[1], Integrator::NextEvent);
        let plan = plan(Arithmetic::Precise, &compiled, SIZE, spp);
        effort.expect(u64::from(SIZE[0]) * u64::from(SIZE[1]) * 2 * u64::from(spp));
        let paired = lockstep::render_as(
            Arithmetic::Precise,
            Sampler::Kronecker,
            &compiled,
            &plan,
            |samples| {
                effort.done(samples);
            },
        );
        let rendered = reference(effort, scene, SIZE, spp);
        let picture = rendered.pooled_noise(paired.picture.clone(), Integrator::NextEvent);
        let (fixed, double) = paired.difference();
        let lights = compiled.view().lights;
        Ok(Self {
            spp,
            emitters: [lights.caps.len(), lights.balls.len()],
            independent: compare(&picture, &rendered.estimate)?,
            arithmetic: compare(&fixed, &double)?,
        })
    }

    fn row(&self, name: &str, scenes: usize) -> Vec<String> {
        let share = |found: &Comparison| match (found.bias, found.bias_standard_error) {
            (Some(bias), Some(error)) => format!("{} ± {}", figure(100.0 * bias), figure(100.0 * error)),
            _ => "dark".to_owned(),
        };
        vec![
            name.to_owned(),
            format!("{} + {}", self.emitters[0], self.emitters[1]),
            self.spp.to_string(),
            share(&self.independent),
            share(&self.arithmetic),
            format!(
                "{:.2} of {:.2}",
                self.independent.tiles.max_z(),
                self.bound(scenes)
            ),
        ]
    }

    /// The z that one of all scenes' tiles exceeds with a chance of 1 %.
    fn bound(&self, scenes: usize) -> f64 {
        sidak_threshold(3 * self.independent.tiles.tiles.len() * scenes)
    }

    fn faults(&self, name: &str, scenes: usize) -> Vec<String> {
        let mut faults = Vec::new();
        if let (Some(bias), Some(error)) = (self.independent.bias, self.independent.bias_standard_error)
            && bias.abs() > BIAS + SURE * error
        {
            faults.push(format!(
                "{name}: the mean is off by {bias:+.6} ± {error:.6}, more than {BIAS}"
            ));
        }
        let worst = self.independent.tiles.max_z();
        if worst.abs() > self.bound(scenes) {
            faults.push(format!("{name}: a tile is off by a z of {worst:.2}"));
        }
        faults
    }
}

/// A multiple of a unit's samples.
fn samples(wanted: u64) -> u32 {
    u32::try_from(wanted.max(64).next_multiple_of(64)).unwrap_or(u32::MAX - 63)
}
