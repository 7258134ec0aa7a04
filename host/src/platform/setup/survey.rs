//! The look at the machine: file checks, and one or two quick calls of a compiler.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::plan::{Apt, Compiler, Facts, Rustup};

/// Where Debian's packages put their compiler, whatever PATH says.
const DEBIAN_SYSROOT: &str = "/usr";
/// The oldest compiler this workspace builds with.
const OLDEST: &str = env!("CARGO_PKG_RUST_VERSION");

/// Looks at the machine. Every program that is not found is simply not among the facts.
pub fn survey() -> Facts {
    let in_use = sysroot_in_use();
    let mut sysroots: Vec<PathBuf> = in_use.iter().cloned().collect();
    let debian = PathBuf::from(DEBIAN_SYSROOT);
    let system_compiler = has_source(&debian) && is_recent(&debian);
    let in_use_has_source = in_use.as_deref().is_some_and(has_source);
    // The cargo that runs this has already checked the version of the compiler in use; Debian's own may be years old.
    if !in_use_has_source && !sysroots.contains(&debian) && system_compiler {
        sysroots.push(debian);
    }
    let system_linker = program("ld.lld");
    Facts {
        qemu: program("qemu-system-arm"),
        dieharder: program("dieharder"),
        gdb: program("gdb-multiarch"),
        tshark: program("tshark"),
        linker: sysroots
            .iter()
            .find_map(|sysroot| bundled_linker(sysroot))
            .or_else(|| system_linker.clone()),
        system_linker,
        system_compiler,
        cxx: program("c++").is_some(),
        gxx: program("g++"),
        rustfmt: in_use
            .as_deref()
            .is_some_and(|sysroot| sysroot.join("bin/cargo-fmt").is_file()),
        clippy: in_use.as_deref().is_some_and(has_clippy),
        rustup: if in_use.as_deref().is_some_and(is_rustups) {
            Rustup::Present
        } else {
            Rustup::Absent
        },
        apt: apt(),
        compilers: sysroots.iter().map(|sysroot| compiler(sysroot)).collect(),
    }
}

fn compiler(sysroot: &Path) -> Compiler {
    Compiler {
        rustc: sysroot.join("bin/rustc"),
        cargo: sysroot.join("bin/cargo"),
        has_source: has_source(sysroot),
        has_clippy: has_clippy(sysroot),
    }
}

fn has_source(sysroot: &Path) -> bool {
    sysroot
        .join("lib/rustlib/src/rust/library/core/src/lib.rs")
        .is_file()
}

fn has_clippy(sysroot: &Path) -> bool {
    sysroot.join("bin/cargo-clippy").is_file()
}

/// A toolchain that rustup installed lists its components.
fn is_rustups(sysroot: &Path) -> bool {
    sysroot.join("lib/rustlib/components").is_file() && program("rustup").is_some()
}

/// `rust-lld` lies in a folder named after the host's target.
fn bundled_linker(sysroot: &Path) -> Option<PathBuf> {
    let targets = fs::read_dir(sysroot.join("lib/rustlib")).ok()?;
    targets
        .filter_map(Result::ok)
        .map(|target| target.path().join("bin/rust-lld"))
        .find(|path| path.is_file())
}

fn sysroot_in_use() -> Option<PathBuf> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    first_line_of(&rustc, &["--print", "sysroot"]).map(PathBuf::from)
}

fn is_recent(sysroot: &Path) -> bool {
    // "rustc 1.96.0 (ac68faa20 2026-05-25)"
    let said = first_line_of(sysroot.join("bin/rustc").as_os_str(), &["--version"]);
    said.as_deref()
        .and_then(|line| line.split(' ').nth(1))
        .is_some_and(|version| at_least(version, OLDEST))
}

/// Compares `major.minor`; what follows them does not matter.
fn at_least(version: &str, oldest: &str) -> bool {
    let parts = |text: &str| -> Option<(u32, u32)> {
        let mut numbers = text.split('.').map(str::parse);
        Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
    };
    match (parts(version), parts(oldest)) {
        (Some(version), Some(oldest)) => version >= oldest,
        _ => false,
    }
}

fn apt() -> Apt {
    if program("apt-get").is_none() {
        Apt::Absent
    } else if is_root() {
        Apt::AsRoot
    } else if program("sudo").is_some() {
        Apt::BySudo
    } else {
        Apt::Forbidden
    }
}

/// Linux says the effective user in `/proc`; where that cannot be read, assume an ordinary one.
fn is_root() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let uids = status.lines().find_map(|line| line.strip_prefix("Uid:"));
    uids.and_then(|uids| uids.split_whitespace().nth(1)) == Some("0")
}

/// The program of this name in PATH.
pub fn program(name: &str) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|path| path.is_file())
}

fn first_line_of(program: &OsStr, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .args(arguments)
        .stderr(Stdio::null())
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.lines().next().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_compare_as_numbers() {
        assert!(at_least("1.96.0", "1.95"));
        assert!(at_least("1.100.0", "1.95"));
        assert!(at_least("1.95.0-nightly", "1.95"));
        assert!(!at_least("1.63.0", "1.95"));
        assert!(!at_least("", "1.95"));
    }

    #[test]
    fn a_sysroot_is_judged_by_its_files() {
        let sysroot = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str| {
            let path = sysroot.path().join(name);
            fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            fs::write(path, "").expect("a file");
        };
        assert!(!has_source(sysroot.path()) && !has_clippy(sysroot.path()));
        assert_eq!(bundled_linker(sysroot.path()), None);
        file("lib/rustlib/src/rust/library/core/src/lib.rs");
        file("lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld");
        file("bin/cargo-clippy");
        assert!(has_source(sysroot.path()) && has_clippy(sysroot.path()));
        let linker = bundled_linker(sysroot.path()).expect("the linker");
        assert!(linker.ends_with("x86_64-unknown-linux-gnu/bin/rust-lld"));
    }

    #[test]
    fn the_compiler_that_runs_this_test_is_found() {
        let facts = survey();
        assert!(
            facts
                .compilers
                .first()
                .is_some_and(|compiler| compiler.rustc.is_file())
        );
    }
}
