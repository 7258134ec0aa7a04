//! The price list: what every arithmetic operation costs on a core, and how wrong it is.
//!
//! [`bench`] runs the images that take prices and transcripts, [`reach`] looks into them for sizes, and [`table`] makes
//! it readable. The operations themselves are listed in the crate `operations`, which the images share.

pub mod bench;
pub mod reach;
pub mod table;

use std::path::Path;

use bench::{BenchError, Measurement};
use operations::{Format, Group, Maker, Operation, Variant, Visitor, transcript};
use serde::Serialize;

use crate::setup::Toolchain;

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
    /// Bytes of tables it reads.
    pub table_bytes: u32,
    /// The hash of what it answers to so many inputs.
    pub transcript: fn(u32) -> u64,
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
            table_bytes: V::TABLE_BYTES,
            transcript: transcript::transcript::<V>,
        });
    }
}

/// A row of the price list, as it is written to files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What is done.
    pub op: &'static str,
    /// By which function.
    pub variant: &'static str,
    /// `ours`, `published`, or the name of a crate.
    pub maker: &'static str,
    /// Instructions on an ARMv5TE core, compiled in line.
    pub instructions: f64,
    /// Instructions as a function that is called.
    pub called_instructions: f64,
    /// Cycles; nobody has counted them yet.
    pub cycles: Option<f64>,
    /// The largest error in ulp.
    pub max_error_ulp: Option<f64>,
    /// The mean error in ulp.
    pub mean_error_ulp: Option<f64>,
    /// What an ulp is.
    pub ulp: String,
    /// The inputs that errors are for.
    pub domain: String,
    /// Bytes of tables it reads.
    pub table_bytes: u32,
    /// Bytes of the function and of all that it calls.
    pub code_bytes: u64,
}

/// The whole list, from images built, run and compared with the host.
pub fn prices(toolchain: &Toolchain, qemu: &Path) -> Result<Vec<Row>, BenchError> {
    let measurements = bench::measure(toolchain, qemu)?;
    Ok(measurements.iter().map(row).collect())
}

fn row(measurement: &Measurement) -> Row {
    let entry = &measurement.entry;
    Row {
        op: entry.operation,
        variant: entry.variant,
        maker: maker_name(entry.maker),
        instructions: measurement.instructions,
        called_instructions: measurement.called_instructions,
        cycles: None,
        max_error_ulp: None,
        mean_error_ulp: None,
        ulp: format!("2^-{}", entry.format.fraction_bits),
        domain: entry.domain.clone(),
        table_bytes: entry.table_bytes,
        code_bytes: measurement.reach.bytes,
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
