//! Whose an image's code is: the tracer's, or its frame's (start-up, driver, node, wire, faults).

use std::error::Error;
use std::fs;
use std::path::Path;

use addr2line::{Loader, demangle_auto};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use super::FirmwareError;

/// Where the tracer's sources are.
const TRACER: [&str; 2] = ["firmware/tracer/src/", "fixedmath/src/"];

/// Crates of the tracer, as constants of theirs are named.
const CRATES: [&str; 2] = ["tracer::", "fixedmath::"];

/// Bytes of an image that are the tracer's and the arithmetic's: their code, and constants by their names. Routines of the
/// compiler's library are the frame's.
pub fn tracer_bytes(elf: &Path) -> Result<u64, FirmwareError> {
    let measured = || -> Result<u64, Box<dyn Error>> {
        let bytes = fs::read(elf)?;
        let file = object::File::parse(&bytes[..])?;
        let constants = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
        let ours = constants.filter(|symbol| {
            let name = demangle_auto(symbol.name().unwrap_or_default().into(), None);
            CRATES.iter().any(|of| name.starts_with(of))
        });
        Ok(ours.map(|symbol| symbol.size()).sum())
    };
    let constants = measured().map_err(|error| unreadable(elf, &*error))?;
    Ok(code_bytes(elf, &TRACER)? + constants)
}

/// Bytes of an image's code that come from sources in these folders. By the line tables, every halfword is asked for the functions
/// it is part of: what they call of `core` and have inlined is theirs, and what of them is inlined elsewhere, too.
pub fn code_bytes(elf: &Path, folders: &[&str]) -> Result<u64, FirmwareError> {
    let measured = || -> Result<u64, Box<dyn Error>> {
        let bytes = fs::read(elf)?;
        let file = object::File::parse(&bytes[..])?;
        let text = file.section_by_name(".text").ok_or("it has no code")?;
        let loader = Loader::new(elf)?;
        let mut found = 0;
        for address in (text.address()..text.address() + text.size()).step_by(2) {
            found += if is_from(&loader, address, folders)? { 2 } else { 0 };
        }
        Ok(found)
    };
    measured().map_err(|error| unreadable(elf, &*error))
}

fn unreadable(elf: &Path, error: &dyn Error) -> FirmwareError {
    FirmwareError::Elf {
        path: elf.to_owned(),
        cause: error.to_string(),
    }
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
