//! The price list: what every arithmetic operation costs on a core, and how wrong it is.
//!
//! [`mod@bench`] runs the images that take prices and transcripts, and [`reach`] looks into them for sizes. [`verify`](mod@verify)
//! compares with the [`truth`], and [`record`] keeps what it found over every input. [`table`] and [`plot`] make it all
//! readable, beside quoted figures ([`anchors`]);
//! [`readme`] puts that where users of the arithmetic look.
//! The operations themselves are listed in the crate `operations`, which the images share.

pub mod anchors;
pub mod bench;
pub mod plot;
pub mod reach;
pub mod readme;
pub mod record;
pub mod table;
pub mod truth;
pub mod verify;

use std::path::Path;

use bench::{BenchError, Measurement};
use record::{Proof, Record, RecordError};
use verify::{Depth, verify};

use operations::intersection::PRICED;
use operations::{Format, Group, Maker, Operation, Variant, Visitor, transcript};
use serde::Serialize;

use crate::firmware::board::Board;
use crate::platform::setup::Toolchain;

/// A row as the list has it, before anything is measured.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The group whose image holds it.
    pub group: Group,
    /// What is done.
    pub operation: &'static str,
    /// By which function.
    pub variant: &'static str,
    /// Whose it is.
    pub maker: Maker,
    /// The output's format, which errors are counted in.
    pub format: Format,
    /// The inputs that errors are for.
    pub domain: String,
    /// The hash of what it answers to so many inputs.
    pub transcript: fn(u32) -> u64,
    /// The error in ulp for the input of these words, if that is in the domain.
    pub error_at: fn(&[u32]) -> Option<f64>,
    /// Whether its inputs are so few that each can be tried.
    pub can_be_exhausted: bool,
}

impl Entry {
    /// What files and drawings call it: where the function is another crate's, with that crate, for `sqrt` has many makers.
    pub fn name(&self) -> String {
        match self.maker {
            Maker::Ours | Maker::Published => self.variant.to_owned(),
            Maker::Rival(maker) => format!("{maker} {}", self.variant),
        }
    }
}

/// What each formula that meets a sphere costs on a core, of rays that meet it, in lines of Markdown.
pub fn intersections(toolchain: &Toolchain, qemu: &Path, board: Board) -> Result<String, BenchError> {
    let prices = bench::intersections(toolchain, qemu, board)?;
    let mut lines = vec![
        "| formula | instructions | cycles |".to_owned(),
        "| ------- | ------------:| ------:|".to_owned(),
    ];
    lines.extend(
        PRICED
            .iter()
            .zip(prices)
            .map(|(name, [instructions, cycles])| format!("| {name} | {instructions:.1} | {cycles:.1} |")),
    );
    Ok(lines.join("\n"))
}

/// The rows of a group, in the order in which its image prints them.
pub fn entries(group: Group) -> Vec<Entry> {
    let mut list = List {
        group,
        entries: Vec::new(),
    };
    group.show(&mut list);
    list.entries
}

struct List {
    group: Group,
    entries: Vec<Entry>,
}

impl Visitor for List {
    fn visit<V: Variant>(&mut self) {
        let fitting = if V::SATURATES { "" } else { "; results that fit" };
        self.entries.push(Entry {
            group: self.group,
            operation: V::Operation::NAME,
            variant: V::NAME,
            maker: V::MAKER,
            format: V::Operation::FORMAT,
            domain: format!("{}{fitting}", V::DOMAIN),
            transcript: transcript::transcript::<V>,
            error_at: verify::error_at::<V>,
            can_be_exhausted: verify::can_be_exhausted::<V>(),
        });
    }
}

/// A row of the price list, as it is written to files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What is done.
    pub op: &'static str,
    /// By which function, for lists with its maker beside it.
    #[serde(skip)]
    pub variant: &'static str,
    /// The same as [`Entry::name`] has it.
    #[serde(rename = "variant")]
    pub name: String,
    /// `ours`, `published`, or the name of a crate.
    pub maker: &'static str,
    /// The board whose core they are of.
    pub board: Board,
    /// Instructions on that core, compiled in line.
    pub instructions: f64,
    /// Instructions as a function that is called.
    pub called_instructions: f64,
    /// Cycles of the board's processor, compiled in line.
    pub cycles: f64,
    /// Between what bounds they are, by what the processor's model does not see.
    pub cycles_within: [f64; 2],
    /// Cycles as a function that is called.
    pub called_cycles: f64,
    /// The largest error in ulp.
    pub max_error_ulp: Option<f64>,
    /// The mean error in ulp.
    pub mean_error_ulp: Option<f64>,
    /// What an ulp is.
    pub ulp: String,
    /// The inputs that errors are for.
    pub domain: String,
    /// `exhaustive` where every input was tried, else `sampled`.
    pub verified: &'static str,
    /// Bytes of tables it reads. For other crates' functions that is not known: their tables may have no name in the image.
    pub table_bytes: Option<u64>,
    /// Bytes of the function and of all that it calls.
    pub code_bytes: u64,
    /// The words of an input with the largest error.
    pub worst_input: Vec<String>,
    /// The version of the compiler that the costs are of.
    pub compiler: String,
}

/// Why there is no price list.
#[derive(Debug, thiserror::Error)]
pub enum PriceError {
    /// There are no prices.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// There is no record of errors.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The record is about these sources, but not about what they do.
    #[error(
        "{operation}, {variant}: the input recorded as the worst does not have the recorded error; find out why, then \
         write the record anew with `cargo xtask verify --exhaustive --bless`"
    )]
    Stale {
        /// What is done.
        operation: &'static str,
        /// By which function.
        variant: String,
    },
}

/// The whole list, from images built, run and compared with the host. Errors are the recorded ones while the record is about
/// the sources as they are, and those of a sample for every other row.
pub fn prices(toolchain: &Toolchain, qemu: &Path, board: Board) -> Result<Vec<Row>, PriceError> {
    with_errors(&bench::measure(toolchain, qemu, board, &Group::ALL)?)
}

/// The list from prices that have been taken.
pub fn with_errors(measurements: &[Measurement]) -> Result<Vec<Row>, PriceError> {
    let record = Record::load(&Record::path().map_err(RecordError::from)?)?;
    let record = if record.is_current()? {
        record
    } else {
        Record::default()
    };
    let sample = verify(Depth::Sampled, &|entry| record.find(entry).is_none(), &());
    let sample = Record::of(&sample)?;
    measurements
        .iter()
        .map(|measurement| {
            let entry = &measurement.entry;
            let recorded = record.find(entry);
            if recorded.is_some_and(|proof| !proof.holds(entry)) {
                return Err(PriceError::Stale {
                    operation: entry.operation,
                    variant: entry.name(),
                });
            }
            let is_proof = recorded.is_some() && entry.can_be_exhausted;
            Ok(row(
                measurement,
                recorded.or_else(|| sample.find(entry)),
                is_proof,
            ))
        })
        .collect()
}

fn row(measurement: &Measurement, errors: Option<&Proof>, is_proof: bool) -> Row {
    let entry = &measurement.entry;
    Row {
        op: entry.operation,
        variant: entry.variant,
        name: entry.name(),
        maker: maker_name(entry.maker),
        board: measurement.board,
        instructions: measurement.instructions,
        called_instructions: measurement.called_instructions,
        cycles: measurement.cycles,
        cycles_within: measurement.cycles_within,
        called_cycles: measurement.called_cycles,
        max_error_ulp: errors.map(|errors| errors.max_error_ulp),
        mean_error_ulp: errors.map(|errors| errors.mean_error_ulp),
        ulp: format!("2^-{}", entry.format.fraction_bits),
        domain: entry.domain.clone(),
        verified: if is_proof { "exhaustive" } else { "sampled" },
        table_bytes: (!matches!(entry.maker, Maker::Rival(_)))
            .then(|| measurement.reach.tables.values().sum()),
        code_bytes: measurement.reach.bytes,
        worst_input: errors
            .map(|errors| errors.worst_input.clone())
            .unwrap_or_default(),
        compiler: measurement.compiler.clone(),
    }
}

/// The maker's name in files.
pub fn maker_name(maker: Maker) -> &'static str {
    match maker {
        Maker::Ours => "ours",
        Maker::Published => "published",
        Maker::Rival(name) => name,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn every_row_of_an_operation_has_a_name_of_its_own_and_says_whose_it_is() {
        let mut names = BTreeSet::new();
        for entry in Group::ALL.into_iter().flat_map(entries) {
            let name = entry.name();
            if let Maker::Rival(maker) = entry.maker {
                assert!(name.starts_with(maker) && name != maker, "{name}");
            }
            let operation = entry.operation;
            let json = serde_json::to_value(row(&measured(entry), None, false)).expect("it is plain data");
            assert_eq!(json["variant"], name);
            assert!(
                names.insert((operation, name.clone())),
                "two rows of {operation} are called {name}"
            );
        }
    }

    fn measured(entry: Entry) -> Measurement {
        Measurement {
            entry,
            board: Board::default(),
            instructions: 1.0,
            called_instructions: 1.0,
            cycles: 1.0,
            cycles_within: [1.0; 2],
            called_cycles: 1.0,
            reach: reach::Reach {
                bytes: 4,
                symbols: Vec::new(),
                tables: BTreeMap::new(),
            },
            elf: PathBuf::new(),
            compiler: String::new(),
        }
    }
}
