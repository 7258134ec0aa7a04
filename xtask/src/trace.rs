//! `cargo xtask trace`

use std::process::ExitCode;

use host::console::say;
use host::interrupt;
use host::job::{self, TraceOptions};

use crate::render;

/// Arguments of `trace`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: TraceOptions,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let traced = job::trace(&arguments.options, interrupt::watch()?)?;
    let said = traced.packets.iter().try_for_each(say);
    // How the render ended comes before what could not be said of it.
    let code = render::outcome(traced.end)?;
    said?;
    Ok(code)
}
