//! Cycles a sample that may not rise by accident: a small picture's, by board, profile and way to end a path, kept in
//! `tests/cycles.toml`. The file's history is that of the tracer's speed.

use std::collections::BTreeMap;
use std::io::{self, Write as _};
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::samples::{Kinds, Row, Series};
use crate::firmware::board::Board;
use crate::platform::file::{WriteError, write_whole};
use crate::platform::workspace::{self, NoWorkspace};
use crate::render::options::Size;

/// Where it is kept.
const FILE: &str = "tests/cycles.toml";
/// What it begins with.
const HEAD: &str = "# Cycles a sample of a Cornell box of 16x12 pixels and 16 samples, which a test holds the tracer to. Written by\n\
                    # `cargo xtask bench trace --bless`.\n";
/// The share by which cycles may rise.
const MOST_RISE: f64 = 0.005;

/// The cycles, and the compiler that they are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    /// The compiler's version. Another one schedules otherwise.
    pub compiler: String,
    /// Cycles a sample by board, profile, integrator, sampler and way to end a path.
    pub cycles: BTreeMap<String, f64>,
}

/// Why there is no baseline.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// There is no checkout around here.
    #[error(transparent)]
    NoWorkspace(#[from] NoWorkspace),
    /// It cannot be read.
    #[error("cannot read {} (write it with `cargo xtask bench trace --bless`)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// It is none.
    #[error("{} makes no sense (write it anew with `cargo xtask bench trace --bless`)", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        #[source]
        cause: Box<toml::de::Error>,
    },
    /// Rows without cycles, or of no image.
    #[error("a row has no cycles, or nobody knows the compiler of its image")]
    Incomplete,
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The picture that is measured: small, on one core, so that every run gives the same cycles.
pub fn series() -> Result<Series, NoWorkspace> {
    Ok(Series {
        scene: workspace::file("scenes/cornell.toml")?,
        boards: Board::ALL.to_vec(),
        size: Size {
            width: 16,
            height: 12,
        },
        spp: 16,
        reference_spp: 64,
        noise_spp: 64,
        kinds: Kinds::Few,
        cores: 1,
        soft_float: false,
        no_install: true,
    })
}

impl Baseline {
    /// The baseline that these rows would be.
    pub fn of(rows: &[Row]) -> Result<Self, BaselineError> {
        let compiler = rows.first().and_then(|row| row.compiler.clone());
        let cycles = rows.iter().map(|row| {
            let cycles = row.cycles_per_sample?;
            Some((row.name(), (10.0 * cycles).round() / 10.0))
        });
        let (compiler, cycles) = compiler.zip(cycles.collect()).ok_or(BaselineError::Incomplete)?;
        Ok(Self { compiler, cycles })
    }

    /// Reads it.
    pub fn load() -> Result<Self, BaselineError> {
        let path = workspace::file(FILE)?;
        let text = std::fs::read_to_string(&path).map_err(|cause| BaselineError::Read {
            path: path.clone(),
            cause,
        })?;
        toml::from_str(&text).map_err(|cause| BaselineError::Damaged {
            path,
            cause: Box::new(cause),
        })
    }

    /// Writes it.
    pub fn store(&self) -> Result<(), BaselineError> {
        let path = workspace::file(FILE)?;
        Ok(write_whole(&path, |writer| {
            let text = toml::to_string(self).map_err(io::Error::other)?;
            writer.write_all(format!("{HEAD}{text}").as_bytes())
        })?)
    }

    /// What of `now` is worse than this, in words; nothing where another compiler made the images.
    pub fn risen(&self, now: &Self) -> Vec<String> {
        if now.compiler != self.compiler {
            return Vec::new();
        }
        let names = self
            .cycles
            .keys()
            .chain(now.cycles.keys().filter(|&name| !self.cycles.contains_key(name)));
        let judge = |name: &String| match (self.cycles.get(name), now.cycles.get(name)) {
            (Some(&old), Some(&new)) if new <= old * (1.0 + MOST_RISE) => None,
            (Some(&old), Some(&new)) => Some(format!(
                "{name}: {new:.1} cycles a sample instead of {old:.1}, {:+.2} %",
                100.0 * (new / old - 1.0)
            )),
            (Some(_), None) => Some(format!("{name}: it is in {FILE}, and was not measured")),
            (None, _) => Some(format!("{name}: it was measured, and is not in {FILE}")),
        };
        names.filter_map(judge).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn baseline(compiler: &str, cycles: &[(&str, f64)]) -> Baseline {
        Baseline {
            compiler: compiler.to_owned(),
            cycles: cycles
                .iter()
                .map(|&(name, cycles)| (name.to_owned(), cycles))
                .collect(),
        }
    }

    #[test]
    fn a_rise_is_told_with_old_and_new_and_a_fall_is_none() {
        let old = baseline("1.95.0", &[("a", 1000.0), ("b", 1000.0), ("c", 1000.0)]);
        assert!(old.risen(&old).is_empty());
        let now = baseline("1.95.0", &[("a", 1004.9), ("b", 900.0), ("c", 1005.1)]);
        assert_eq!(
            old.risen(&now),
            ["c: 1005.1 cycles a sample instead of 1000.0, +0.51 %"]
        );
    }

    #[test]
    fn rows_that_come_or_go_are_told_and_another_compiler_is_another_measure() {
        let old = baseline("1.95.0", &[("a", 1000.0)]);
        let told = old.risen(&baseline("1.95.0", &[("b", 1000.0)]));
        assert!(
            told.len() == 2 && told[0].starts_with("a:") && told[1].starts_with("b:"),
            "{told:?}"
        );
        assert!(old.risen(&baseline("1.96.0", &[("a", 2000.0)])).is_empty());
    }
}
