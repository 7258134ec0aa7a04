//! `cargo xtask`: builds the project's commands where it can be seen, and becomes them.
//!
//! The commands link the whole host library, which on a fresh clone takes some minutes of a processor to compile. This program has
//! no dependencies, so it is there after a second and says so. Where there is nothing to build it says nothing.

mod progress;

use std::env;
use std::error::Error;
use std::io::{self, IsTerminal, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, ExitStatus, Stdio};

/// The package of the commands, and its program.
const COMMANDS: &str = "commands";

fn main() -> ExitCode {
    match start() {
        Ok(code) => code,
        Err(error) => {
            note(format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Comes back only where the commands could not be started.
fn start() -> Result<ExitCode, Box<dyn Error>> {
    let itself =
        env::current_exe().map_err(|cause| format!("this program does not know where it is: {cause}"))?;
    let folder = itself.parent().ok_or("this program lies in no folder")?;
    let status = build(folder)?;
    if !status.success() {
        note("error: the project's commands did not build; what cargo says of it stands above");
        return Ok(status
            .code()
            .map_or(ExitCode::FAILURE, |code| ExitCode::from(code as u8)));
    }
    // Beside this program, because cargo builds both in one target folder by one profile.
    let program = folder.join(COMMANDS);
    let cause = Command::new(&program).args(env::args_os().skip(1)).exec();
    Err(format!(
        "cannot start {}: {cause}; run it as `cargo xtask`",
        program.display()
    )
    .into())
}

/// Has cargo build the commands by the profile that this program was built by.
fn build(folder: &Path) -> Result<ExitStatus, Box<dyn Error>> {
    let profile = folder.file_name().ok_or("this program lies in no folder")?;
    let profile = if profile == "debug" {
        "dev".as_ref()
    } else {
        profile
    };
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(&cargo);
    command.args(["build", "--package", COMMANDS, "--profile"]);
    command.arg(profile);
    if let Some(package) = env::var_os("CARGO_MANIFEST_DIR") {
        command
            .arg("--manifest-path")
            .arg(PathBuf::from(package).join("Cargo.toml"));
    }
    // Through a pipe, because only what cargo says tells whether there is something to build.
    command.env("CARGO_TERM_PROGRESS_WHEN", "always");
    command.env("CARGO_TERM_PROGRESS_WIDTH", "80");
    let terminal = io::stderr().is_terminal();
    if terminal && env::var_os("CARGO_TERM_COLOR").is_none() && env::var_os("NO_COLOR").is_none() {
        command.env("CARGO_TERM_COLOR", "always");
    }
    let failed = |cause: io::Error| format!("cannot run {}: {cause}", cargo.display());
    let mut child = command.stderr(Stdio::piped()).spawn().map_err(failed)?;
    if let Some(said) = child.stderr.take() {
        progress::show(said, terminal);
    }
    Ok(child.wait().map_err(failed)?)
}

/// Tells whoever watches; that nobody does is no fault.
fn note(text: impl AsRef<str>) {
    let _nobody_watches = io::stderr().write_all(format!("{}\n", text.as_ref()).as_bytes());
}
