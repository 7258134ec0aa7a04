//! R. Brown's `dieharder` battery on the bits that the tracer uses.

use std::fmt;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;

use serde::Serialize;

use super::streams::{Width, write_words};
use crate::platform::interrupt::LastAct;

/// Which of its tests to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Battery {
    /// All of them, each repeated with more numbers while its result is weak.
    All,
    /// One, by dieharder's number for it.
    Only(u16),
}

impl Battery {
    /// The arguments of `dieharder`: raw 32-bit words from its input.
    pub fn arguments(self) -> Vec<String> {
        let raw = ["-g", "200"].map(str::to_owned).into_iter();
        match self {
            Self::All => raw.chain(["-Y", "1", "-a"].map(str::to_owned)).collect(),
            Self::Only(number) => raw.chain(["-d".to_owned(), number.to_string()]).collect(),
        }
    }
}

/// Dieharder's word on one test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Assessment {
    /// p is neither near 0 nor near 1.
    Passed,
    /// One p in a hundred of a perfect generator is like this.
    Weak,
    /// One in a million would be.
    Failed,
}

/// A line of dieharder's table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The test's name.
    pub test: String,
    /// Its size, such as how many bits or which lag.
    pub size: u32,
    /// Numbers or objects in one repetition.
    pub samples: u64,
    /// Repetitions, whose p-values were tested for uniformity.
    pub repetitions: u64,
    /// The p-value of that.
    pub p: f64,
    /// Dieharder's reading of it.
    pub assessment: Assessment,
}

impl Row {
    /// Reads a line; `None` if it is none of the table's.
    fn parse(line: &str) -> Option<Self> {
        let columns: Vec<&str> = line.split('|').map(str::trim).collect();
        let [test, size, samples, repetitions, p, assessment] = columns[..] else {
            return None;
        };
        Some(Self {
            test: test.to_owned(),
            size: size.parse().ok()?,
            samples: samples.parse().ok()?,
            repetitions: repetitions.parse().ok()?,
            p: p.parse().ok()?,
            assessment: match assessment {
                "PASSED" => Assessment::Passed,
                "WEAK" => Assessment::Weak,
                "FAILED" => Assessment::Failed,
                _ => return None,
            },
        })
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:22} {:>3} {:>9} {:>5}  {:.8}  {:?}",
            self.test, self.size, self.samples, self.repetitions, self.p, self.assessment
        )
    }
}

/// Why dieharder said nothing, or not all.
#[derive(Debug, thiserror::Error)]
pub enum DieharderError {
    /// It could not be started.
    #[error("cannot start {} (is it a working dieharder?)", program.display())]
    NotStarted {
        /// The program.
        program: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// The pipe to or from it broke.
    #[error("dieharder's numbers or results could not be piped (run it again)")]
    Pipe(#[from] io::Error),
    /// It stopped, or its table is not as expected.
    #[error("dieharder ended with {status} and {rows} results; run `{command}` by hand to see what it says")]
    NoResult {
        /// How it ended.
        status: ExitStatus,
        /// Lines of the table that could be read.
        rows: usize,
        /// The command.
        command: String,
    },
}

/// Runs a battery on `numbers`, and tells each row as it comes.
pub fn run(
    program: &Path,
    battery: Battery,
    numbers: impl Iterator<Item = u32> + Send,
    width: Width,
    mut tell: impl FnMut(&Row),
) -> Result<Vec<Row>, DieharderError> {
    let arguments = battery.arguments();
    let mut child = Command::new(program)
        .args(&arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|cause| DieharderError::NotStarted {
            program: program.to_owned(),
            cause,
        })?;
    let _interrupts = LastAct::interrupts(&child);
    let rows = feed(&mut child, numbers, width, &mut tell)?;
    let status = child.wait()?;
    if !status.success() || rows.is_empty() {
        return Err(DieharderError::NoResult {
            status,
            rows: rows.len(),
            command: format!("{} {}", program.display(), arguments.join(" ")),
        });
    }
    Ok(conclusions(&rows))
}

/// Without the rows of tests that were repeated: a later row with more repetitions includes them.
fn conclusions(rows: &[Row]) -> Vec<Row> {
    let repeated = |row: &Row| {
        rows.iter().any(|other| {
            other.test == row.test && other.size == row.size && other.repetitions > row.repetitions
        })
    };
    rows.iter().filter(|row| !repeated(row)).cloned().collect()
}

/// Writes to the child until it has had enough, and meanwhile reads what it says.
fn feed(
    child: &mut Child,
    numbers: impl Iterator<Item = u32> + Send,
    width: Width,
    tell: &mut dyn FnMut(&Row),
) -> io::Result<Vec<Row>> {
    let (Some(mut input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(io::ErrorKind::BrokenPipe.into());
    };
    thread::scope(|scope| {
        let writer = scope.spawn(move || write_words(numbers, width, &mut input));
        let mut rows = Vec::new();
        for line in BufReader::new(output).lines() {
            if let Some(row) = Row::parse(&line?) {
                tell(&row);
                rows.push(row);
            }
        }
        writer
            .join()
            .unwrap_or_else(|_| Err(io::ErrorKind::Other.into()))?;
        Ok(rows)
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::platform::script::script;

    /// A stand-in that reads 8 words and prints what the real one does.
    const STAND_IN: &str = r#"head --bytes 32 >"$0.words"
cat <<'TABLE'
#=============================================================================#
#            dieharder version 3.31.1 Copyright 2003 Robert G. Brown          #
#=============================================================================#
   rng_name    |rands/second|   Seed   |
stdin_input_raw|  4.24e+07  |2164748134|
#=============================================================================#
        test_name   |ntup| tsamples |psamples|  p-value |Assessment
#=============================================================================#
   diehard_birthdays|   0|       100|     100|0.89531532|  PASSED  
      rgb_lagged_sum|  16|   1000000|     100|0.00086257|   WEAK   
      rgb_lagged_sum|  16|   1000000|     200|0.00116257|   WEAK   
        diehard_runs|   0|    100000|     100|0.00000000|  FAILED  
TABLE
"#;

    fn stand_in(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = folder.path().join("dieharder");
        script(&program, text);
        (folder, program)
    }

    #[test]
    fn its_table_is_read_while_it_is_fed() {
        let (folder, program) = stand_in(STAND_IN);
        let mut told = 0;
        let rows = run(&program, Battery::All, 0.., Width::Full, |_| told += 1).expect("it runs");
        let found: Vec<_> = rows
            .iter()
            .map(|row| (row.size, row.repetitions, row.p, row.assessment))
            .collect();
        assert_eq!(
            found,
            [
                (0, 100, 0.895_315_32, Assessment::Passed),
                (16, 200, 0.001_162_57, Assessment::Weak),
                (0, 100, 0.0, Assessment::Failed),
            ]
        );
        assert_eq!(
            (rows[1].test.as_str(), rows[1].samples, told),
            ("rgb_lagged_sum", 1_000_000, 4)
        );
        let words = fs::read(folder.path().join("dieharder.words")).expect("it was fed");
        let expected: Vec<u8> = (0..8u32).flat_map(u32::to_ne_bytes).collect();
        assert_eq!(words, expected);
    }

    #[test]
    fn a_battery_without_results_is_an_error() {
        let (_folder, program) = stand_in("echo 'what is -g?'\nexit 3");
        let error = run(&program, Battery::Only(15), 0.., Width::Half, |_| ()).expect_err("no result");
        let said = error.to_string();
        assert!(
            said.contains("status: 3") && said.contains("-g 200 -d 15"),
            "{said}"
        );
        let missing = program.with_extension("missing");
        let error = run(&missing, Battery::All, 0.., Width::Full, |_| ()).expect_err("no program");
        assert!(error.to_string().contains("cannot start"), "{error}");
    }
}
