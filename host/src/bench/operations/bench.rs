//! Prices and transcripts, taken on an emulated core.

use std::path::{Path, PathBuf};
use std::{fs, io};

use cycles::file::{self, FileError};
use cycles::{Cycles, cycles};
use operations::Group;
use operations::intersection::PRICED;
use operations::price::{CASES, ROUNDS};
use rayon::prelude::*;

use super::reach::{Code, Reach};
use super::{Entry, entries};
use crate::firmware::board::{Board, INSTRUCTIONS_PER_TICK};
use crate::firmware::plugin::{self, PluginError, Recorder};
use crate::firmware::symbols::functions;
use crate::firmware::{self, ElfError, FirmwareError};
use crate::fleet;
use crate::platform::setup::Toolchain;

/// A row as a core has measured it.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The row.
    pub entry: Entry,
    /// The board.
    pub board: Board,
    /// Instructions in line.
    pub instructions: f64,
    /// Instructions as a called function.
    pub called_instructions: f64,
    /// Cycles in line.
    pub cycles: f64,
    /// Between what bounds they are, by what the processor's model does not see.
    pub cycles_within: [f64; 2],
    /// Cycles as a called function.
    pub called_cycles: f64,
    /// The called function.
    pub reach: Reach,
    /// The image.
    pub elf: PathBuf,
    /// The version of the compiler that made it.
    pub compiler: String,
}

/// Why there are no prices.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// There is no image.
    #[error(transparent)]
    Firmware(#[from] FirmwareError),
    /// The emulator could not be started.
    #[error("cannot start {}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// There is nothing to count cycles with.
    #[error(transparent)]
    Plugin(#[from] PluginError),
    /// There is no folder for what is recorded.
    #[error("cannot make a folder for temporary files (set TMPDIR to one with room)")]
    Folder(#[source] io::Error),
    /// An image does not show where its loops are.
    #[error(transparent)]
    Image(#[from] ElfError),
    /// What was recorded cannot be read.
    #[error(transparent)]
    Recording(#[from] FileError),
    /// What was recorded are not the loops.
    #[error(
        "{image}: {found} loops were recorded where {rows} rows have {LOOPS} each, or an exception came between; run it again"
    )]
    Loops {
        /// The image.
        image: String,
        /// Loops recorded.
        found: usize,
        /// Rows printed.
        rows: usize,
    },
    /// The core did not do its work.
    #[error("{image}: the core ended with {status}, and said:\n{said}")]
    Core {
        /// The image.
        image: String,
        /// How QEMU ended.
        status: String,
        /// The console.
        said: String,
    },
    /// The image's file cannot be read as one.
    #[error("{}: {cause}; remove the file, and it is built anew", path.display())]
    Elf {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// Core and host differ.
    #[error(
        "{operation}, {variant}: the core's answers are not the host's (transcripts {core:016x} and {host:016x} of \
         {cases} cases); one of the two compilers, or the emulator, computes something else"
    )]
    Transcript {
        /// What is done.
        operation: &'static str,
        /// By which function.
        variant: String,
        /// The core's hash.
        core: u64,
        /// The host's hash.
        host: u64,
        /// Cases in it.
        cases: u32,
    },
}

/// The function that every loop runs in.
const LOOP: &str = "operations::price::timed";
/// The loops of a row: without the operation, with it in line, and with a call of it.
const LOOPS: usize = 3;

/// Builds and runs a board's images of these groups, and compares every transcript with the host's.
pub fn measure(
    toolchain: &Toolchain,
    qemu: &Path,
    board: Board,
    groups: &[Group],
) -> Result<Vec<Measurement>, BenchError> {
    let names: Vec<String> = groups.iter().map(|&group| image_name(group)).collect();
    let images = firmware::build_examples(toolchain, board, &names, None)?;
    let plugin = plugin::ready(qemu)?;
    let pairs: Vec<(Group, PathBuf)> = groups.iter().copied().zip(images).collect();
    let groups: Vec<Vec<Measurement>> = pairs
        .into_par_iter()
        .map(|(group, elf)| measure_group(qemu, &plugin, board, group, &elf))
        .collect::<Result<_, _>>()?;
    Ok(groups.concat())
}

/// The name of a group's image.
pub fn image_name(group: Group) -> String {
    format!("prices_{}", group.name())
}

/// What formulas that meet a sphere cost, in the order of [`PRICED`]: instructions and cycles in line.
pub fn intersections(toolchain: &Toolchain, qemu: &Path, board: Board) -> Result<Vec<[f64; 2]>, BenchError> {
    const IMAGE: &str = "prices_intersection";
    let images = firmware::build_examples(toolchain, board, &[IMAGE.to_owned()], None)?;
    let plugin = plugin::ready(qemu)?;
    let mut prices = Vec::new();
    for elf in &images {
        let (lines, loops) = record(qemu, &plugin, board, IMAGE, elf, PRICED.len())?;
        prices.extend(
            lines
                .iter()
                .zip(loops)
                .map(|(line, [baseline, inline, _called])| {
                    [line.instructions(line.inline), differences(baseline, inline)[1]]
                }),
        );
    }
    Ok(prices)
}

/// Runs an image, and gives what it said of its rows and their loops.
fn record(
    qemu: &Path,
    plugin: &Path,
    board: Board,
    image: &str,
    elf: &Path,
    rows: usize,
) -> Result<(Vec<Line>, Vec<[Cycles; LOOPS]>), BenchError> {
    let folder = tempfile::tempdir().map_err(BenchError::Folder)?;
    let recorder = Recorder {
        plugin: plugin.to_owned(),
        entries: functions(elf, LOOP)?,
        each: true,
        file: folder.path().join("flow"),
    };
    let output = fleet::run_recorded(qemu, board, elf, &recorder).map_err(|cause| BenchError::Start {
        program: qemu.to_owned(),
        cause,
    })?;
    let said = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<Line> = said.lines().filter_map(Line::parse).collect();
    if !output.status.success() || lines.len() != rows {
        return Err(BenchError::Core {
            image: image.to_owned(),
            status: output.status.to_string(),
            said: format!("{said}{}", String::from_utf8_lossy(&output.stderr)),
        });
    }
    let loops = loops(&recorder.file, image, rows)?;
    Ok((lines, loops))
}

fn measure_group(
    qemu: &Path,
    plugin: &Path,
    board: Board,
    group: Group,
    elf: &Path,
) -> Result<Vec<Measurement>, BenchError> {
    let entries = entries(group);
    let (lines, loops) = record(qemu, plugin, board, &image_name(group), elf, entries.len())?;
    let damaged = |cause: String| BenchError::Elf {
        path: elf.to_owned(),
        cause,
    };
    let bytes = fs::read(elf).map_err(|cause| damaged(cause.to_string()))?;
    let code = Code::of(&bytes).map_err(damaged)?;
    let compiler = firmware::compiler(&bytes)
        .ok_or_else(|| damaged("it does not say which rustc made it".to_owned()))?;
    let rows = entries.into_par_iter().zip(lines).zip(loops);
    rows.map(|((entry, line), [baseline, inline, called])| {
        compare(&entry, &line)?;
        let cycles = |with: Cycles| differences(baseline, with);
        let reach = code
            .from(line.address.into())
            .ok_or_else(|| damaged(format!("it has no function at {:#x}", line.address)))?;
        Ok(Measurement {
            entry,
            board,
            instructions: line.instructions(line.inline),
            called_instructions: line.instructions(line.called),
            cycles: cycles(inline)[1],
            cycles_within: [cycles(inline)[0], cycles(inline)[2]],
            called_cycles: cycles(called)[1],
            reach,
            elf: elf.to_owned(),
            compiler: compiler.clone(),
        })
    })
    .collect()
}

/// The cycles of each row's loops.
fn loops(recording: &Path, image: &str, rows: usize) -> Result<Vec<[Cycles; LOOPS]>, BenchError> {
    let flows = file::read(recording)?.segments;
    let interrupted = flows.iter().any(|flow| flow.interruption().is_some());
    if flows.len() != LOOPS * rows || interrupted {
        return Err(BenchError::Loops {
            image: image.to_owned(),
            found: flows.len(),
            rows,
        });
    }
    let (triples, _none) = flows.as_chunks::<LOOPS>();
    Ok(triples
        .iter()
        .map(|triple| triple.each_ref().map(|flow| cycles(flow, 0)))
        .collect())
}

/// Mean cycles of an operation: at least, likely, and at most. As with [instructions](Line::instructions), every round does the same,
/// and what is around all rounds differs by less than half a cycle a round.
fn differences(baseline: Cycles, with: Cycles) -> [f64; 3] {
    let mean = |without: u64, with: u64| {
        let cycles = with as f64 - without as f64;
        (cycles / f64::from(ROUNDS)).round() / CASES as f64
    };
    [
        mean(baseline.low, with.low),
        mean(baseline.likely, with.likely),
        mean(baseline.high, with.high),
    ]
}

fn compare(entry: &Entry, line: &Line) -> Result<(), BenchError> {
    let host = (entry.transcript)(line.cases);
    if host == line.transcript {
        return Ok(());
    }
    Err(BenchError::Transcript {
        operation: entry.operation,
        variant: entry.name(),
        core: line.transcript,
        host,
        cases: line.cases,
    })
}

/// A row's line on the console: `row` and eight words in hexadecimal.
#[derive(Clone, Copy, Debug)]
struct Line {
    cases: u32,
    baseline: u32,
    inline: u32,
    called: u32,
    transcript: u64,
    address: u32,
}

impl Line {
    fn parse(text: &str) -> Option<Self> {
        let words = text.trim().strip_prefix("row ")?;
        let words: Vec<u32> = words
            .split(' ')
            .map(|word| u32::from_str_radix(word, 16))
            .collect::<Result<_, _>>()
            .ok()?;
        let [_row, cases, baseline, inline, called, high, low, address] = words.try_into().ok()?;
        Some(Self {
            cases,
            baseline,
            inline,
            called,
            transcript: u64::from(high) << 32 | u64::from(low),
            address,
        })
    }

    /// Mean instructions of an operation in a loop that took so many ticks. Every round does the same, so the mean is a whole
    /// number of instructions over the number of cases: what the clock's ticks blur is less than half of that.
    fn instructions(&self, ticks: u32) -> f64 {
        let ticks = f64::from(ticks) - f64::from(self.baseline);
        (ticks * INSTRUCTIONS_PER_TICK / f64::from(ROUNDS)).round() / CASES as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_console_is_a_price() {
        let instructions = 3 * ROUNDS * CASES as u32;
        // As many ticks as end within them, and one more, which the clock may have been short of.
        let ticks = 0x10 + (f64::from(instructions) / INSTRUCTIONS_PER_TICK) as u32 + 1;
        let text =
            format!("row 00000002 0000000a 00000010 {ticks:08x} 00000010 00000001 00000002 00001a14\r");
        let line = Line::parse(&text).expect("a line");
        assert_eq!(
            (line.cases, line.transcript, line.address),
            (10, 1 << 32 | 2, 0x1a14)
        );
        assert_eq!(
            (line.instructions(line.inline), line.instructions(line.called)),
            (3.0, 0.0)
        );
        assert!(Line::parse("panic at somewhere").is_none() && Line::parse("row 00000002").is_none());
    }
}
