//! `cargo xtask render`

use std::process::ExitCode;

use host::console::{note, say};
use host::interrupt;
use host::job::options::RenderOptions;
use host::job::{self, Finished, JobError};

/// Arguments of `render`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: RenderOptions,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    outcome(job::render(&arguments.options, interrupt::watch()?))
}

/// The exit code of a render.
pub(crate) fn outcome(end: Result<Finished, JobError>) -> anyhow::Result<ExitCode> {
    match end {
        Ok(finished) => {
            say(finished.summary)?;
            Ok(ExitCode::SUCCESS)
        }
        Err(error @ JobError::Interrupted(_)) => {
            note(format!("error: {error}"));
            Ok(ExitCode::from(interrupt::EXIT_CODE))
        }
        Err(error) => Err(error.into()),
    }
}
