//! `cargo xtask check`: what needs neither an emulator nor the firmware's compiler, and is done before anything is submitted.

use std::process::ExitCode;
use std::time::Instant;

use host::platform::console::say;
use host::platform::setup::{self, Wanted};

use crate::step::{cargo, seconds, shown, step, succeed};
use crate::{SetUp, licences};

/// Arguments of `check`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let wanted = Wanted {
        lints: true,
        ..Wanted::default()
    };
    step("set-up", || {
        Ok(setup::ensure(wanted, arguments.set_up.install())?)
    })?;
    steps(&[])?;
    say(format!("all passed in {}", seconds(start.elapsed())))?;
    Ok(ExitCode::SUCCESS)
}

/// The steps, which are the first of `cargo xtask test`, too. It tests some packages in a checked build instead.
pub(crate) fn steps(checked: &[&str]) -> anyhow::Result<()> {
    step("format", || succeed(cargo(&["fmt", "--all", "--check"])?))?;
    step("licences", licences::check)?;
    step("lints", || {
        // As a release build, whose procedural macros and build scripts the tests need anyway.
        let words = ["clippy", "--release", "--all-targets", "--", "--deny", "warnings"];
        succeed(cargo(&words)?)
    })?;
    step("documentation", || {
        let mut command = cargo(&["doc", "--release", "--no-deps"])?;
        command.env("RUSTDOCFLAGS", "--deny warnings");
        succeed(command)
    })?;
    step("unit tests", || unit_tests(checked))
}

/// All but the whole system's and those of `checked` packages, as a release build.
fn unit_tests(checked: &[&str]) -> anyhow::Result<()> {
    // What has no tests on the host, and what is tested apart.
    let apart = ["runtime", "versatilepb", "mps2-an385", "fuzz", "whole-system"];
    let mut all = cargo(&["test", "--quiet", "--release", "--workspace"])?;
    let excluded = apart.iter().chain(checked);
    all.args(excluded.flat_map(|package| ["--exclude", package]));
    shown(all)
}
