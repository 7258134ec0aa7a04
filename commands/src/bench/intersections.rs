//! `cargo xtask bench intersections`

use std::process::ExitCode;

use anyhow::Context;
use host::bench::operations;
use host::firmware::board::Board;
use host::platform::console::say;
use host::platform::setup::{self, Wanted};

use crate::SetUp;

/// Arguments of `bench intersections`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Board of the core
    #[arg(long, value_enum, default_value_t)]
    board: Board,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, arguments.set_up.install())?;
    let toolchain = tools.firmware.context("set-up gave no compiler")?;
    let qemu = tools.qemu.context("set-up gave no QEMU")?;
    say(operations::intersections(&toolchain, &qemu, arguments.board)?)?;
    Ok(ExitCode::SUCCESS)
}
