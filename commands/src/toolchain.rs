//! `cargo xtask toolchain`

use std::collections::BTreeMap;
use std::os::unix::ffi::OsStrExt;
use std::process::ExitCode;

use anyhow::Context;
use host::firmware;
use host::firmware::board::Board;
use host::platform::console::put;
use host::platform::setup::{self, Wanted};

use crate::SetUp;

/// Where `firmware/qemu-run`, cargo's runner for the boards, looks for this program.
const RUNNER: &str = "TRACER_XTASK";

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
    // This program itself, so that the boards' cargo need not build it. Not as their runner: cargo would cut its path at every space.
    let mut variables = BTreeMap::from([(RUNNER.to_owned(), itself.into_os_string())]);
    for board in Board::ALL {
        variables.extend(firmware::environment(&toolchain, board.target()));
    }
    let mut script = Vec::new();
    for (name, value) in variables {
        script.extend_from_slice(format!("export {name}=").as_bytes());
        script.extend(quoted(value.as_bytes()));
        script.push(b'\n');
    }
    put(&script)?;
    Ok(ExitCode::SUCCESS)
}

/// A word for a shell, of whatever bytes.
fn quoted(value: &[u8]) -> Vec<u8> {
    let quotes = value
        .split(|&byte| byte == b'\'')
        .collect::<Vec<_>>()
        .join(&br"'\''"[..]);
    [b"'", &quotes[..], b"'"].concat()
}
