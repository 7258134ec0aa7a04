//! The record of the exhaustive run, kept beside the arithmetic: `fixedmath/proof.json`.
//!
//! It holds the worst error found for each of our rows and of the published ones, with the input that has it, and a hash of
//! the sources that it is about. While the hash holds, the price list quotes it; a later exhaustive run must find the same.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::verify::{Figures, Verdict};
use super::{Entry, maker_name};
use crate::platform::file::{WriteError, write_whole};
use crate::platform::workspace::{self, NoWorkspace};

/// The truth is a double's worth: figures that differ by less than this share are the same.
const PRECISION: f64 = 1e-6;

/// The record.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Record {
    /// SHA-256 of the sources, without comments and blank lines.
    pub sources_sha256: String,
    /// What was found.
    pub rows: Vec<Proof>,
}

/// What was found about a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proof {
    /// What is done.
    pub op: String,
    /// By which function.
    pub variant: String,
    /// Whose it is.
    pub maker: String,
    /// `exhaustive` where every input was tried, else `sampled`.
    pub verified: String,
    /// Inputs tried.
    pub cases: u64,
    /// The largest error in ulp.
    pub max_error_ulp: f64,
    /// The mean error in ulp.
    pub mean_error_ulp: f64,
    /// The words of an input with the largest error.
    pub worst_input: Vec<String>,
}

/// Why there is no record to compare with.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// There is nothing around here to have a record of.
    #[error(transparent)]
    NoWorkspace(#[from] NoWorkspace),
    /// A file cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// The record is no record.
    #[error("{} makes no sense (write it anew with `cargo xtask verify --exhaustive --bless`)", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        #[source]
        cause: serde_json::Error,
    },
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Record {
    /// Where it is kept.
    pub fn path() -> Result<PathBuf, NoWorkspace> {
        workspace::file("fixedmath/proof.json")
    }

    /// Reads it. Where there is no file yet, nothing is recorded, and nothing is current.
    pub fn load(path: &Path) -> Result<Self, RecordError> {
        let text = match fs::read(path) {
            Ok(text) => text,
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(cause) => {
                return Err(RecordError::Read {
                    path: path.to_owned(),
                    cause,
                });
            }
        };
        serde_json::from_slice(&text).map_err(|cause| RecordError::Damaged {
            path: path.to_owned(),
            cause,
        })
    }

    /// Writes it.
    pub fn store(&self, path: &Path) -> Result<(), RecordError> {
        write_whole(path, |writer| {
            serde_json::to_writer_pretty(&mut *writer, self)?;
            io::Write::write_all(writer, b"\n").map_err(serde_json::Error::io)
        })?;
        Ok(())
    }

    /// The record of what has just been found, about the sources as they are.
    pub fn of(verdicts: &[Verdict]) -> Result<Self, RecordError> {
        let proofs = verdicts.iter().filter_map(|verdict| {
            let figures = verdict.figures.as_ref()?;
            Some(Proof::of(&verdict.entry, figures))
        });
        let mut rows: Vec<Proof> = proofs.collect();
        rows.sort_by(|a, b| a.key().cmp(&b.key()));
        Ok(Self {
            sources_sha256: sources_sha256()?,
            rows,
        })
    }

    /// With what has just been found in place of what it says of the same rows; of all rows, if it is about other sources.
    pub fn updated(self, verdicts: &[Verdict]) -> Result<Self, RecordError> {
        let is_current = self.is_current()?;
        let mut record = Self::of(verdicts)?;
        let is_new = |old: &Proof| !verdicts.iter().any(|verdict| old.is_about(&verdict.entry));
        if is_current {
            record.rows.extend(self.rows.into_iter().filter(is_new));
            record.rows.sort_by(|a, b| a.key().cmp(&b.key()));
        }
        Ok(record)
    }

    /// Whether it is about the sources as they are.
    pub fn is_current(&self) -> Result<bool, RecordError> {
        Ok(self.sources_sha256 == sources_sha256()?)
    }

    /// What it says of a row.
    pub fn find(&self, entry: &Entry) -> Option<&Proof> {
        self.rows.iter().find(|proof| proof.is_about(entry))
    }

    /// Where an exhaustive run differs from it, in words.
    pub fn differences(&self, verdicts: &[Verdict]) -> Vec<String> {
        let mut differences = Vec::new();
        for Verdict { entry, figures } in verdicts {
            let (op, variant) = (entry.operation, entry.variant);
            match (self.find(entry), figures) {
                (Some(proof), Some(figures)) if is_same(proof.max_error_ulp, figures.max_error) => {}
                (None, None) => {}
                (Some(proof), Some(figures)) => differences.push(format!(
                    "{op}, {variant}: the worst error is {} ulp (input {}), the record says {}",
                    figures.max_error,
                    hexadecimal(&figures.worst_input).join(" "),
                    proof.max_error_ulp
                )),
                (Some(_), None) => differences.push(format!("{op}, {variant}: recorded, but has no error")),
                (None, Some(_)) => differences.push(format!("{op}, {variant}: not in the record")),
            }
        }
        differences
    }

    /// Where a sample is worse than what it says to be the worst, in words. The sample is a part of the exhaustive run.
    pub fn exceeded(&self, verdicts: &[Verdict]) -> Vec<String> {
        let worse = verdicts.iter().filter_map(|Verdict { entry, figures }| {
            let (proof, figures) = (self.find(entry)?, figures.as_ref()?);
            let exceeded =
                figures.max_error > proof.max_error_ulp && !is_same(proof.max_error_ulp, figures.max_error);
            exceeded.then(|| {
                format!(
                    "{}, {}: an error of {} ulp (input {}), where the record has none above {}",
                    entry.operation,
                    entry.variant,
                    figures.max_error,
                    hexadecimal(&figures.worst_input).join(" "),
                    proof.max_error_ulp
                )
            })
        });
        worse.collect()
    }
}

impl Proof {
    fn of(entry: &Entry, figures: &Figures) -> Self {
        let verified = if entry.can_be_exhausted {
            "exhaustive"
        } else {
            "sampled"
        };
        Self {
            op: entry.operation.to_owned(),
            variant: entry.variant.to_owned(),
            maker: maker_name(entry.maker).to_owned(),
            verified: verified.to_owned(),
            cases: figures.cases,
            max_error_ulp: figures.max_error,
            mean_error_ulp: figures.mean_error,
            worst_input: hexadecimal(&figures.worst_input),
        }
    }

    fn is_about(&self, entry: &Entry) -> bool {
        self.key() == (entry.operation, maker_name(entry.maker), entry.variant)
    }

    /// What tells it from the others.
    fn key(&self) -> (&str, &str, &str) {
        (&self.op, &self.maker, &self.variant)
    }

    /// Whether the recorded input has the recorded error now.
    pub fn holds(&self, entry: &Entry) -> bool {
        let words: Option<Vec<u32>> = self.worst_input.iter().map(|word| word_of(word)).collect();
        let error = words.and_then(|words| (entry.error_at)(&words));
        error.is_some_and(|error| is_same(error, self.max_error_ulp))
    }
}

/// Words as they are written to files.
pub fn hexadecimal(words: &[u32]) -> Vec<String> {
    words.iter().map(|word| format!("{word:#010x}")).collect()
}

fn word_of(text: &str) -> Option<u32> {
    u32::from_str_radix(text.strip_prefix("0x")?, 16).ok()
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= PRECISION * a.abs().max(b.abs())
}

/// The hash of fixedmath's sources. Lines that hold only a comment, or nothing, do not count.
pub fn sources_sha256() -> Result<String, RecordError> {
    let mut files = Vec::new();
    collect(&workspace::file("fixedmath/src")?, &mut files)?;
    files.sort();
    let mut hash = Sha256::new();
    for file in files {
        let text = fs::read_to_string(&file).map_err(|cause| RecordError::Read { path: file, cause })?;
        for line in code_of(&text) {
            hash.update(line);
            hash.update("\n");
        }
    }
    let digest = hash.finalize();
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), RecordError> {
    let failed = |cause| RecordError::Read {
        path: folder.to_owned(),
        cause,
    };
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

/// The lines that mean something to the compiler.
fn code_of(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::operations::verify::{Depth, verify};

    #[test]
    fn comments_and_blank_lines_do_not_count() {
        let text = "//! A room.\n\n/// Adds.\nfn add() {\n    // Nothing yet.\n}\n";
        assert_eq!(code_of(text).collect::<Vec<_>>(), ["fn add() {", "}"]);
    }

    /// A run is compared with its own record, and with one that says something else.
    #[test]
    fn a_record_tells_a_worse_error_and_an_input_that_does_not_have_it() {
        let verdicts = verify(Depth::Sampled, &|entry| entry.operation == "divide", &());
        let mut record = Record::of(&verdicts).expect("the sources can be read");
        assert!(record.is_current().expect("the sources can be read"));
        assert!(record.differences(&verdicts).is_empty() && record.exceeded(&verdicts).is_empty());
        for verdict in &verdicts {
            assert!(
                record
                    .find(&verdict.entry)
                    .is_none_or(|proof| proof.holds(&verdict.entry))
            );
        }
        for proof in &mut record.rows {
            proof.max_error_ulp *= 0.99;
        }
        assert_eq!(record.differences(&verdicts).len(), verdicts.len());
        assert_eq!(record.exceeded(&verdicts).len(), verdicts.len());
        assert!(!record.rows[0].holds(&verdicts[0].entry));
    }
}
