//! `cargo xtask trace`

use std::process::ExitCode;

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
    render::outcome(job::trace(&arguments.options, interrupt::watch()?))
}
