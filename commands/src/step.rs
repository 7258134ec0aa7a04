//! Steps of `check` and `test`, and how their commands are run.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use host::platform::console::say;
use host::platform::interrupt;
use host::platform::workspace::{self, NoWorkspace};

/// Names a step, does it, and says how long it took.
pub(crate) fn step<T>(name: &str, action: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
    say(format!("{name} ..."))?;
    let start = Instant::now();
    let done = action().with_context(|| format!("{name} failed"))?;
    say(format!("{name}: passed in {}", seconds(start.elapsed())))?;
    Ok(done)
}

/// The cargo that runs this program, in the toolchain that was chosen for it.
pub(crate) fn cargo(arguments: &[&str]) -> Result<Command, NoWorkspace> {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.args(arguments).current_dir(workspace::root()?);
    Ok(command)
}

/// Runs a command that speaks for itself.
pub(crate) fn shown(mut command: Command) -> anyhow::Result<()> {
    let program = Path::new(command.get_program()).display().to_string();
    let status =
        interrupt::status(command.stdin(Stdio::null())).with_context(|| format!("cannot start {program}"))?;
    if !status.success() {
        bail!("{command:?} ended with {status}");
    }
    Ok(())
}

/// Runs a command; what it says is shown only if it fails.
pub(crate) fn succeed(mut command: Command) -> anyhow::Result<()> {
    let program = Path::new(command.get_program()).display().to_string();
    let output = interrupt::output(&mut command).with_context(|| format!("cannot start {program}"))?;
    if !output.status.success() {
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        bail!(
            "{command:?} ended with {}:\n{}",
            output.status,
            said.concat().trim_end()
        );
    }
    Ok(())
}

pub(crate) fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}
