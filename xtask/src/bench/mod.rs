//! `cargo xtask bench`

mod generators;

use std::process::ExitCode;

/// What to measure.
#[derive(clap::Subcommand)]
pub(crate) enum Bench {
    /// Judge the random number generators: period, lattice, streams, uniformity, dieharder
    Generators(generators::Arguments),
}

pub(crate) fn run(bench: &Bench) -> anyhow::Result<ExitCode> {
    match bench {
        Bench::Generators(arguments) => generators::run(arguments),
    }
}
