//! Whose an image's code is: the tracer's, or its frame's (start-up, driver, node, wire, faults).

use std::error::Error;
use std::fs;
use std::path::Path;

use addr2line::{Loader, demangle_auto};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use super::elf::{ElfError, ElfFault};

/// Where the tracer's sources are.
const TRACER: [&str; 2] = ["firmware/tracer/src/", "fixedmath/src/"];

/// Crates of the tracer, as constants of theirs are named.
const CRATES: [&str; 2] = ["tracer::", "fixedmath::"];

/// Bytes of an image that are the tracer's and the arithmetic's: their code, and constants by their names. Routines of the
/// compiler's library are the frame's.
pub fn tracer_bytes(elf: &Path) -> Result<u64, ElfError> {
    let constants = constants(elf).map_err(|fault| fault.of(elf))?;
    Ok(code_bytes(elf, &TRACER)? + constants)
}

fn constants(elf: &Path) -> Result<u64, ElfFault> {
    let bytes = fs::read(elf)?;
    let file = object::File::parse(&bytes[..])?;
    let constants = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
    let ours = constants.filter(|symbol| {
        let name = demangle_auto(symbol.name().unwrap_or_default().into(), None);
        CRATES.iter().any(|of| name.starts_with(of))
    });
    Ok(ours.map(|symbol| symbol.size()).sum())
}

/// Bytes of an image's code that come from sources in these folders. By the line tables, every halfword is asked for the functions
/// it is part of: what they call of `core` and have inlined is theirs, and what of them is inlined elsewhere, too.
pub fn code_bytes(elf: &Path, folders: &[&str]) -> Result<u64, ElfError> {
    let measured = || {
        let bytes = fs::read(elf)?;
        let file = object::File::parse(&bytes[..])?;
        let text = file.section_by_name(".text");
        let text = text.ok_or(ElfFault::Without("section .text"))?;
        let loader = Loader::new(elf).map_err(|error| ElfFault::Lines(error.to_string()))?;
        let mut found = 0;
        for address in (text.address()..text.address() + text.size()).step_by(2) {
            let ours =
                is_from(&loader, address, folders).map_err(|error| ElfFault::Lines(error.to_string()))?;
            found += if ours { 2 } else { 0 };
        }
        Ok(found)
    };
    measured().map_err(|fault: ElfFault| fault.of(elf))
}

fn is_from(loader: &Loader, address: u64, folders: &[&str]) -> Result<bool, Box<dyn Error>> {
    let mut frames = loader.find_frames(address)?;
    while let Some(frame) = frames.next()? {
        let file = frame.location.and_then(|location| location.file);
        if file.is_some_and(|file| folders.iter().any(|of| file.contains(of))) {
            return Ok(true);
        }
    }
    Ok(false)
}
