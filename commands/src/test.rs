//! `cargo xtask test`

use std::panic::resume_unwind;
use std::process::ExitCode;
use std::thread;
use std::time::Instant;

use anyhow::{Context, bail};
use host::firmware::Level;
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::Board;
use host::firmware::footprint::{self, Footprint};
use host::firmware::{self, Recipe};
use host::platform::console::say;
use host::platform::setup::{self, Toolchain, Wanted};
use host::platform::workspace;
use host::scene::Scene;

use crate::step::{cargo, seconds, shown, step, succeed};
use crate::{SetUp, check, size, verify};

/// Arguments of `test`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        lints: true,
        gdb: true,
        tshark: true,
        system_linker: true,
        system_compiler: true,
        cxx: true,
        gxx: true,
        ..Wanted::default()
    };
    let tools = step("set-up", || {
        Ok(setup::ensure(wanted, arguments.set_up.install())?)
    })?;
    let toolchain = tools.firmware.context("set-up gave no compiler")?;
    let scene = Scene::load(&workspace::scene(None)?)?;
    let rows = thread::scope(|scope| {
        // Much of what a compiler does takes one processor: the host's and the firmware's work side by side, each in a target
        // folder of its own.
        let firmware = scope.spawn(|| firmware_steps(&toolchain, &scene));
        let host = host_steps();
        let firmware = firmware.join().unwrap_or_else(|panic| resume_unwind(panic));
        match (host, firmware) {
            (Err(host), Err(firmware)) => bail!("{host:#}\n\n{firmware:#}"),
            (host, firmware) => host.and(firmware),
        }
    })?;
    say(footprint::table(&rows))?;
    step("whole system", || {
        shown(cargo(&[
            "test",
            "--quiet",
            "--release",
            "--no-fail-fast",
            "--package",
            "whole-system",
            "--test",
            "stability",
            "--test",
            "kinds",
            "--test",
            "system",
            "--test",
            "truth",
            "--test",
            "report",
            "--",
            // Tests on the cores report one by one, and others give their figures.
            "--show-output",
        ])?)
    })?;
    say(format!("all passed in {}", seconds(start.elapsed())))?;
    Ok(ExitCode::SUCCESS)
}

/// What is tested with overflow checks and debug assertions: what does not trip them does the same without.
const CHECKED: [&str; 4] = ["fixedmath", "tracer", "wire", "node"];

fn host_steps() -> anyhow::Result<()> {
    check::steps(&CHECKED)?;
    step("fixedmath as a package", || {
        succeed(cargo(&[
            "package",
            "--quiet",
            "--offline",
            "--allow-dirty",
            "--package",
            "fixedmath",
        ])?)
    })?;
    step("tests, checked build", || {
        let mut command = cargo(&["test", "--quiet"])?;
        command.args(CHECKED.iter().flat_map(|package| ["--package", package]));
        shown(command)
    })?;
    step("arithmetic against the truth", || verify::sampled().map(|_| ()))
}

fn firmware_steps(toolchain: &Toolchain, scene: &Scene) -> anyhow::Result<Vec<Footprint>> {
    step("fixedmath for a Cortex-M0", || {
        succeed(firmware::cargo_for(
            toolchain,
            "check",
            "fixedmath",
            "thumbv6m-none-eabi",
        )?)
    })?;
    step("firmware lints", || lint_firmware(toolchain, scene))?;
    step("firmware", || size::measure(toolchain, scene))
}

/// Lints the boards' crates with the compiler that builds them: one with a log, and the other without, where its macros are empty.
fn lint_firmware(toolchain: &Toolchain, scene: &Scene) -> anyhow::Result<()> {
    for (board, log) in [(Board::Versatilepb, None), (Board::Mps2An385, Some(Level::Trace))] {
        let recipe = Recipe {
            log,
            ..Recipe::by_default(Arithmetic::Precise, scene)
        };
        let mut command = firmware::cargo(toolchain, board, "clippy", &recipe)?;
        command.args(["--lib", "--bins", "--examples", "--", "--deny", "warnings"]);
        succeed(command)?;
    }
    Ok(())
}
