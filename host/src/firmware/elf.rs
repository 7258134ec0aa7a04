//! What is in a finished image: whose it is, how much memory it takes, and whether there is floating point in it.

use std::fmt;
use std::path::{Path, PathBuf};
use std::{fs, io};

use object::elf::SHF_ALLOC;
use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionFlags};
use serde::{Deserialize, Serialize};

use super::board::{Board, DTCM_BUDGET, ITCM_BUDGET};

/// An ELF file that is no image of ours.
#[derive(Debug, thiserror::Error)]
#[error("firmware: {} is no image of ours", path.display())]
pub struct ElfError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub fault: ElfFault,
}

/// What is wrong with an ELF file.
#[derive(Debug, thiserror::Error)]
pub enum ElfFault {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// It is none.
    #[error(transparent)]
    Format(#[from] object::Error),
    /// It has no section or symbol of this name.
    #[error("it has no {0}")]
    Without(&'static str),
    /// Its line tables make no sense.
    #[error("its line tables: {0}")]
    Lines(String),
}

impl ElfFault {
    /// The same of the file at `path`.
    pub fn of(self, path: &Path) -> ElfError {
        let path = path.to_owned();
        ElfError { path, fault: self }
    }
}

/// Memory an image takes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageSize {
    /// Instruction memory: code, constants and the first values of data.
    pub itcm_bytes: u64,
    /// Data memory without stacks: data, and the boot block once it is known ([`ImageSize::with_boot_block`]).
    pub dtcm_bytes: u64,
    /// All stacks together.
    pub stack_bytes: u64,
    /// Routines of a floating-point library, of which there must be none.
    pub float_symbols: Vec<String>,
}

impl ImageSize {
    /// The memory it takes with a scene's boot block of `len` bytes.
    pub fn with_boot_block(mut self, len: usize) -> Self {
        self.dtcm_bytes += len as u64;
        self
    }
}

impl fmt::Display for ImageSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (code, data) = (self.itcm_bytes, self.dtcm_bytes + self.stack_bytes);
        write!(
            f,
            "image: {code} of {ITCM_BUDGET} bytes of code memory, {data} of {DTCM_BUDGET} of data memory"
        )
    }
}

/// The board that an image is for: the one whose data memory begins with the image's boot block.
pub fn board_of(elf: &[u8]) -> Result<Board, String> {
    let file = object::File::parse(elf).map_err(|error| error.to_string())?;
    let boot_block = file.symbol_by_name("__boot_block").map(|symbol| symbol.address());
    let mut boards = Board::ALL.into_iter();
    boards
        .find(|board| Some(board.dtcm().start) == boot_block)
        .ok_or_else(|| "it has no boot block where a board of ours looks for one".to_owned())
}

/// The symbol of an image's first line of Rust: the one that its start-up crate calls when memory is in order.
pub fn entry(elf: &Path) -> Result<&'static str, ElfError> {
    /// Of `cortex-m-rt`, and of `aarch32-rt`.
    const NAMES: [&str; 2] = ["main", "kmain"];
    let found = || {
        let bytes = fs::read(elf)?;
        let file = object::File::parse(&bytes[..])?;
        let found = NAMES.into_iter().find(|name| file.symbol_by_name(name).is_some());
        found.ok_or(ElfFault::Without("symbol main or kmain"))
    };
    found().map_err(|fault: ElfFault| fault.of(elf))
}

/// The version of the compiler that made an image, from the comments that compilers and linkers leave: `rustc version 1.96.0 (ac68faa20 2026-05-25)`.
pub fn compiler(elf: &[u8]) -> Option<String> {
    let file = object::File::parse(elf).ok()?;
    let comments = file.section_by_name(".comment")?.data().ok()?;
    let rustc = comments
        .split(|&byte| byte == 0)
        .filter_map(|comment| str::from_utf8(comment).ok()?.strip_prefix("rustc version "))
        .next()?;
    rustc.split(' ').next().map(str::to_owned)
}

/// Measures a board's ELF file. What takes memory of a core is what is loaded there and what its sections reserve.
pub fn measure(board: Board, elf: &[u8]) -> Result<ImageSize, ElfFault> {
    let file = object::File::parse(elf)?;
    let symbol = |name| {
        let found = file.symbol_by_name(name).map(|symbol| symbol.address());
        found.ok_or(ElfFault::Without(name))
    };
    let stacks = symbol("_stacks_low_end")?..symbol("_stacks_high_end")?;
    let mut size = ImageSize {
        stack_bytes: stacks.end.saturating_sub(stacks.start),
        ..ImageSize::default()
    };
    for section in file.sections().filter(is_allocated) {
        let address = section.address();
        if board.dtcm().contains(&address) && !stacks.contains(&address) {
            size.dtcm_bytes += section.size();
        } else if board.itcm().contains(&address) {
            size.itcm_bytes += section.size();
        }
    }
    // The first values of .data lie in instruction memory until start-up copies them.
    size.itcm_bytes += file
        .segments()
        .filter(|segment| board.dtcm().contains(&segment.address()))
        .map(|segment| segment.file_range().1)
        .sum::<u64>();
    let names = file
        .symbols()
        .filter(|symbol| !symbol.is_undefined())
        .filter_map(|symbol| symbol.name().ok());
    size.float_symbols = names
        .filter(|name| is_float_routine(name))
        .map(str::to_owned)
        .collect();
    size.float_symbols.sort_unstable();
    size.float_symbols.dedup();
    Ok(size)
}

fn is_allocated<'d>(section: &impl ObjectSection<'d>) -> bool {
    matches!(section.flags(), SectionFlags::Elf { sh_flags, .. } if sh_flags.contains(SHF_ALLOC))
}

/// Whether a symbol is a routine of a soft-float library, by the names of the ARM run-time ABI and of compilers' own libraries.
fn is_float_routine(name: &str) -> bool {
    if let Some(routine) = name.strip_prefix("__aeabi_") {
        let compares = ["cd", "cf"].iter().any(|start| routine.starts_with(start));
        let computes = routine.starts_with(['d', 'f', 'h']);
        let converts = ["2f", "2d", "2h"].iter().any(|end| routine.contains(end));
        return compares || computes || converts;
    }
    let Some(routine) = name.strip_prefix("__") else {
        return false;
    };
    let routine = routine.trim_end_matches(['2', '3']);
    ["hf", "sf", "df", "tf"]
        .iter()
        .any(|kind| routine.ends_with(kind))
        || [
            "fixsf",
            "fixdf",
            "fixunssf",
            "fixunsdf",
            "floatsi",
            "floatdi",
            "floatunsi",
            "floatundi",
        ]
        .iter()
        .any(|start| routine.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn float_routines_are_told_from_integer_ones() {
        for name in [
            "__aeabi_fadd",
            "__aeabi_dmul",
            "__aeabi_cdcmpeq",
            "__aeabi_cfrcmple",
            "__aeabi_i2f",
            "__aeabi_ul2d",
            "__aeabi_d2iz",
            "__aeabi_h2f",
            "__addsf3",
            "__muldf3",
            "__ltsf2",
            "__fixsfsi",
            "__floatundidf",
            "__extendsfdf2",
        ] {
            assert!(is_float_routine(name), "{name}");
        }
        for name in [
            "__aeabi_idiv",
            "__aeabi_uidivmod",
            "__aeabi_ldivmod",
            "__aeabi_lmul",
            "__aeabi_llsl",
            "__aeabi_memcpy4",
            "__aeabi_unwind_cpp_pr0",
            "__udivsi3",
            "__muldi3",
            "__clzsi2",
            "__boot_block_size",
            "main",
            "_ZN4wire3defE",
        ] {
            assert!(!is_float_routine(name), "{name}");
        }
    }

    #[test]
    fn what_is_no_elf_is_refused() {
        assert!(measure(Board::Versatilepb, b"no ELF at all").is_err());
        let missing = entry(Path::new("no-such.elf")).expect_err("there is no such file");
        assert!(missing.to_string().contains("no-such.elf"), "{missing}");
        // This test's own program is an ELF with a `main`, but no image.
        let own = std::env::current_exe().expect("a program");
        assert_eq!(entry(&own).expect("an ELF"), "main");
        let own = fs::read(own).expect("its bytes");
        assert!(
            measure(Board::Versatilepb, &own)
                .expect_err("not an image")
                .to_string()
                .contains("_stacks_low_end")
        );
    }
}
