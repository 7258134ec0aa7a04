//! `cargo xtask toolchain`

use std::process::ExitCode;

use anyhow::Context;
use host::board::Board;
use host::firmware;
use host::setup::{self, Wanted};

use crate::SetUp;

/// Arguments of `toolchain`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
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
    let itself = std::env::current_exe().context("this program does not know where it is")?;
    let mut variables: Vec<(String, String)> = Vec::new();
    for board in Board::ALL {
        for (name, value) in firmware::environment(&toolchain, board.target()) {
            variables.push((name, value.to_string_lossy().into_owned()));
        }
        // This program itself, so that the boards' cargo need not build it.
        let runner = format!("{} qemu-run", itself.display());
        variables.push((firmware::variable_of(board.target(), "RUNNER"), runner));
    }
    variables.sort_unstable();
    variables.dedup();
    for (name, value) in variables {
        println!("export {name}={}", quoted(&value));
    }
    Ok(ExitCode::SUCCESS)
}

/// A word for a shell.
fn quoted(value: &str) -> String {
    format!("'{}'", value.replace('\'', r"'\''"))
}
