//! The project's commands, which `cargo xtask` builds and starts. Thin: each verb is one file, and what a test needs to reach is in
//! the host library.

mod bench;
mod check;
mod fuzz;
mod gdb;
mod licences;
mod profile;
mod qemu_run;
mod render;
mod report;
mod size;
mod step;
mod test;
mod toolchain;
mod trace;
mod verify;

use std::process::ExitCode;
use std::sync::atomic::Ordering;

use anyhow::Context;
use clap::Parser;
use host::platform::console::{self, OutputError};
use host::platform::interrupt;
use host::platform::setup::Install;

/// The project's commands
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version)]
enum Verb {
    /// Render a picture on emulated cores, and say how far it is from the truth
    ///
    /// Builds the image the scene needs, starts the cores and a collector, and writes image.png, image.exr,
    /// reference.exr, difference.png and report.json. Installs what is missing first, and says what.
    Render(render::Arguments),
    /// Run everything that CI runs
    Test(test::Arguments),
    /// Run what needs no emulator: format, licences, lints, documentation, unit tests
    Check(check::Arguments),
    /// Fuzz everything that is read from outside, with libFuzzer
    ///
    /// Starts from what this code writes, and from fuzz/corpus. What it finds stays in fuzz/ of the target folder, and what it fails on
    /// is shown and kept there.
    Fuzz(fuzz::Arguments),
    /// Run one image on one emulated core; the exit code is the core's
    QemuRun(qemu_run::Arguments),
    /// Print the variables with which plain cargo builds and runs a board's crate, for a shell to evaluate
    ///
    /// As in: eval "$(cargo xtask toolchain)"; cd firmware/mps2-an385; cargo run --example core_tests
    Toolchain(toolchain::Arguments),
    /// Start one core of a render under a debugger, which takes it to `main`
    ///
    /// Builds the image the scene needs and starts core N alone; a collector stands ready to lease it work, and waits for it
    /// as long as it stands still. The core's console is gdb/core-N.log in the folder for the results. Ends with gdb. Words
    /// after `--` go to gdb: `-- --batch -ex backtrace`.
    Gdb(gdb::Arguments),
    /// Render a picture and record the packets of one core, as Wireshark reads them
    ///
    /// Writes core-N.pcap beside what `render` writes (core-N.2.pcap and so on, where the core was started again), and says how
    /// many packets of each command went each way. docs/sdp.lua shows Wireshark their fields.
    Trace(trace::Arguments),
    /// Print each image's bytes of code, data and stack against the budget
    Size(size::Arguments),
    /// Say where the cycles of a sample go: by function, by class of instruction, by line, by basic block
    ///
    /// Renders a small picture on one core while a plugin of QEMU's records what it executes, and prices the recording by the
    /// tables of the board's processor. Inlined functions are told apart. Where a function of the image has several callers, its
    /// cycles are shared among them in proportion to their calls.
    Profile(profile::Arguments),
    /// Write the speed-against-error report: one HTML page with its plots, pictures and tables
    ///
    /// Measures operations, whole samples, each choice alone, error against time, the paper's figures, hard cases and the scenes, in
    /// half an hour. A plot without data is an error, and the old page stays. `--out docs/report` is for the one in the repository.
    Report(report::Arguments),
    /// Measure parts by themselves
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Compare the arithmetic with the truth, over a sample or over all inputs
    ///
    /// A sample must not be worse than the record of the exhaustive run, fixedmath/proof.json, and another exhaustive run
    /// must find what it says.
    Verify(verify::Arguments),
}

/// The flag that several verbs share.
#[derive(clap::Args)]
struct SetUp {
    /// Say what is missing on this machine, and stop instead of installing it
    #[arg(long)]
    no_install: bool,
}

impl SetUp {
    fn install(&self) -> Install {
        Install::unless(self.no_install)
    }
}

fn main() -> ExitCode {
    match console::arguments() {
        Ok(verb) => run(verb).unwrap_or_else(|error| failed(&error)),
        Err(code) => code,
    }
}

/// Ends a command that has this error.
fn failed(error: &anyhow::Error) -> ExitCode {
    if let Some(error) = error.downcast_ref::<OutputError>() {
        return error.end();
    }
    console::note(format!("error: {}", console::in_full(error.as_ref())));
    if interrupt::flag().load(Ordering::Relaxed) {
        ExitCode::from(interrupt::EXIT_CODE)
    } else {
        ExitCode::FAILURE
    }
}

fn run(verb: Verb) -> anyhow::Result<ExitCode> {
    let interrupted = interrupt::watch().context("interruptions cannot be watched for")?;
    match verb {
        Verb::Render(arguments) => render::run(&arguments, interrupted),
        Verb::Test(arguments) => test::run(&arguments),
        Verb::Check(arguments) => check::run(&arguments),
        Verb::Fuzz(arguments) => fuzz::run(&arguments),
        Verb::QemuRun(arguments) => qemu_run::run(&arguments),
        Verb::Toolchain(arguments) => toolchain::run(&arguments),
        Verb::Gdb(arguments) => gdb::run(&arguments),
        Verb::Trace(arguments) => trace::run(&arguments, interrupted),
        Verb::Size(arguments) => size::run(&arguments),
        Verb::Profile(arguments) => profile::run(&arguments, interrupted),
        Verb::Report(arguments) => report::run(&arguments, interrupted),
        Verb::Bench(bench) => bench::run(&bench, interrupted),
        Verb::Verify(arguments) => verify::run(&arguments),
    }
}
