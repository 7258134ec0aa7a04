//! `cargo xtask bench ops`

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use host::bench::operations::{self, plot, readme};
use host::firmware::board::Board;
use host::platform::console::say;
use host::platform::setup::{self, Wanted};

use crate::SetUp;

/// Arguments of `bench ops`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Board of the core
    #[arg(long, value_enum, default_value_t)]
    board: Board,
    /// Write the list as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the list, too, as .svg or .png; may be given more than once
    #[arg(long, value_name = "FILE")]
    plot: Vec<PathBuf>,
    /// Put table and plots into fixedmath/, where its README shows them
    #[arg(long)]
    bless: bool,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    ensure!(
        !arguments.bless || arguments.board == Board::default(),
        "fixedmath's README shows prices of {}: leave out --board or --bless",
        Board::default()
    );
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, arguments.set_up.install())?;
    let toolchain = tools.firmware.context("set-up gave no compiler")?;
    let rows = operations::prices(
        &toolchain,
        &tools.qemu.context("set-up gave no QEMU")?,
        arguments.board,
    )?;
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&rows)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    for path in &arguments.plot {
        plot::write(path, &rows)?;
    }
    if arguments.bless {
        readme::bless(&rows)?;
    }
    say(operations::table::table(&rows).trim_end())?;
    Ok(ExitCode::SUCCESS)
}
