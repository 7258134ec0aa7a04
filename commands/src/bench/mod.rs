//! `cargo xtask bench`

mod generators;
mod intersections;
mod ops;
mod reference;
mod scaling;
mod trace;

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// What to measure.
#[derive(clap::Subcommand)]
pub(crate) enum Bench {
    /// Judge the random number generators: period, lattice, streams, uniformity, dieharder
    Generators(generators::Arguments),
    /// Print what each formula that meets a sphere costs on a core; how wrong it is, `verify stability` says
    Intersections(intersections::Arguments),
    /// Print what each arithmetic operation costs on a core, and how wrong it is
    ///
    /// Instructions and cycles are those of an emulated core without the loop around them: once compiled in line, once
    /// called. A star marks what nothing else of the operation beats in cost and in worst error.
    Ops(ops::Arguments),
    /// Print how efficient the double-precision reference is beside a plain path tracer in C++
    ///
    /// Efficiency is one over variance times time. g++ builds the program, and both render the same picture in turns, on one thread
    /// each. Fails where they disagree about the picture, and where the reference is less than 10 times as efficient on the Cornell box.
    Reference(reference::Arguments),
    /// Print samples a second against cores, up to 136 emulated ones, in the time of real ones
    ///
    /// Figure 4 of the published system: every unit is rendered by emulated cores and costs what they count; leases, the limit on packets
    /// and the collector's answers are simulated, so no figure depends on how busy this machine is. Says how many samples a packet needs,
    /// and on paper what a million cores would do, and samples a joule (docs/scaling.md).
    Scaling(scaling::Arguments),
    /// Print what a whole sample costs by board, profile and way to end a path, and how wrong it is
    ///
    /// Renders the same small picture by each of them. It is the same picture on every board. What is behind a `±` of cycles is what the
    /// processor's model leaves open.
    Trace(trace::Arguments),
}

pub(crate) fn run(bench: &Bench, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    match bench {
        Bench::Generators(arguments) => generators::run(arguments),
        Bench::Intersections(arguments) => intersections::run(arguments),
        Bench::Ops(arguments) => ops::run(arguments),
        Bench::Reference(arguments) => reference::run(arguments),
        Bench::Scaling(arguments) => scaling::run(arguments, interrupted),
        Bench::Trace(arguments) => trace::run(arguments, interrupted),
    }
}
