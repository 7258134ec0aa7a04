//! `cargo xtask render`

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use host::platform::console::say;
use host::render;
use host::render::options::RenderOptions;

/// Arguments of `render`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: RenderOptions,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let finished = render::render(&arguments.options, interrupted)?;
    say(finished.summary)?;
    Ok(ExitCode::SUCCESS)
}
