//! `cargo xtask report`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use anyhow::{Context, anyhow};
use host::platform::console::{bar, note, say};
use host::platform::workspace;
use host::report::{self, Origin, PARTS, Workshop};
use host::stability::Effort;

use crate::SetUp;
use crate::step::seconds;

/// Of work on the host, `--quick` does one of so many parts.
const QUICK: u64 = 2000;

/// Arguments of `report`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Only see that everything can be measured: little work, whose figures mean nothing
    #[arg(long)]
    quick: bool,
    /// Where the page goes [default: out/report, or out/report-quick]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => workspace::file(if arguments.quick {
            "out/report-quick"
        } else {
            "out/report"
        })?,
    };
    let workshop = Workshop::new(arguments.quick, arguments.set_up.install(), interrupted);
    let start = std::time::Instant::now();
    let mut sections = Vec::new();
    for part in PARTS {
        note(format!("{}: {}", part.name, part.about));
        let began = std::time::Instant::now();
        let bar = bar(part.name);
        let made = (part.make)(
            &workshop,
            &Effort::new(if arguments.quick { QUICK } else { 1 }, bar.clone()),
        );
        bar.finish_and_clear();
        let section = made.map_err(|error| anyhow!(error).context(part.name))?;
        // At once, and not after half an hour.
        section
            .check()
            .with_context(|| format!("{} cannot be shown", part.name))?;
        sections.push(section);
        note(format!("{}: done in {}", part.name, seconds(began.elapsed())));
    }
    let origin = Origin {
        command: format!(
            "cargo xtask report{}",
            if arguments.quick { " --quick" } else { "" }
        ),
        is_quick: arguments.quick,
        compiler: workshop.compiler().map_err(|error| anyhow!(error))?,
    };
    let files = report::write(&folder, &sections, &origin).map_err(|error| anyhow!(error))?;
    for file in files {
        say(file.display())?;
    }
    note(format!("in {}", seconds(start.elapsed())));
    Ok(ExitCode::SUCCESS)
}
