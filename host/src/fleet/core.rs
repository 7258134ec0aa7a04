//! What is told to an emulator about its core.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::firmware::board::{self, Board};
use crate::firmware::plugin::Recorder;

/// A core to be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Core {
    /// Its number in the session.
    pub number: u16,
    /// The board it is on.
    pub board: Board,
    /// Its image.
    pub elf: PathBuf,
    /// Its boot block.
    pub boot_block: Vec<u8>,
    /// Whether its image has a log.
    pub logs: bool,
    /// Where its packets are recorded, if anywhere; those of later lives beside it, see [`capture_of`].
    pub capture: Option<PathBuf>,
    /// The TCP port on which it waits for a debugger before its first instruction, if for any.
    pub debugger: Option<u16>,
    /// What of its execution is recorded, if anything.
    pub recorder: Option<Recorder>,
}

impl Core {
    /// A core that nobody looks into.
    pub fn new(number: u16, board: Board, elf: &Path, boot_block: Vec<u8>) -> Self {
        Self {
            number,
            board,
            elf: elf.to_owned(),
            boot_block,
            logs: false,
            capture: None,
            debugger: None,
            recorder: None,
        }
    }

    /// QEMU's arguments for it, with its boot block's file and its console's.
    pub(super) fn command_line(&self, boot: &Path, log: &Path, restarts: usize) -> Vec<OsString> {
        let mut words = self.board.command_line(&self.elf, Some(boot));
        if self.logs {
            words.extend(self.board.log_to_stdout(log));
        }
        if let Some(first) = &self.capture {
            words.extend(board::capture_to(&capture_of(first, restarts)));
        }
        words.extend(
            self.recorder
                .iter()
                .flat_map(|recorder| recorder.words(self.board)),
        );
        words.extend(self.debugger.into_iter().flat_map(board::wait_for_debugger));
        words
    }
}

/// The capture file of a core that has been started again so many times, if `first` is that of its first life. QEMU begins a file
/// anew, and the earlier packets are worth keeping.
pub fn capture_of(first: &Path, restarts: usize) -> PathBuf {
    match restarts {
        0 => first.to_owned(),
        _ => first.with_extension(format!("{}.pcap", restarts + 1)),
    }
}
