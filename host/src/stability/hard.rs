//! Scenes that are hard for the arithmetic, each with the figures that are expected of it.

use std::collections::BTreeMap;
use std::fs;

use serde::Deserialize;
use tracer::profile::{Paper, Precise};

use super::part::{HARD_SCENES, SURE, plan, reference, scene_files};
use super::sheet::Panel;
use super::table::figure;
use super::{Effort, Error, Findings, Part, Sheet, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::image::picture::Picture;
use crate::oracle::compare::{Tiles, compare, sidak_threshold};
use crate::oracle::direct;
use crate::oracle::lockstep::{self, Paired};
use crate::oracle::reference::Rendered;
use crate::platform::workspace;
use crate::scene::{Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "hard",
    about: "scenes that are hard for the arithmetic, each with the figures that are expected of it",
    measure,
};

const SIZE: [u16; 2] = [48, 32];
/// Samples a pixel; `paper` takes a quarter.
const SPP: u64 = 4096;
/// What the reference knows of the noise of rare, bright paths it has of as many samples as this at least.
const LEAST_REFERENCE: u32 = 64;
/// What `precise` must keep to, as a share of a picture's mean: its bias from double precision, and what a furnace may lose or gain.
const BIAS: f64 = 1e-4;
const ENERGY: f64 = 2e-4;
/// The radiance that pictures of the sheet are exposed for: its square root is a display's middle.
const GREY: f64 = 0.25;
/// Pictures in a row of the sheet.
const ROW: usize = 5;

const UNITS: &str = "Radiance is the mean of all pixels and channels; exact where a closed form is known, else the reference's. Off: the picture's \
    difference from it, in per cent, with its standard error. Arithmetic: the bias from the same samples in double precision, likewise. z: the largest \
    of 72 tiles and channels in the independent reference.";
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

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let spp = effort.of(SPP).next_multiple_of(16) as u32;
    let expected = fs::read_to_string(workspace::file(HARD_SCENES)?.join("expected.json"))?;
    let expected: BTreeMap<String, Expected> = serde_json::from_str(&expected)?;
    let files = scene_files(&[HARD_SCENES])?;
    let scenes = files.len();
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    effort.expect(scenes as u64 * pixels * u64::from(2 * spp + spp / 4));
    let mut table = Table::new(format!("Hard scenes at {spp} samples a pixel"), UNITS, &HEAD);
    let (mut panels, mut faults) = (Vec::new(), Vec::new());
    for file in files {
        let scene = Scene::load(&file)?;
        let expected = expected.get(&scene.name);
        let expected = expected.ok_or_else(|| format!("{}: expected.json says nothing of it", scene.name))?;
        let found = Found::of(effort, &scene, spp)?;
        table.push(found.row(&scene.name, expected));
        let faults_of_it = found.faults(expected, scenes).into_iter();
        faults.extend(faults_of_it.map(|fault| format!("{}: {fault}", scene.name)));
        panels.push(found.precise.panel(&scene.name));
    }
    Ok(Findings {
        tables: vec![table],
        sheets: vec![Sheet {
            name: "hard-scenes",
            title: format!(
                "Hard scenes, {spp} samples a pixel, precise, by exposures that make most of them grey"
            ),
            rows: panels.chunks(ROW).map(<[Panel]>::to_vec).collect(),
        }],
        faults,
        ..Findings::default()
    })
}

/// A scene by both profiles.
struct Found {
    precise: Rendering,
    paper: Rendering,
    /// Sums that packets could not hold, in a picture of 64 samples, as many as a unit has.
    saturated: u64,
}

/// A scene by one profile.
struct Rendering {
    picture: Picture,
    /// Mean of all pixels and channels.
    radiance: f64,
    /// Its standard error, as a share of the reference.
    noise: f64,
    /// The bias from the same samples in double precision.
    arithmetic: Share,
    /// Tile by tile in the independent reference.
    tiles: Tiles,
}

/// A share of a mean, and its standard error.
struct Share {
    value: f64,
    error: f64,
}

impl Found {
    fn of(effort: &Effort, scene: &Scene, spp: u32) -> Result<Self, Error> {
        let compiled = compile(scene, SIZE[0], SIZE[1], Integrator::Path);
        let plan = |arithmetic, spp| plan(arithmetic, &compiled, SIZE, spp);
        let done = |samples| effort.done(samples);
        let precise = lockstep::render::<Precise>(&compiled, &plan(Arithmetic::Precise, spp), done);
        let paper = lockstep::render::<Paper>(&compiled, &plan(Arithmetic::Paper, spp / 4), done);
        let rendered = reference(effort, scene, SIZE, spp.max(LEAST_REFERENCE));
        let film = direct::film::<Precise>(&compiled, &plan(Arithmetic::Precise, 64));
        Ok(Self {
            precise: Rendering::of(&precise, &rendered)?,
            paper: Rendering::of(&paper, &rendered)?,
            saturated: film.saturated(),
        })
    }

    fn row(&self, name: &str, expected: &Expected) -> Vec<String> {
        let is_exact = if expected.standard_error == 0.0 {
            "exactly "
        } else {
            ""
        };
        vec![
            format!("`{name}`"),
            format!("{is_exact}{}", figure(expected.radiance())),
            self.precise.off_by(expected),
            self.precise.arithmetic.per_cent(),
            format!("{:+.2}", self.precise.tiles.max_z()),
            self.paper.off_by(expected),
            self.paper.arithmetic.per_cent(),
        ]
    }

    /// What `precise` should have kept to, as one of so many scenes: in one run over all of a hundred at most, chance alone makes a tile a fault.
    fn faults(&self, expected: &Expected, scenes: usize) -> Vec<String> {
        let Rendering {
            arithmetic, tiles, ..
        } = &self.precise;
        let mut faults = Vec::new();
        match self.precise.off(expected) {
            None if self.precise.radiance != 0.0 => {
                faults.push(format!("it is not dark: radiance {}", self.precise.radiance));
            }
            Some(off) if off.value.abs() > expected.bound() + SURE * off.error => {
                faults.push(format!("off by {} of what is expected", off.per_cent()));
            }
            _ => {}
        }
        if arithmetic.value.abs() > BIAS + SURE * arithmetic.error {
            faults.push(format!("a bias of {}", arithmetic.per_cent()));
        }
        let bound = sidak_threshold(scenes * tiles.tested());
        if tiles.max_z().abs() > bound {
            faults.push(format!(
                "a tile is off by a z of {}, chance allows {bound:.2}",
                tiles.max_z()
            ));
        }
        if self.saturated > 0 {
            faults.push(format!("{} sums do not fit a packet", self.saturated));
        }
        faults
    }
}

impl Rendering {
    fn of(paired: &Paired, rendered: &Rendered) -> Result<Self, Error> {
        let found = compare(
            &rendered.pooled_noise(paired.picture.clone(), Integrator::Path),
            &rendered.estimate,
        )?;
        let (picture, double) = paired.difference();
        let arithmetic = compare(&picture, &double)?;
        Ok(Self {
            picture: picture.picture,
            radiance: found.mean.iter().sum::<f64>() / 3.0,
            noise: found.standard_error.unwrap_or_default(),
            arithmetic: Share {
                value: arithmetic.bias.unwrap_or_default(),
                error: arithmetic.bias_standard_error.unwrap_or_default(),
            },
            tiles: found.tiles,
        })
    }

    /// The picture by the exposure, in whole stops, that brings its mean next to a middle grey.
    fn panel(&self, name: &str) -> Panel {
        let stops = if self.radiance > 0.0 {
            (GREY / self.radiance).log2().round() as i32
        } else {
            0
        };
        let exposure = if stops == 0 {
            String::new()
        } else {
            format!(", {stops:+} stops")
        };
        Panel::picture(format!("{name}{exposure}"), &self.picture.exposed(stops))
    }

    /// How far it is from what is expected; none where that is dark.
    fn off(&self, expected: &Expected) -> Option<Share> {
        let level = expected.radiance();
        (level > 0.0).then(|| Share {
            value: self.radiance / level - 1.0,
            error: self.noise.hypot(expected.standard_error),
        })
    }

    /// The same to read; the radiance itself where it should be dark.
    fn off_by(&self, expected: &Expected) -> String {
        self.off(expected).map_or_else(
            || format!("radiance {}", figure(self.radiance)),
            |off| off.per_cent(),
        )
    }
}

impl Share {
    fn per_cent(&self) -> String {
        format!("{} ± {}", figure(100.0 * self.value), figure(100.0 * self.error))
    }
}

impl Expected {
    /// Mean of the channels.
    fn radiance(&self) -> f64 {
        self.mean.iter().sum::<f64>() / 3.0
    }

    /// What a picture may be off by: closed forms are of furnaces.
    fn bound(&self) -> f64 {
        if self.standard_error == 0.0 { ENERGY } else { BIAS }
    }
}

#[cfg(test)]
mod tests {
    use indicatif::ProgressBar;

    use super::*;

    /// Proof that this part can fail: figures that are not the scene's, a bright picture of a dark scene, and a tile beyond what chance allows.
    #[test]
    fn planted_faults_are_found() {
        let effort = Effort::new(100, ProgressBar::hidden());
        let file = workspace::file(HARD_SCENES).unwrap().join("furnace-diffuse.toml");
        let mut found = Found::of(&effort, &Scene::load(&file).unwrap(), 16).unwrap();
        let faults = |found: &Found, mean: f64, scenes| {
            let expected = Expected {
                mean: [mean; 3],
                standard_error: 0.0,
            };
            found.faults(&expected, scenes).join("; ")
        };
        assert_eq!(faults(&found, 1.0, 1), "");
        assert!(faults(&found, 1.005, 1).contains("of what is expected"));
        assert!(faults(&found, 0.0, 1).contains("not dark"));
        // Of a tile and channel in one picture chance allows 3.81, in 22 of them 4.51.
        found.precise.tiles.tiles[7].z[1] = -4.2;
        assert!(faults(&found, 1.0, 1).contains("a tile is off by a z of -4.2"));
        assert_eq!(faults(&found, 1.0, 22), "");
        found.precise.tiles.tiles[7].z[1] = 4.6;
        assert!(faults(&found, 1.0, 22).contains("a tile is off by a z of 4.6"));
    }

    #[test]
    fn something_is_expected_of_every_scene() {
        let folder = workspace::file(HARD_SCENES).unwrap();
        let expected = fs::read_to_string(folder.join("expected.json")).unwrap();
        let expected: BTreeMap<String, Expected> = serde_json::from_str(&expected).unwrap();
        let names = scene_files(&[HARD_SCENES])
            .unwrap()
            .into_iter()
            .map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned());
        assert!(names.eq(expected.into_keys()));
    }
}
