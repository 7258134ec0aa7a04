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
    /// Compilers, the preferred one first.
    pub compilers: Vec<Compiler>,
    /// `rust-lld` or `ld.lld`.
    pub linker: Option<PathBuf>,
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
const SOURCE: &str = "a Rust compiler with the source of its library (rust-src)";
const LINKER: &str = "a linker for the boards (rust-lld or ld.lld)";
const RUSTFMT: &str = "cargo fmt";
const CLIPPY: &str = "cargo clippy";
const FIRMWARE_CLIPPY: &str = "clippy for the compiler of the boards";

/// One missing thing and where it can come from.
struct Gap {
    name: &'static str,
    component: Option<&'static str>,
    packages: &'static [&'static str],
}

const GAPS: [Gap; 8] = [
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
    let lacks = |name| match name {
        QEMU => wanted.qemu && facts.qemu.is_none(),
        DIEHARDER => wanted.dieharder && facts.dieharder.is_none(),
        GDB => wanted.gdb && facts.gdb.is_none(),
        SOURCE => wanted.firmware && with_source.is_none(),
        LINKER => wanted.firmware && facts.linker.is_none(),
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
                          qemu-system-arm, gdb-multiarch, ld.lld and dieharder in PATH, and the rustup components \
                          rust-src, rustfmt and clippy";
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
mod tests {
    use super::*;

    const ALL: Wanted = Wanted {
        qemu: true,
        firmware: true,
        lints: true,
        dieharder: false,
        gdb: false,
    };

    fn compiler(at: &str, has_source: bool) -> Compiler {
        Compiler {
            rustc: format!("{at}/rustc").into(),
            cargo: format!("{at}/cargo").into(),
            has_source,
            has_clippy: false,
        }
    }

    /// A Debian with rustup's minimal profile and nothing else.
    fn fresh() -> Facts {
        Facts {
            qemu: None,
            dieharder: None,
            gdb: None,
            compilers: vec![compiler("/rustup", false)],
            linker: Some("/rustup/rust-lld".into()),
            rustfmt: true,
            clippy: true,
            rustup: Rustup::Present,
            apt: Apt::AsRoot,
        }
    }

    fn announced(facts: &Facts, wanted: Wanted) -> String {
        match decide(facts, wanted) {
            Plan::Install(orders) => orders.to_string(),
            other => panic!("expected something to install, got {other:?}"),
        }
    }

    #[test]
    fn a_fresh_machine_gets_the_component_from_rustup_and_the_emulator_from_debian() {
        assert_eq!(
            announced(&fresh(), ALL),
            "set-up: missing here: QEMU for Arm (qemu-system-arm); \
             a Rust compiler with the source of its library (rust-src)\n\
             set-up: to be installed with\n    \
             rustup component add rust-src\n    \
             env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
             env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends qemu-system-arm\n  \
             (where rustup cannot add a component, Debian's packages of it are taken)"
        );
    }

    #[test]
    fn where_rustup_refused_debian_gives_compiler_and_source_together() {
        let facts = Facts {
            rustup: Rustup::Refused,
            ..fresh()
        };
        assert_eq!(
            announced(&facts, ALL),
            "set-up: missing here: QEMU for Arm (qemu-system-arm); \
             a Rust compiler with the source of its library (rust-src); clippy for the compiler of the boards\n\
             set-up: to be installed with\n    \
             env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
             env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends \
             qemu-system-arm rustc-web cargo-web rust-web-src rust-web-clippy"
        );
    }

    #[test]
    fn a_user_gets_sudo_and_a_debian_compiler_gets_its_linker_and_lints() {
        let facts = Facts {
            linker: None,
            rustfmt: false,
            clippy: false,
            rustup: Rustup::Absent,
            apt: Apt::BySudo,
            ..fresh()
        };
        let said = announced(&facts, ALL);
        assert!(said.ends_with(
            "    sudo env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
             sudo env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends qemu-system-arm \
             rustc-web cargo-web rust-web-src lld rustfmt-web rust-web-clippy"
        ));
        assert!(!said.contains("rustup component"));
    }

    #[test]
    fn only_what_is_wanted_is_installed() {
        let facts = fresh();
        let native = Wanted::default();
        assert_eq!(
            decide(&facts, native),
            Plan::Ready(Tools {
                qemu: None,
                dieharder: None,
                gdb: None,
                firmware: None
            })
        );
        let size = Wanted {
            firmware: true,
            ..native
        };
        let said = announced(&facts, size);
        assert!(
            said.contains("rust-src") && !said.contains("qemu") && !said.contains("apt-get"),
            "{said}"
        );
        let battery = Wanted {
            dieharder: true,
            ..native
        };
        assert!(announced(&facts, battery).ends_with("--no-install-recommends dieharder"));
        let debugger = Wanted { gdb: true, ..native };
        assert!(announced(&facts, debugger).ends_with("--no-install-recommends gdb-multiarch"));
    }

    #[test]
    fn a_complete_machine_needs_nothing_and_prefers_the_compiler_in_use() {
        let mut facts = fresh();
        facts.qemu = Some("/usr/bin/qemu-system-arm".into());
        facts.compilers = vec![compiler("/rustup", true), compiler("/usr/bin", true)];
        let Plan::Ready(tools) = decide(&facts, ALL) else {
            panic!("nothing is missing")
        };
        assert_eq!(tools.qemu, facts.qemu);
        assert_eq!(
            tools.firmware.map(|toolchain| toolchain.compiler),
            Some(compiler("/rustup", true))
        );
    }

    #[test]
    fn debians_compiler_is_taken_without_asking_rustup_when_only_it_has_its_source() {
        let mut facts = fresh();
        facts.qemu = Some("/usr/bin/qemu-system-arm".into());
        facts.compilers.push(compiler("/usr/bin", true));
        let render = Wanted { lints: false, ..ALL };
        let Plan::Ready(tools) = decide(&facts, render) else {
            panic!("nothing is missing")
        };
        assert_eq!(
            tools.firmware.map(|toolchain| toolchain.compiler),
            Some(compiler("/usr/bin", true))
        );
        // To lint the boards' code as well, that compiler needs a clippy of its own.
        assert!(announced(&facts, ALL).ends_with("rust-web-clippy"));
        facts.compilers[1].has_clippy = true;
        assert!(matches!(decide(&facts, ALL), Plan::Ready(_)));
    }

    #[test]
    fn without_a_way_to_install_the_missing_things_are_named_with_advice() {
        let facts = Facts {
            apt: Apt::Absent,
            rustup: Rustup::Refused,
            ..fresh()
        };
        let Plan::ByHand { missing, advice } = decide(&facts, ALL) else {
            panic!("nothing can install here")
        };
        assert_eq!(missing, [QEMU, SOURCE, FIRMWARE_CLIPPY]);
        assert!(
            advice.contains("not a Debian") && advice.contains("qemu-system-arm"),
            "{advice}"
        );

        let facts = Facts {
            apt: Apt::Forbidden,
            ..fresh()
        };
        let Plan::ByHand { advice, .. } = decide(&facts, ALL) else {
            panic!("nothing can install here")
        };
        assert_eq!(advice, "run as root: apt-get install qemu-system-arm");
    }

    #[test]
    fn rustup_alone_needs_no_debian() {
        let mut facts = Facts {
            apt: Apt::Absent,
            ..fresh()
        };
        facts.qemu = Some("/opt/qemu-system-arm".into());
        let Plan::Install(orders) = decide(&facts, ALL) else {
            panic!("rustup can add the source")
        };
        assert_eq!(orders.apt, []);
        assert_eq!(
            orders.rustup.map(|command| command.to_string()).as_deref(),
            Some("rustup component add rust-src")
        );
    }
}
