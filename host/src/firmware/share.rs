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

/// Bytes of an image that are the tracer's and the arithmetic's. By the line tables, every halfword of code is asked for the
/// functions it is part of: what the tracer calls of `core` and has inlined is its own, and what of it is inlined elsewhere, too.
/// Constants count by their names; routines of the compiler's library are the frame's.
pub fn tracer_bytes(elf: &Path) -> Result<u64, FirmwareError> {
    let failed = |cause: String| FirmwareError::Elf {
        path: elf.to_owned(),
        cause,
    };
    let bytes = fs::read(elf).map_err(|error| failed(error.to_string()))?;
    let file = object::File::parse(&bytes[..]).map_err(|error| failed(error.to_string()))?;
    let loader = Loader::new(elf).map_err(|error| failed(error.to_string()))?;
    let text = file
        .section_by_name(".text")
        .ok_or_else(|| failed("it has no code".to_owned()))?;
    let mut found = 0;
    for address in (text.address()..text.address() + text.size()).step_by(2) {
        if is_tracer(&loader, address).map_err(|error| failed(error.to_string()))? {
            found += 2;
        }
    }
    let constants = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
    let ours = constants.filter(|symbol| {
        let name = demangle_auto(symbol.name().unwrap_or_default().into(), None);
        CRATES.iter().any(|of| name.starts_with(of))
    });
    Ok(found + ours.map(|symbol| symbol.size()).sum::<u64>())
}

fn is_tracer(loader: &Loader, address: u64) -> Result<bool, Box<dyn Error>> {
    let mut frames = loader.find_frames(address)?;
    while let Some(frame) = frames.next()? {
        let file = frame.location.and_then(|location| location.file);
        if file.is_some_and(|file| TRACER.iter().any(|of| file.contains(of))) {
            return Ok(true);
        }
    }
    Ok(false)
}
