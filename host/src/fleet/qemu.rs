//! Cores as QEMU processes.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use super::core::Core;
use super::log::FleetLog;
use super::{Fleet, FleetError, LAST_LINES, Patience, Policy, RESTARTS, RUNNING, unusable};
use crate::firmware::board::Board;
use crate::firmware::plugin::Recorder;
use crate::platform::interrupt;
use crate::platform::memory;
use crate::platform::setup;

/// Time between two looks at the processes' memory, which nobody can ask for once they have ended.
const MEASURE_EVERY: Duration = Duration::from_millis(250);
/// Time between two looks whether a process that is to end has done so.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// How long cores that have been told to end may take for it, with what is written then.
const END_WITHIN: Duration = Duration::from_secs(5);
/// The exit codes of a core that has run into a fault of its program: a panic, and an exception of the processor. They are
/// `runtime::ExitCode`'s; what it says with another code it has thought about, and would say again.
const FAILED: [i32; 2] = [3, 4];
/// How much of the end of a log is read for its last lines.
const TAIL: u64 = 4096;

/// What an image that needs nobody else may take of a processor's time: many times what any of ours takes. One that halts would
/// take all there is.
const PROCESSOR_SECONDS: u64 = 300;

/// Runs an image that needs nobody else on one core, and waits for its end. Its console is the output.
pub fn run_to_end(qemu: &Path, board: Board, elf: &Path) -> io::Result<Output> {
    let mut command = bound_to_this_process(qemu);
    interrupt::output_within(PROCESSOR_SECONDS, command.args(board.command_line(elf, None)))
}

/// As [`run_to_end`], and records its flow of execution.
pub fn run_recorded(qemu: &Path, board: Board, elf: &Path, recorder: &Recorder) -> io::Result<Output> {
    let mut command = bound_to_this_process(qemu);
    command
        .args(board.command_line(elf, None))
        .args(recorder.words(board));
    interrupt::output_within(PROCESSOR_SECONDS, &mut command)
}

/// As [`run_to_end`], with a peer instead of a network: see [`Board::command_line_with_peer`].
pub fn run_with_peer(qemu: &Path, board: Board, elf: &Path, core: u16, peer: u16) -> io::Result<Output> {
    interrupt::output(bound_to_this_process(qemu).args(board.command_line_with_peer(elf, core, peer)))
}

/// One emulated core.
#[derive(Debug)]
struct Guest {
    core: Core,
    files: Files,
    child: Child,
    ended: Option<ExitStatus>,
    restarts: usize,
    peak_memory: u64,
}

impl Guest {
    /// Writes down the process's id.
    fn note_process(&self) -> Result<(), FleetError> {
        let file = &self.files.pid;
        fs::write(file, format!("{}\n", self.child.id())).map_err(unusable(file))
    }
}

/// A core's files in the fleet's folder.
#[derive(Debug)]
struct Files {
    boot: PathBuf,
    log: PathBuf,
    frames: PathBuf,
    pid: PathBuf,
}

impl Files {
    fn new(folder: &Path, core: u16) -> Self {
        let file = |extension| folder.join(format!("core-{core}.{extension}"));
        Self {
            boot: file("boot"),
            log: file("log"),
            frames: file("defmt"),
            pid: file("pid"),
        }
    }
}

/// Cores as QEMU processes. Dropping it kills them, by their ids.
#[derive(Debug)]
pub struct QemuFleet {
    qemu: PathBuf,
    guests: Vec<Guest>,
    measured: Instant,
    log: Option<FleetLog>,
    /// Somebody looks at its cores, which may stand still for any time, and at their ends.
    debugged: bool,
}

impl QemuFleet {
    /// Starts one process a core. `folder` gets, for each core N, `core-N.boot`, its console's `core-N.log`, its
    /// process's id in `core-N.pid`, and the frames of its log in `core-N.defmt`; and `fleet.log`, if any core has a log.
    pub fn start(qemu: &Path, cores: &[Core], folder: &Path) -> Result<Self, FleetError> {
        let mut fleet = Self {
            qemu: qemu.to_owned(),
            guests: Vec::with_capacity(cores.len()),
            measured: Instant::now(),
            log: None,
            debugged: false,
        };
        fs::create_dir_all(folder).map_err(unusable(folder))?;
        if cores.iter().any(|core| core.logs) {
            fleet.log = Some(FleetLog::create(folder.join("fleet.log"))?);
        }
        for core in cores {
            let files = Files::new(folder, core.number);
            fs::write(&files.boot, &core.boot_block).map_err(unusable(&files.boot))?;
            fs::write(&files.log, []).map_err(unusable(&files.log))?;
            if let Some(log) = fleet.log.as_mut().filter(|_| core.logs) {
                log.add(core, &files.frames)?;
            }
            let child = launch(qemu, core, &files, 0)?;
            let guest = Guest {
                core: core.clone(),
                files,
                child,
                ended: None,
                restarts: 0,
                peak_memory: 0,
            };
            // First of all it belongs to the fleet, which ends it, whatever goes wrong from here on.
            fleet.guests.push(guest);
            fleet.guests.last().map_or(Ok(()), Guest::note_process)?;
        }
        Ok(fleet)
    }

    /// The same, whose cores somebody looks at with a debugger: they may stand still for any time, and are not started again.
    pub fn debugged(mut self) -> Self {
        self.debugged = true;
        self
    }

    /// Ends the cores so that their recordings are written, which QEMU does at its own end. Of one that does not end so, there is
    /// none, which tells.
    fn let_recorders_write(&mut self) {
        if self.await_ends(END_WITHIN).is_err() {
            // One that came late to its collector has not been told to stop, and is idle.
            for guest in self.guests.iter().filter(|guest| guest.ended.is_none()) {
                // The only error is that it has ended meanwhile.
                let _gone = kill_process(Pid::from_child(&guest.child), Signal::TERM);
            }
            let _how = self.await_ends(END_WITHIN);
        }
    }

    /// Waits for the ends of cores that have been told to stop, and says how the first ended that did not end well.
    pub fn await_ends(&mut self, within: Duration) -> Result<(), String> {
        let start = Instant::now();
        let running = |fleet: &Self| fleet.guests.iter().any(|guest| guest.ended.is_none());
        while running(self) && start.elapsed() < within {
            self.newly_ended();
            thread::sleep(LOOK_EVERY);
        }
        let ill = |guest: &&Guest| !guest.ended.is_some_and(|status| status.success());
        match self.guests.iter().find(ill) {
            Some(guest) => Err(self.how_ended(guest.core.number)),
            None => Ok(()),
        }
    }

    fn is_recorded(&self) -> bool {
        self.guests.iter().any(|guest| guest.core.recorder.is_some())
    }

    fn guest(&self, core: u16) -> Option<&Guest> {
        self.guests.iter().find(|guest| guest.core.number == core)
    }

    /// The fleet's log, where there is one.
    pub fn log(&self) -> Option<&Path> {
        self.log.as_ref().map(FleetLog::path)
    }

    /// The ids of the processes, core by core.
    pub fn process_ids(&self) -> Vec<u32> {
        self.guests.iter().map(|guest| guest.child.id()).collect()
    }

    fn measure(&mut self) {
        if self.measured.elapsed() < MEASURE_EVERY {
            return;
        }
        self.measured = Instant::now();
        for guest in self.guests.iter_mut().filter(|guest| guest.ended.is_none()) {
            let peak = memory::peak_of(&guest.child.id().to_string());
            guest.peak_memory = guest.peak_memory.max(peak.unwrap_or_default());
        }
    }

    fn kill(&mut self) {
        for guest in &mut self.guests {
            // The only error is that it has ended already.
            let _gone = guest.child.kill();
        }
        for guest in &mut self.guests {
            let _status = guest.child.wait();
        }
    }
}

impl Fleet for QemuFleet {
    fn policy(&self) -> Policy {
        Policy {
            // A recording is of one life.
            restarts: if self.debugged || self.is_recorded() {
                0
            } else {
                RESTARTS
            },
            sees_ends: true,
            patience: if self.debugged {
                Patience::Endless
            } else {
                Patience::WhileTheyLive
            },
        }
    }

    fn newly_ended(&mut self) -> Vec<u16> {
        self.measure();
        let mut ended = Vec::new();
        for guest in &mut self.guests {
            // An error means that the process cannot be asked; silence will tell.
            if guest.ended.is_none()
                && let Ok(Some(status)) = guest.child.try_wait()
            {
                guest.ended = Some(status);
                ended.push(guest.core.number);
            }
        }
        ended
    }

    fn how_ended(&self, core: u16) -> String {
        let Some(status) = self.guest(core).and_then(|guest| guest.ended) else {
            return RUNNING.to_owned();
        };
        match (status.code(), status.signal()) {
            (Some(code), _) => format!("its QEMU ended with code {code}"),
            (None, Some(signal)) => format!("its QEMU was killed by signal {signal}"),
            (None, None) => format!("its QEMU ended ({status})"),
        }
    }

    /// Starts a core that has ended again, if its end leaves hope that the next life is longer.
    ///
    /// A core that has failed may have met with a rare accident, and is started with the same image and boot block, a few times:
    /// its log goes on, and its process has a new id. Not so one that was killed, because somebody wanted that, nor one that gave
    /// up by itself, for want of a network card or of a boot block that it understands: it would do so again.
    fn start_again(&mut self, core: u16) -> Result<bool, FleetError> {
        let restarts = self.policy().restarts;
        let Some(guest) = self.guests.iter_mut().find(|guest| guest.core.number == core) else {
            return Ok(false);
        };
        let failed = |status: ExitStatus| status.code().is_some_and(|code| FAILED.contains(&code));
        if guest.restarts == restarts || !guest.ended.is_some_and(failed) {
            return Ok(false);
        }
        guest.child = launch(&self.qemu, &guest.core, &guest.files, guest.restarts + 1)?;
        guest.ended = None;
        guest.restarts += 1;
        guest.note_process()?;
        Ok(true)
    }

    /// A core's image.
    fn image(&self, core: u16) -> Option<&Path> {
        Some(&self.guest(core)?.core.elf)
    }

    fn last_output(&self, core: u16) -> Vec<String> {
        let Some(guest) = self.guest(core) else {
            return Vec::new();
        };
        let log = &guest.files.log;
        match tail(log) {
            Ok(lines) => lines,
            Err(error) => vec![format!(
                "(its output in {} cannot be read: {error})",
                log.display()
            )],
        }
    }

    fn warnings(&mut self) -> Vec<String> {
        self.log.as_mut().map(FleetLog::look).unwrap_or_default()
    }

    fn end(&mut self) -> Vec<String> {
        if self.is_recorded() {
            self.let_recorders_write();
        }
        self.kill();
        self.log.as_mut().map(FleetLog::end).unwrap_or_default()
    }

    /// The sum of the processes' peak memory in bytes, as last seen.
    fn peak_memory(&self) -> u64 {
        self.guests.iter().map(|guest| guest.peak_memory).sum()
    }
}

impl Drop for QemuFleet {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Starts a core's process, whose console is added to its log, and its frames to those before.
fn launch(qemu: &Path, core: &Core, files: &Files, restarts: usize) -> Result<Child, FleetError> {
    let end_of = |path: &Path| File::options().append(true).open(path).map_err(unusable(path));
    let output = end_of(if core.logs { &files.frames } else { &files.log })?;
    let mut command = bound_to_this_process(qemu);
    command.args(core.command_line(&files.boot, &files.log, restarts));
    command.stdin(Stdio::null());
    command.stdout(output).stderr(end_of(&files.log)?);
    // Ctrl-C is for this process, which then ends its cores in order.
    command.process_group(0);
    let program = qemu.display().to_string();
    command.spawn().map_err(|cause| FleetError::Start {
        core: core.number,
        program,
        cause,
    })
}

/// A command that the kernel kills when this process dies, even of SIGKILL, where util-linux's `setpriv` can arrange it.
pub(crate) fn bound_to_this_process(program: &Path) -> Command {
    match setup::program("setpriv") {
        Some(setpriv) => {
            let mut command = Command::new(setpriv);
            command.args(["--pdeathsig", "KILL", "--"]).arg(program);
            command
        }
        None => Command::new(program),
    }
}

/// The last few lines of a file.
fn tail(path: &Path) -> io::Result<Vec<String>> {
    let mut file = File::open(path)?;
    let len = file.metadata()?.len();
    file.seek(SeekFrom::Start(len.saturating_sub(TAIL)))?;
    let mut bytes = Vec::new();
    file.take(TAIL).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text
        .lines()
        .map(str::trim_end)
        .filter(|line| !line.is_empty())
        .collect();
    let first = lines.len().saturating_sub(LAST_LINES);
    Ok(lines[first..].iter().map(|&line| line.to_owned()).collect())
}

#[cfg(test)]
#[path = "qemu_tests.rs"]
pub(super) mod tests;
