//! Ctrl-C, a closed terminal and a polite kill.
//!
//! An interruption ends the program at once, whatever it is at: it says what was written and gives 130. Only who has something to
//! bring to an end first asks for time, as a collection does for its cores and its picture: from [`finish_first`] to
//! [`end_at_once`] an interruption is a flag to be looked at.

use std::collections::BTreeMap;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process, kill_process_group, prlimit};

use crate::platform::console::note;

/// The exit code of a program that was interrupted.
pub const EXIT_CODE: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

static STATE: Mutex<State> = Mutex::new(State {
    manner: Manner::AtOnce(String::new()),
    acts: BTreeMap::new(),
    next: 0,
});

/// What an interruption does.
enum Manner {
    /// Ends the program, which says so and this.
    AtOnce(String),
    /// Sets the flag; a second one ends the program.
    Orderly,
    /// Nothing: it is for the child that has the terminal.
    LeftToChild,
}

struct State {
    manner: Manner,
    /// What is done before the program ends at once.
    acts: BTreeMap<u64, Box<dyn FnMut() + Send>>,
    next: u64,
}

fn state() -> MutexGuard<'static, State> {
    // No code that could panic runs while it is locked, but for last acts, after which nobody asks.
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on an interruption ends the program as this module describes. To be called once.
pub fn watch() -> Result<&'static AtomicBool, ctrlc::Error> {
    ctrlc::set_handler(|| {
        let mut state = state();
        match &state.manner {
            Manner::LeftToChild => {}
            Manner::Orderly if !INTERRUPTED.swap(true, Ordering::Relaxed) => {}
            Manner::Orderly => std::process::exit(EXIT_CODE.into()),
            Manner::AtOnce(_) => end(&mut state),
        }
    })?;
    Ok(flag())
}

/// What an interruption sets where there is something to finish first.
pub fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

/// From now on an interruption is left to the child that has the terminal, and means nothing here.
pub fn leave_to_child() {
    state().manner = Manner::LeftToChild;
}

/// From now on an interruption sets the [`flag`], and a second one ends the program.
pub fn finish_first() {
    state().manner = Manner::Orderly;
}

/// From now on an interruption ends the program at once; so does one that came meanwhile. `written` is for the user: what is
/// there by now, and what is not.
pub fn end_at_once(written: String) {
    let mut state = state();
    state.manner = Manner::AtOnce(written);
    if INTERRUPTED.load(Ordering::Relaxed) {
        end(&mut state);
    }
}

fn end(state: &mut State) -> ! {
    state.acts.values_mut().for_each(|act| act());
    let written = match &state.manner {
        Manner::AtOnce(written) if !written.is_empty() => written,
        _ => "nothing was written",
    };
    note(format!("\nerror: interrupted; {written}"));
    std::process::exit(EXIT_CODE.into())
}

/// Something to be done if the program ends at once while this lives.
pub struct LastAct(u64);

impl LastAct {
    /// Does `act` then. It must be quick, and not panic.
    pub fn new(act: impl FnMut() + Send + 'static) -> Self {
        let mut state = state();
        let number = state.next;
        state.next += 1;
        state.acts.insert(number, Box::new(act));
        Self(number)
    }

    /// Interrupts a child then.
    pub fn interrupts(child: &Child) -> Self {
        Self::by(kill_process, child)
    }

    fn by(kill: fn(Pid, Signal) -> rustix::io::Result<()>, child: &Child) -> Self {
        let process = process(child);
        Self::new(move || {
            // One that has ended already needs no end.
            let _gone = process.map(|process| kill(process, Signal::INT));
        })
    }
}

impl Drop for LastAct {
    fn drop(&mut self) {
        state().acts.remove(&self.0);
    }
}

/// Runs a command that may talk with the user, and is interrupted with this program.
pub fn status(command: &mut Command) -> io::Result<ExitStatus> {
    let mut child = command.spawn()?;
    let _interrupts = LastAct::interrupts(&child);
    child.wait()
}

/// Runs a command for what it says. It and its own children are interrupted with this program.
pub fn output(command: &mut Command) -> io::Result<Output> {
    finish(start(command)?)
}

/// As [`output`], but the system ends the command with SIGXCPU when it has had so many seconds of a processor's time.
pub fn output_within(processor_seconds: u64, command: &mut Command) -> io::Result<Output> {
    let mut child = start(command)?;
    let limit = Rlimit {
        current: Some(processor_seconds),
        // There SIGKILL comes.
        maximum: Some(processor_seconds + 1),
    };
    if let Some(process) = process(&child)
        && let Err(error) = prlimit(Some(process), Resource::Cpu, limit)
    {
        child.kill()?;
        return Err(error.into());
    }
    finish(child)
}

fn start(command: &mut Command) -> io::Result<Child> {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command.process_group(0).spawn()
}

fn finish(child: Child) -> io::Result<Output> {
    let _interrupts = LastAct::by(kill_process_group, &child);
    child.wait_with_output()
}

fn process(child: &Child) -> Option<Pid> {
    i32::try_from(child.id()).ok().and_then(Pid::from_raw)
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::ExitStatusExt;

    use super::*;

    #[test]
    fn a_command_that_never_ends_has_its_time_and_what_it_said_is_kept() {
        const SIGXCPU: i32 = 24;
        let endless = "echo begun; while :; do :; done";
        let output = output_within(1, Command::new("sh").args(["-c", endless])).expect("a shell");
        assert_eq!(output.status.signal(), Some(SIGXCPU));
        assert_eq!(output.stdout, b"begun\n");
    }
}
