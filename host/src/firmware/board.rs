//! The boards that the firmware exists for, and all that the host has to know of each.
//!
//! A board is a crate of its name in `firmware/`, an image format, and a machine of QEMU's. Whoever adds one adds it here;
//! `docs/porting.md` says what else.

use std::ffi::OsString;
use std::ops::Range;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::Path;

use cycles::flow::Isa;

/// Usable bytes of instruction memory: code, constants and first values.
pub const ITCM_BUDGET: u64 = 0x7F00;
/// Usable bytes of data memory: boot block, data and stacks.
pub const DTCM_BUDGET: u64 = 0xF800;

/// Instructions in a tick of the cores' clocks of 24 MHz, where an instruction is a nanosecond.
pub const INSTRUCTIONS_PER_TICK: f64 = 1000.0 / 24.0;

/// QEMU's name for the network that a board's card is in.
const NETWORK: &str = "net";

/// A board the firmware exists for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, clap::ValueEnum)]
pub enum Board {
    /// ARMv5TE, an ARM946E-S on QEMU.
    #[default]
    Versatilepb,
    /// Cortex-M3 on QEMU.
    #[value(name = "mps2-an385")]
    Mps2An385,
}

/// What tells a board from another.
struct Traits {
    name: &'static str,
    processor: &'static str,
    target: &'static str,
    isa: Isa,
    itcm: Range<u64>,
    dtcm: Range<u64>,
    machine: &'static [&'static str],
    /// What puts its log on QEMU's standard output, where that is not so anyway.
    log: &'static [&'static str],
    card: &'static str,
}

const VERSATILEPB: Traits = Traits {
    name: "versatilepb",
    processor: "an ARMv5TE core",
    target: "armv5te-none-eabi",
    isa: Isa::Arm,
    itcm: 0..0x8000,
    dtcm: 0x0040_0000..0x0041_0000,
    machine: &[
        "-M",
        "versatilepb",
        "-cpu",
        "arm946",
        "-m",
        "64",
        // Of the board's sound chip, which would otherwise complain on the console.
        "-audiodev",
        "none,id=a",
        "-global",
        "pl041.audiodev=a",
    ],
    // The second serial port.
    log: &["-serial", "stdio"],
    card: "smc91c111",
};

const MPS2_AN385: Traits = Traits {
    name: "mps2-an385",
    processor: "a Cortex-M3",
    target: "thumbv7m-none-eabi",
    isa: Isa::Thumb,
    itcm: 0..0x8000,
    dtcm: 0x2000_0000..0x2001_0000,
    machine: &["-M", "mps2-an385"],
    // Semihosting writes there.
    log: &[],
    card: "lan9118",
};

impl Board {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Versatilepb, Self::Mps2An385];

    const fn traits(self) -> &'static Traits {
        match self {
            Self::Versatilepb => &VERSATILEPB,
            Self::Mps2An385 => &MPS2_AN385,
        }
    }

    /// The name used by `--board` and in reports; the board's crate has it, too.
    pub const fn name(self) -> &'static str {
        self.traits().name
    }

    /// Its processor, for people.
    pub const fn processor(self) -> &'static str {
        self.traits().processor
    }

    /// The compiler's name for its processor.
    pub const fn target(self) -> &'static str {
        self.traits().target
    }

    /// The instruction set that its images are in.
    pub const fn isa(self) -> Isa {
        self.traits().isa
    }

    /// The addresses of instruction memory.
    pub fn itcm(self) -> Range<u64> {
        self.traits().itcm.clone()
    }

    /// The addresses of data memory, where the boot block comes first.
    pub fn dtcm(self) -> Range<u64> {
        self.traits().dtcm.clone()
    }

    /// The arguments that make QEMU this board, running `elf` with the boot block in file `boot`.
    ///
    /// One instruction is one virtual nanosecond (`-icount shift=0`): the core's clock counts instructions.
    pub fn command_line(self, elf: &Path, boot: Option<&Path>) -> Vec<OsString> {
        self.command_line_in("user", elf, boot)
    }

    /// As [`Board::command_line`], but with one peer instead of a network: whatever frame the core sends arrives as a datagram at
    /// the UDP port `peer` of this host, and whatever arrives at the port `core` is a frame for it.
    pub fn command_line_with_peer(self, elf: &Path, core: u16, peer: u16) -> Vec<OsString> {
        let network = format!("socket,udp=127.0.0.1:{peer},localaddr=127.0.0.1:{core}");
        self.command_line_in(&network, elf, None)
    }

    fn command_line_in(self, network: &str, elf: &Path, boot: Option<&Path>) -> Vec<OsString> {
        let Traits { machine, card, .. } = self.traits();
        let card = format!("{network},id={NETWORK},model={card}");
        let shared = ["-nographic", "-semihosting", "-icount", "shift=0", "-nic", &card];
        let words = machine.iter().chain(&shared).map(OsString::from);
        let mut arguments: Vec<OsString> = words.collect();
        if let Some(boot) = boot {
            let address = self.traits().dtcm.start;
            let loader = format!("loader,addr={address:#x},force-raw=on,file=");
            arguments.extend(["-device".into(), with_path(&loader, boot)]);
        }
        arguments.extend(["-kernel".into(), elf.into()]);
        arguments
    }

    /// The words that put the frames of a board's log on QEMU's standard output, and its console at the end of a file.
    pub fn log_to_stdout(self, console: &Path) -> Vec<OsString> {
        let console = with_path("file,id=console,append=on,path=", console);
        let mut words: Vec<OsString> = vec!["-chardev".into(), console];
        let others = ["-serial", "chardev:console", "-monitor", "none"].iter();
        words.extend(others.chain(self.traits().log).map(OsString::from));
        words
    }
}

/// The words that make QEMU record the packets of a board's network card in `file`, as Wireshark reads them.
pub fn capture_to(file: &Path) -> [OsString; 2] {
    let dump = format!("filter-dump,id=capture,netdev={NETWORK},file=");
    ["-object".into(), with_path(&dump, file)]
}

/// The words that make QEMU wait for a debugger on a TCP port of this host before the first instruction.
pub fn wait_for_debugger(port: u16) -> [OsString; 3] {
    ["-S".into(), "-gdb".into(), format!("tcp:127.0.0.1:{port}").into()]
}

/// One of QEMU's options with a path as its last value, which would end at a comma unless that is doubled. Any other byte is itself.
pub(super) fn with_path(option: &str, path: &Path) -> OsString {
    let mut bytes = option.as_bytes().to_vec();
    for &byte in path.as_os_str().as_bytes() {
        bytes.push(byte);
        if byte == b',' {
            bytes.push(byte);
        }
    }
    OsString::from_vec(bytes)
}

impl serde::Serialize for Board {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl std::fmt::Display for Board {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::OsStr;

    use super::*;

    #[test]
    fn a_path_reaches_qemu_byte_by_byte_but_for_commas_which_are_doubled() {
        let path = Path::new(OsStr::from_bytes(b"-a,b %d\n\xff/file"));
        let option = |start: &str| OsString::from_vec([start.as_bytes(), b"-a,,b %d\n\xff/file"].concat());
        let words = Board::Versatilepb.command_line(Path::new("image.elf"), Some(path));
        let loader = option("loader,addr=0x400000,force-raw=on,file=");
        assert!(words.contains(&loader), "{words:?}");
        let words = Board::Versatilepb.log_to_stdout(path);
        let console = option("file,id=console,append=on,path=");
        assert!(words.contains(&console), "{words:?}");
        let dump = option("filter-dump,id=capture,netdev=net,file=");
        assert_eq!(capture_to(path)[1], dump);
    }

    #[test]
    fn every_board_names_its_machine_its_card_and_its_image() {
        for board in Board::ALL {
            let words = board.command_line(Path::new("image.elf"), None);
            assert!(words.contains(&OsString::from(board.name())), "{words:?}");
            assert_eq!(words.last(), Some(&OsString::from("image.elf")));
        }
    }
}
