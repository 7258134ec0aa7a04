//! `cargo xtask bench`

mod generators;
mod ops;

use std::process::ExitCode;

/// What to measure.
#[derive(clap::Subcommand)]
pub(crate) enum Bench {
    /// Judge the random number generators: period, lattice, streams, uniformity, dieharder
    Generators(generators::Arguments),
    /// Print what each arithmetic operation costs on a core, and how wrong it is
    ///
    /// Instructions are those of an emulated core without the loop around them: once compiled in line, once
    /// called. A star marks what nothing else of the operation beats in cost and in worst error.
    Ops(ops::Arguments),
}

pub(crate) fn run(bench: &Bench) -> anyhow::Result<ExitCode> {
    match bench {
        Bench::Generators(arguments) => generators::run(arguments),
        Bench::Ops(arguments) => ops::run(arguments),
    }
}
