//! The decision: from what the machine has and what a command wants to what must be installed.
//!
//! Nothing in here touches the machine, so every machine can be tested on any other.

use std::fmt;
use std::path::PathBuf;

/// What a command wants beyond the cargo that runs it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The emulator of the boards.
    pub qemu: bool,
    /// Compiler, library source and linker for the boards.
    pub firmware: bool,
    /// `cargo fmt` and `cargo clippy`.
    pub lints: bool,
    /// The battery of tests for random numbers.
    pub dieharder: bool,
    /// The debugger of all boards.
    pub gdb: bool,
    /// Wireshark's own decoder of packets.
    pub tshark: bool,
    /// The linker of a machine without rustup.
    pub system_linker: bool,
    /// The compiler of such a machine, with its library's source.
    pub system_compiler: bool,
    /// A compiler for libFuzzer, which is C++.
    pub cxx: bool,
    /// GNU's compiler of C++, for the reference's rival.
    pub gxx: bool,
}

/// A Rust compiler found on the machine, recent enough for this workspace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compiler {
    /// The compiler itself, never a rustup proxy.
    pub rustc: PathBuf,
    /// The cargo that belongs to it.
    pub cargo: PathBuf,
    /// The source of its standard library is there, so `core` can be built for a board.
    pub has_source: bool,
    /// It can lint, so the firmware can be linted with it.
    pub has_clippy: bool,
}

/// Whether rustup can be asked for components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rustup {
    /// The compiler in use is not rustup's.
    Absent,
    /// It is, and rustup has not been asked yet.
    Present,
    /// It was asked and could not add what was wanted.
    Refused,
}

/// How packages can be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Apt {
    /// No `apt-get`: not a Debian.
    Absent,
    /// `apt-get` is there but neither are we root nor is there a `sudo`.
    Forbidden,
    /// `apt-get` as it is.
    AsRoot,
    /// `sudo apt-get`.
    BySudo,
}

/// What a look at the machine found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// `qemu-system-arm`.
    pub qemu: Option<PathBuf>,
    /// `dieharder`.
    pub dieharder: Option<PathBuf>,
    /// `gdb-multiarch`.
    pub gdb: Option<PathBuf>,
    /// `tshark`.
    pub tshark: Option<PathBuf>,
    /// Compilers, the preferred one first.
    pub compilers: Vec<Compiler>,
    /// `rust-lld` or `ld.lld`.
    pub linker: Option<PathBuf>,
    /// `ld.lld`.
    pub system_linker: Option<PathBuf>,
    /// Debian's packages have put a compiler and the source of its library into /usr, recent enough for this workspace.
    pub system_compiler: bool,
    /// `c++`.
    pub cxx: bool,
    /// `g++`.
    pub gxx: Option<PathBuf>,
    /// `cargo fmt` works with the cargo in use.
    pub rustfmt: bool,
    /// `cargo clippy` works with the cargo in use.
    pub clippy: bool,
    /// Rustup.
    pub rustup: Rustup,
    /// Debian's package manager.
    pub apt: Apt,
}

/// The tools a command works with, all of them present.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tools {
    /// The emulator, where it was wanted.
    pub qemu: Option<PathBuf>,
    /// The battery of tests for random numbers, where it was wanted.
    pub dieharder: Option<PathBuf>,
    /// The debugger, where it was wanted.
    pub gdb: Option<PathBuf>,
    /// The linker of a machine without rustup, where it was wanted.
    pub system_linker: Option<PathBuf>,
    /// GNU's compiler of C++, where it was wanted.
    pub gxx: Option<PathBuf>,
    /// What builds the firmware, where it was wanted.
    pub firmware: Option<Toolchain>,
}

/// What builds firmware images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    /// A compiler with its library's source.
    pub compiler: Compiler,
    /// The linker.
    pub linker: PathBuf,
}

/// One command line that changes the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandLine(pub Vec<String>);

impl CommandLine {
    fn new(words: &[&str]) -> Self {
        Self(words.iter().map(|&word| word.to_owned()).collect())
    }
}

impl fmt::Display for CommandLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(" "))
    }
}

/// What to install, and how.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// What is missing, in words for people.
    pub missing: Vec<&'static str>,
    /// Asks rustup first; it may refuse (no network, a toolchain of one's own), then the decision is taken anew.
    pub rustup: Option<CommandLine>,
    /// Debian's packages.
    pub apt: Vec<CommandLine>,
}

impl fmt::Display for Orders {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "set-up: missing here: {}", self.missing.join("; "))?;
        write!(f, "set-up: to be installed with")?;
        for command in self.rustup.iter().chain(&self.apt) {
            write!(f, "\n    {command}")?;
        }
        if self.rustup.is_some() {
            write!(
                f,
                "\n  (where rustup cannot add a component, Debian's packages of it are taken)"
            )?;
        }
        Ok(())
    }
}

/// The outcome of [`decide`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Plan {
    /// Nothing to do.
    Ready(Tools),
    /// Something is missing, and this installs it.
    Install(Orders),
    /// Something is missing, and this machine offers no way to install it.
    ByHand {
        /// What is missing, in words for people.
        missing: Vec<&'static str>,
        /// What to do about it.
        advice: String,
    },
}

const QEMU: &str = "QEMU for Arm (qemu-system-arm)";
const DIEHARDER: &str = "tests for random numbers (dieharder)";
const GDB: &str = "a debugger for Arm (gdb-multiarch)";
const TSHARK: &str = "Wireshark without its windows (tshark)";
const SOURCE: &str = "a Rust compiler with the source of its library (rust-src)";
const LINKER: &str = "a linker for the boards (rust-lld or ld.lld)";
const SYSTEM_LINKER: &str = "the linker of machines without rustup (ld.lld)";
const SYSTEM_COMPILER: &str = "the compiler of machines without rustup (rustc-web)";
const CXX: &str = "a compiler for libFuzzer (c++)";
const GXX: &str = "GNU's compiler of C++ (g++)";
const RUSTFMT: &str = "cargo fmt";
const CLIPPY: &str = "cargo clippy";
const FIRMWARE_CLIPPY: &str = "clippy for the compiler of the boards";

/// One missing thing and where it can come from.
struct Gap {
    name: &'static str,
    component: Option<&'static str>,
    packages: &'static [&'static str],
}

const GAPS: [Gap; 13] = [
    Gap {
        name: QEMU,
        component: None,
        packages: &["qemu-system-arm"],
    },
    Gap {
        name: DIEHARDER,
        component: None,
        packages: &["dieharder"],
    },
    Gap {
        name: GDB,
        component: None,
        packages: &["gdb-multiarch"],
    },
    Gap {
        name: TSHARK,
        component: None,
        packages: &["tshark"],
    },
    Gap {
        name: SOURCE,
        component: Some("rust-src"),
        packages: &["rustc-web", "cargo-web", "rust-web-src"],
    },
    Gap {
        name: LINKER,
        component: None,
        packages: &["lld"],
    },
    Gap {
        name: SYSTEM_LINKER,
        component: None,
        packages: &["lld"],
    },
    Gap {
        name: SYSTEM_COMPILER,
        component: None,
        packages: &["rustc-web", "cargo-web", "rust-web-src"],
    },
    Gap {
        name: CXX,
        component: None,
        packages: &["g++"],
    },
    Gap {
        name: GXX,
        component: None,
        packages: &["g++"],
    },
    Gap {
        name: RUSTFMT,
        component: Some("rustfmt"),
        packages: &["rustfmt-web"],
    },
    Gap {
        name: CLIPPY,
        component: Some("clippy"),
        packages: &["rust-web-clippy"],
    },
    Gap {
        name: FIRMWARE_CLIPPY,
        component: None,
        packages: &["rust-web-clippy"],
    },
];

/// Says what must be installed on a machine with these `facts` for a command that wants `wanted`.
pub fn decide(facts: &Facts, wanted: Wanted) -> Plan {
    let with_source = facts.compilers.iter().find(|compiler| compiler.has_source);
    let lacks_linker = wanted.firmware && facts.linker.is_none();
    let lacks_cxx = wanted.cxx && !facts.cxx;
    let lacks = |name| match name {
        QEMU => wanted.qemu && facts.qemu.is_none(),
        DIEHARDER => wanted.dieharder && facts.dieharder.is_none(),
        GDB => wanted.gdb && facts.gdb.is_none(),
        TSHARK => wanted.tshark && facts.tshark.is_none(),
        SOURCE => wanted.firmware && with_source.is_none(),
        LINKER => lacks_linker,
        SYSTEM_LINKER => wanted.system_linker && facts.system_linker.is_none() && !lacks_linker,
        SYSTEM_COMPILER => wanted.system_compiler && !facts.system_compiler,
        CXX => lacks_cxx,
        GXX => wanted.gxx && facts.gxx.is_none() && !lacks_cxx,
        RUSTFMT => wanted.lints && !facts.rustfmt,
        CLIPPY => wanted.lints && !facts.clippy,
        _ => wanted.lints && wanted.firmware && lacks_second_clippy(facts),
    };
    let gaps: Vec<&Gap> = GAPS.iter().filter(|gap| lacks(gap.name)).collect();
    if !gaps.is_empty() {
        return fill(&gaps, facts);
    }
    let firmware = match (wanted.firmware, with_source, &facts.linker) {
        (true, Some(compiler), Some(linker)) => Some(Toolchain {
            compiler: compiler.clone(),
            linker: linker.clone(),
        }),
        _ => None,
    };
    Plan::Ready(Tools {
        qemu: facts.qemu.clone().filter(|_| wanted.qemu),
        dieharder: facts.dieharder.clone().filter(|_| wanted.dieharder),
        gdb: facts.gdb.clone().filter(|_| wanted.gdb),
        system_linker: facts.system_linker.clone().filter(|_| wanted.system_linker),
        gxx: facts.gxx.clone().filter(|_| wanted.gxx),
        firmware,
    })
}

/// Whether the boards are, or will be, built by Debian's compiler beside the one in use, and that one has no clippy.
fn lacks_second_clippy(facts: &Facts) -> bool {
    match facts.compilers.iter().position(|compiler| compiler.has_source) {
        Some(0) => false,
        Some(second) => !facts.compilers[second].has_clippy,
        None => facts.rustup == Rustup::Refused,
    }
}

/// Chooses between rustup and Debian for every gap.
fn fill(gaps: &[&Gap], facts: &Facts) -> Plan {
    let missing: Vec<&'static str> = gaps.iter().map(|gap| gap.name).collect();
    let (mut components, mut packages) = (Vec::new(), Vec::new());
    for gap in gaps {
        match gap.component {
            Some(component) if facts.rustup == Rustup::Present => components.push(component),
            _ => packages.extend_from_slice(gap.packages),
        }
    }
    let prefix: &[&str] = match (packages.is_empty(), facts.apt) {
        (true, _) | (false, Apt::AsRoot) => &["env", "DEBIAN_FRONTEND=noninteractive"],
        (false, Apt::BySudo) => &["sudo", "env", "DEBIAN_FRONTEND=noninteractive"],
        (false, Apt::Forbidden) => {
            let advice = format!("run as root: apt-get install {}", packages.join(" "));
            return Plan::ByHand { missing, advice };
        }
        (false, Apt::Absent) => {
            let advice = "this is not a Debian, so install them with this system's own means: the programs \
                          qemu-system-arm, gdb-multiarch, tshark, ld.lld, c++, g++ and dieharder in PATH, and the rustup \
                          components rust-src, rustfmt and clippy";
            return Plan::ByHand {
                missing,
                advice: advice.to_owned(),
            };
        }
    };
    let apt_get = |words: &[&str]| CommandLine::new(&[prefix, &["apt-get"], words].concat());
    let mut orders = Orders {
        missing,
        ..Orders::default()
    };
    if !components.is_empty() {
        orders.rustup = Some(CommandLine::new(
            &[&["rustup", "component", "add"], &components[..]].concat(),
        ));
    }
    if !packages.is_empty() {
        let install = [&["install", "--yes", "--no-install-recommends"], &packages[..]].concat();
        orders.apt = vec![apt_get(&["update"]), apt_get(&install)];
    }
    Plan::Install(orders)
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
