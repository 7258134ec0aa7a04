//! `cargo xtask trace`

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use host::platform::console::say;
use host::render::{self, TraceOptions};

/// Arguments of `trace`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: TraceOptions,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let traced = render::trace(&arguments.options, interrupted)?;
    let said = traced.packets.iter().try_for_each(say);
    // How the render ended comes before what could not be said of it.
    let finished = traced.end?;
    said?;
    say(finished.summary)?;
    Ok(ExitCode::SUCCESS)
}
