//! `cargo xtask gdb`

use std::io::{IsTerminal, stdin};
use std::process::ExitCode;

use anyhow::Context;
use host::platform::interrupt;
use host::render::{self, DebugOptions};

/// Arguments of `gdb`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: DebugOptions,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    // Without a terminal there is no Ctrl-C to stop a core with: an interruption ends this program, and its children with it.
    if stdin().is_terminal() {
        interrupt::leave_to_child();
    }
    let status = render::debug(&arguments.options)?;
    let code = status
        .code()
        .with_context(|| format!("the debugger did not end by itself: {status}"))?;
    // Exit codes have eight bits.
    Ok(ExitCode::from(code as u8))
}
