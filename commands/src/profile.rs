//! `cargo xtask profile`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use host::platform::console::say;
use host::profile::run::Run;
use host::profile::table::{self, Shown};
use host::profile::{self, ProfileOptions, compare};

use crate::SetUp;

/// Arguments of `profile`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: ProfileOptions,
    #[command(flatten)]
    shown: Shown,
    /// Write the run as JSON, too: all functions and lines, and the blocks that are shown
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the stacks, inlined functions and all, as an SVG file
    #[arg(long, value_name = "FILE")]
    flame_graph: Option<PathBuf>,
    /// Say what has changed since a run of the same that was written as JSON
    #[arg(long, value_name = "FILE")]
    compare: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let Arguments { options, shown, .. } = arguments;
    let before = match &arguments.compare {
        Some(path) => {
            let before = Run::read(path)?;
            before.check(path, &options.subject()?)?;
            Some(before)
        }
        None => None,
    };
    let install = arguments.set_up.install();
    let profile = profile::profile(options, shown.blocks, install, interrupted)?;
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&profile.run)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    if let Some(path) = &arguments.flame_graph {
        std::fs::write(path, profile.flame_graph())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    say(table::table(&profile.run, *shown))?;
    if let Some(before) = before {
        say(format!("\n{}", compare::table(&before, &profile.run)))?;
    }
    Ok(ExitCode::SUCCESS)
}
