//! `cargo xtask verify stability`

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, anyhow, ensure};
use host::platform::console::{bar, note, say};
use host::platform::file::write_whole;
use host::platform::workspace;
use host::stability::{Effort, Findings, PARTS, Part};

/// `--quick` is one part of so many.
const QUICK: u64 = 100;

/// Arguments of `verify stability`.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// What to measure [default: all]
    #[arg(value_name = "PART", value_parser = clap::builder::PossibleValuesParser::new(PARTS.iter().map(|part| part.name)))]
    parts: Vec<String>,
    /// A hundredth of the work
    #[arg(long)]
    quick: bool,
    /// Where tables and plots go [default: out/stability]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => workspace::file("out/stability")?,
    };
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let is_wanted =
        |part: &&Part| arguments.parts.is_empty() || arguments.parts.iter().any(|name| name == part.name);
    let mut faults = Vec::new();
    for part in PARTS.iter().filter(is_wanted) {
        note(format!("{}: {}", part.name, part.about));
        let bar = bar(part.name);
        let measured = (part.measure)(&Effort::new(if arguments.quick { QUICK } else { 1 }, bar.clone()));
        bar.finish_and_clear();
        let findings = measured.map_err(|error| anyhow!(error).context(part.name))?;
        say(write(&folder, part, &findings)?)?;
        faults.extend(
            findings
                .faults
                .iter()
                .map(|fault| format!("{}: {fault}", part.name)),
        );
    }
    ensure!(
        faults.is_empty(),
        "what should hold does not:\n{}",
        faults.join("\n")
    );
    Ok(ExitCode::SUCCESS)
}

/// Writes a part's tables and plots, and gives the tables' text.
fn write(folder: &Path, part: &Part, findings: &Findings) -> anyhow::Result<String> {
    let tables: Vec<String> = findings.tables.iter().map(ToString::to_string).collect();
    let text = tables.join("\n");
    let path = folder.join(format!("{}.md", part.name));
    write_whole(&path, |file| std::io::Write::write_all(file, text.as_bytes()))?;
    for plot in &findings.plots {
        plot.write(&folder.join(format!("{}.png", plot.name)))?;
    }
    for sheet in &findings.sheets {
        sheet.write(&folder.join(format!("{}.png", sheet.name)))?;
    }
    Ok(text)
}
