//! Scenes that are hard for the arithmetic, each with the figures that are expected of it.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::Deserialize;
use tracer::profile::{Paper, Precise};

use super::part::plan;
use super::sheet::Panel;
use super::table::figure;
use super::{Effort, Error, Findings, Part, Sheet, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::oracle::compare::compare;
use crate::oracle::direct;
use crate::oracle::lockstep::{self, Paired};
use crate::oracle::reference::{self, Rendered};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "hard",
    about: "scenes that are hard for the arithmetic, each with the figures that are expected of it",
    measure,
};

const FOLDER: &str = "scenes/hard";
const SIZE: [u16; 2] = [48, 32];
/// Samples a pixel; `paper` takes a quarter.
const SPP: u64 = 4096;
/// What `precise` must keep to, as a share of a picture's mean: its bias from double precision, and what a furnace may lose or gain.
const BIAS: f64 = 1e-4;
const ENERGY: f64 = 2e-4;
/// Standard errors by which a bound must be passed to be taken for broken: by chance, once in 30,000 times.
const SURE: f64 = 4.0;
/// Pictures in a row of the sheet.
const ROW: usize = 5;

const UNITS: &str = "Radiance is the mean of all pixels and channels; exact where a closed form is known, else the reference's. Off: the picture's \
    difference from it, in per cent, with its standard error. Arithmetic: the bias from the same samples in double precision, likewise. z: the largest \
    of 72 tiles and channels in the independent reference; chance allows 3.81.";
const HEAD: [&str; 7] = [
    "scene",
    "expected radiance",
    "off, %",
    "arithmetic, %",
    "z",
    "`paper` off, %",
    "`paper` arithmetic, %",
];

/// What is expected of a scene, in `expected.json` beside it.
#[derive(Deserialize)]
struct Expected {
    /// Mean radiance: red, green, blue, at 48x32 pixels.
    mean: [f64; 3],
    /// Its standard error, as a share; 0 where a closed form is known.
    standard_error: f64,
}

/// The hard scenes' files, in the order of their names.
pub(super) fn files() -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for entry in fs::read_dir(workspace::file(FOLDER)?)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let spp = effort.of(SPP).next_multiple_of(16) as u32;
    let expected = fs::read_to_string(workspace::file(FOLDER)?.join("expected.json"))?;
    let expected: BTreeMap<String, Expected> = serde_json::from_str(&expected)?;
    let files = files()?;
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    effort.expect(files.len() as u64 * pixels * u64::from(2 * spp + spp / 4));
    let mut table = Table::new(format!("Hard scenes at {spp} samples a pixel"), UNITS, &HEAD);
    let (mut panels, mut faults) = (Vec::new(), Vec::new());
    for file in files {
        let scene = Scene::load(&file)?;
        let expected = expected.get(&scene.name);
        let expected = expected.ok_or_else(|| format!("{}: expected.json says nothing of it", scene.name))?;
        let found = Found::of(effort, &scene, spp)?;
        table.push(found.row(&scene.name, expected)?);
        faults.extend(
            found
                .faults(expected)?
                .into_iter()
                .map(|fault| format!("{}: {fault}", scene.name)),
        );
        panels.push(Panel::picture(scene.name, &found.precise.picture.picture));
    }
    Ok(Findings {
        tables: vec![table],
        sheets: vec![Sheet {
            name: "hard-scenes",
            title: format!("Hard scenes, {spp} samples a pixel, precise"),
            rows: panels.chunks(ROW).map(<[Panel]>::to_vec).collect(),
        }],
        faults,
        ..Findings::default()
    })
}

/// A scene by both profiles.
struct Found {
    precise: Paired,
    paper: Paired,
    rendered: Rendered,
    saturated: u64,
}

/// A share of a mean and its standard error.
struct Share {
    value: f64,
    error: f64,
}

impl Found {
    fn of(effort: &Effort, scene: &Scene, spp: u32) -> Result<Self, Error> {
        let compiled = compile(scene, SIZE[0], SIZE[1]);
        let ours = plan(Arithmetic::Precise, &compiled, SIZE, spp);
        let published = plan(Arithmetic::Paper, &compiled, SIZE, spp / 4);
        Ok(Self {
            precise: lockstep::render::<Precise>(&compiled, &ours, |samples| effort.done(samples)),
            paper: lockstep::render::<Paper>(&compiled, &published, |samples| effort.done(samples)),
            rendered: Self::reference(effort, scene, spp),
            saturated: Self::saturated(&compiled),
        })
    }

    fn reference(effort: &Effort, scene: &Scene, spp: u32) -> Rendered {
        let job = reference::Job {
            width: SIZE[0],
            height: SIZE[1],
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

    /// Sums that packets could not hold, in a picture of 64 samples, as many as a unit has.
    fn saturated(compiled: &CompiledScene) -> u64 {
        let plan = plan(Arithmetic::Precise, compiled, SIZE, 64);
        direct::film::<Precise>(compiled, &plan).saturated()
    }

    fn off(&self, paired: &Paired, expected: &Expected) -> Result<Share, Error> {
        let picture = self.rendered.pooled_noise(paired.picture.clone());
        let noise = compare(&picture, &self.rendered.estimate)?
            .standard_error
            .unwrap_or_default();
        let mean: f64 = picture.picture.mean().ok_or("no picture")?.iter().sum();
        let level: f64 = expected.mean.iter().sum();
        if level == 0.0 {
            return Ok(Share {
                value: mean,
                error: 0.0,
            });
        }
        Ok(Share {
            value: mean / level - 1.0,
            error: noise.hypot(expected.standard_error),
        })
    }

    fn row(&self, name: &str, expected: &Expected) -> Result<Vec<String>, Error> {
        let text = |share: &Share| format!("{:+.4} ± {:.4}", 100.0 * share.value, 100.0 * share.error);
        let level = expected.mean.iter().sum::<f64>() / 3.0;
        Ok(vec![
            format!("`{name}`"),
            format!(
                "{}{}",
                if expected.standard_error == 0.0 {
                    "exactly "
                } else {
                    ""
                },
                figure(level)
            ),
            text(&self.off(&self.precise, expected)?),
            text(&arithmetic(&self.precise)?),
            format!("{:+.2}", self.tiles()?.0),
            text(&self.off(&self.paper, expected)?),
            text(&arithmetic(&self.paper)?),
        ])
    }

    /// The largest z-score, and how many are beyond what chance allows.
    fn tiles(&self) -> Result<(f64, usize), Error> {
        let picture = self.rendered.pooled_noise(self.precise.picture.clone());
        let tiles = compare(&picture, &self.rendered.estimate)?.tiles;
        Ok((tiles.max_z(), tiles.failed().count()))
    }

    /// What `precise` should have kept to.
    fn faults(&self, expected: &Expected) -> Result<Vec<String>, Error> {
        let (off, arithmetic) = (self.off(&self.precise, expected)?, arithmetic(&self.precise)?);
        let is_dark = expected.mean == [0.0; 3];
        let bound = if expected.standard_error == 0.0 {
            ENERGY
        } else {
            BIAS
        };
        let (z, failed) = self.tiles()?;
        let mut faults = Vec::new();
        if is_dark && off.value != 0.0 {
            faults.push(format!("it is not dark, but {} bright", off.value));
        }
        if !is_dark && off.value.abs() > bound + SURE * off.error {
            faults.push(format!(
                "off by {} ± {} of what is expected",
                off.value, off.error
            ));
        }
        if arithmetic.value.abs() > BIAS + SURE * arithmetic.error {
            faults.push(format!("a bias of {} ± {}", arithmetic.value, arithmetic.error));
        }
        if failed > 0 {
            faults.push(format!("{failed} tiles are off, z {z}"));
        }
        if self.saturated > 0 {
            faults.push(format!("{} sums do not fit a packet", self.saturated));
        }
        Ok(faults)
    }
}

/// The bias from double precision.
fn arithmetic(paired: &Paired) -> Result<Share, Error> {
    let (picture, double) = paired.difference();
    let found = compare(&picture, &double)?;
    Ok(Share {
        value: found.bias.unwrap_or_default(),
        error: found.bias_standard_error.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use indicatif::ProgressBar;

    use super::*;

    /// Proof that this part can fail: figures that are not the scene's, and a bright picture of a dark scene.
    #[test]
    fn planted_faults_are_found() {
        let effort = Effort::new(100, ProgressBar::hidden());
        let file = workspace::file(FOLDER).unwrap().join("furnace-diffuse.toml");
        let found = Found::of(&effort, &Scene::load(&file).unwrap(), 16).unwrap();
        let faults = |mean: f64| {
            let expected = Expected {
                mean: [mean; 3],
                standard_error: 0.0,
            };
            found.faults(&expected).unwrap().join("; ")
        };
        assert_eq!(faults(1.0), "");
        assert!(faults(1.005).contains("of what is expected"));
        assert!(faults(0.0).contains("not dark"));
    }

    #[test]
    fn something_is_expected_of_every_scene() {
        let folder = workspace::file(FOLDER).unwrap();
        let expected = fs::read_to_string(folder.join("expected.json")).unwrap();
        let expected: BTreeMap<String, Expected> = serde_json::from_str(&expected).unwrap();
        let names = files()
            .unwrap()
            .into_iter()
            .map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned());
        assert!(names.eq(expected.into_keys()));
    }
}
