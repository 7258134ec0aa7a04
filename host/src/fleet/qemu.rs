//! Cores as QEMU processes.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};

use super::{FleetError, LAST_LINES};
use crate::board::Board;
use crate::{memory, setup};

/// Time between two looks at the processes' memory, which nobody can ask for once they have ended.
const MEASURE_EVERY: Duration = Duration::from_millis(250);
/// How much of the end of a log is read for its last lines.
const TAIL: u64 = 4096;

/// Runs an image that needs nobody else on one core, and waits for its end. Its console is the output.
pub fn run_to_end(qemu: &Path, board: Board, elf: &Path) -> io::Result<Output> {
    bound_to_this_process(qemu)
        .args(board.command_line(elf, None))
        .stdin(Stdio::null())
        .output()
}

/// As [`run_to_end`], with a peer instead of a network: see [`Board::command_line_with_peer`].
pub fn run_with_peer(qemu: &Path, board: Board, elf: &Path, core: u16, peer: u16) -> io::Result<Output> {
    bound_to_this_process(qemu)
        .args(board.command_line_with_peer(elf, core, peer))
        .stdin(Stdio::null())
        .output()
}

/// A core to be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Core {
    /// The board it is on.
    pub board: Board,
    /// Its image.
    pub elf: PathBuf,
    /// Its boot block.
    pub boot_block: Vec<u8>,
}

/// One emulated core.
#[derive(Debug)]
struct Guest {
    child: Child,
    log: PathBuf,
    ended: Option<ExitStatus>,
    peak_memory: u64,
}

/// Cores as QEMU processes. Dropping it kills them, by their ids.
#[derive(Debug)]
pub struct QemuFleet {
    guests: Vec<Guest>,
    measured: Instant,
}

impl QemuFleet {
    /// Starts one process a core. `folder` gets, for each core N, `core-N.boot`, its console's `core-N.log`, and its
    /// process's id in `core-N.pid`.
    pub fn start(qemu: &Path, cores: &[Core], folder: &Path) -> Result<Self, FleetError> {
        let mut fleet = Self {
            guests: Vec::with_capacity(cores.len()),
            measured: Instant::now(),
        };
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |cause| FleetError::File { path, cause }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        for (number, core) in cores.iter().enumerate() {
            let file = |extension| folder.join(format!("core-{number}.{extension}"));
            let (boot, log, pid) = (file("boot"), file("log"), file("pid"));
            fs::write(&boot, &core.boot_block).map_err(failed(&boot))?;
            let output = File::create(&log).map_err(failed(&log))?;
            let errors = output.try_clone().map_err(failed(&log))?;
            let mut command = bound_to_this_process(qemu);
            command.args(core.board.command_line(&core.elf, Some(&boot)));
            command.stdin(Stdio::null()).stdout(output).stderr(errors);
            // Ctrl-C is for this process, which then ends its cores in order.
            command.process_group(0);
            let program = qemu.display().to_string();
            let child = command.spawn().map_err(|cause| FleetError::Start {
                core: number,
                program,
                cause,
            })?;
            let id = child.id();
            fleet.guests.push(Guest {
                child,
                log,
                ended: None,
                peak_memory: 0,
            });
            fs::write(&pid, format!("{id}\n")).map_err(failed(&pid))?;
        }
        Ok(fleet)
    }

    /// The ids of the processes, core by core.
    pub fn process_ids(&self) -> Vec<u32> {
        self.guests.iter().map(|guest| guest.child.id()).collect()
    }

    /// The sum of the processes' peak memory in bytes, as last seen.
    pub(super) fn peak_memory(&self) -> u64 {
        self.guests.iter().map(|guest| guest.peak_memory).sum()
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

    pub(super) fn newly_ended(&mut self) -> Vec<u16> {
        self.measure();
        let mut ended = Vec::new();
        for (core, guest) in self.guests.iter_mut().enumerate() {
            // An error means that the process cannot be asked; silence will tell.
            if guest.ended.is_none()
                && let Ok(Some(status)) = guest.child.try_wait()
            {
                guest.ended = Some(status);
                ended.extend(u16::try_from(core));
            }
        }
        ended
    }

    pub(super) fn how_ended(&self, core: u16) -> Option<String> {
        let status = self.guests.get(usize::from(core))?.ended?;
        Some(match (status.code(), status.signal()) {
            (Some(code), _) => format!("its QEMU ended with code {code}"),
            (None, Some(signal)) => format!("its QEMU was killed by signal {signal}"),
            (None, None) => format!("its QEMU ended ({status})"),
        })
    }

    pub(super) fn last_output(&self, core: u16) -> Vec<String> {
        let Some(guest) = self.guests.get(usize::from(core)) else {
            return Vec::new();
        };
        match tail(&guest.log) {
            Ok(lines) => lines,
            Err(error) => vec![format!(
                "(its output in {} cannot be read: {error})",
                guest.log.display()
            )],
        }
    }
}

impl Drop for QemuFleet {
    fn drop(&mut self) {
        for guest in &mut self.guests {
            // The only error is that it has ended already.
            let _gone = guest.child.kill();
        }
        for guest in &mut self.guests {
            let _status = guest.child.wait();
        }
    }
}

/// A command that the kernel kills when this process dies, even of SIGKILL, where util-linux's `setpriv` can arrange it.
fn bound_to_this_process(program: &Path) -> Command {
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
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    /// A program that takes QEMU's place.
    fn fake_qemu(folder: &Path, script: &str) -> PathBuf {
        let path = folder.join("fake-qemu");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a script");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("an executable script");
        path
    }

    fn cores<const N: usize>(boot_blocks: [u8; N]) -> [Core; N] {
        boot_blocks.map(|byte| Core {
            board: Board::Versatilepb,
            elf: "x.elf".into(),
            boot_block: vec![byte],
        })
    }

    fn all_ended(fleet: &mut QemuFleet, cores: usize) -> Vec<u16> {
        let (start, mut ended) = (Instant::now(), Vec::new());
        while ended.len() < cores && start.elapsed() < Duration::from_secs(10) {
            ended.extend(fleet.newly_ended());
            std::thread::sleep(Duration::from_millis(5));
        }
        ended
    }

    #[test]
    fn the_end_of_a_core_is_noticed_once_and_told_with_its_last_lines() {
        let folder = tempfile::tempdir().expect("a folder");
        let qemu = fake_qemu(
            folder.path(),
            "for i in 1 2 3 4 5 6 7; do echo line $i; done; echo oh no >&2; exit 3",
        );
        let mut fleet = QemuFleet::start(&qemu, &cores([1, 2]), folder.path()).expect("it starts");
        let mut ended = all_ended(&mut fleet, 2);
        ended.sort_unstable();
        assert_eq!(ended, [0, 1]);
        assert_eq!(fleet.newly_ended(), [0_u16; 0]);
        assert_eq!(fleet.how_ended(1).as_deref(), Some("its QEMU ended with code 3"));
        assert_eq!(
            fleet.last_output(1),
            ["line 4", "line 5", "line 6", "line 7", "oh no"]
        );
        assert_eq!(
            fs::read(folder.path().join("core-1.boot")).expect("a boot block"),
            [2]
        );
    }

    #[test]
    fn dropping_the_fleet_ends_its_processes_and_no_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let qemu = fake_qemu(folder.path(), "exec sleep 60");
        let start =
            |name: &str| QemuFleet::start(&qemu, &cores([1]), &folder.path().join(name)).expect("it starts");
        let (dropped, mut kept) = (start("dropped"), start("kept"));
        let gone = dropped.process_ids()[0];
        drop(dropped);
        assert!(!Path::new(&format!("/proc/{gone}")).exists());
        assert_eq!(kept.newly_ended(), [0_u16; 0]);
    }

    #[test]
    fn a_missing_emulator_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = folder.path().join("no-such-qemu");
        match QemuFleet::start(&missing, &cores([1]), folder.path()) {
            Err(error) => assert!(error.to_string().contains("no-such-qemu"), "{error}"),
            // `setpriv` starts and finds nothing to run.
            Ok(mut fleet) => {
                assert_eq!(all_ended(&mut fleet, 1), [0]);
                assert!(fleet.last_output(0).join(" ").contains("no-such-qemu"));
            }
        }
    }
}
