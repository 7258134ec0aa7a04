//! What stands at the addresses that ran: the functions an instruction is part of, and its line.

use std::collections::HashMap;
use std::path::Path;

use crate::firmware::ElfError;
use crate::firmware::symbols::Symbols;

/// A function's name, by its place among all names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Name(usize);

/// The functions of an instruction, and its line.
#[derive(Clone, Debug, Default)]
struct Place {
    /// Outermost first; never empty.
    functions: Vec<Name>,
    line: String,
}

/// An image's code, as far as it ran.
#[derive(Debug, Default)]
pub(super) struct Code {
    names: Vec<String>,
    places: HashMap<u32, Place>,
}

/// What is said of a place that the image's tables do not know.
const UNKNOWN: &str = "(unknown)";

impl Code {
    /// Looks these addresses up in an image.
    pub(super) fn of(elf: &Path, addresses: impl Iterator<Item = u32>) -> Result<Self, ElfError> {
        let symbols = Symbols::of(elf)?;
        let mut code = Self::default();
        let mut known = HashMap::new();
        for address in addresses {
            if code.places.contains_key(&address) {
                continue;
            }
            let frames = symbols.frames(address)?;
            // What a library's function does, a line of ours wants.
            let ours = frames.iter().filter(|frame| frame.ours);
            let line = ours.chain(&frames).find_map(|frame| frame.line.clone());
            let mut functions: Vec<Name> = Vec::with_capacity(frames.len());
            for frame in frames.into_iter().rev() {
                functions.push(code.name(&mut known, frame.function));
            }
            if functions.is_empty() {
                functions.push(code.name(&mut known, UNKNOWN.to_owned()));
            }
            let line = line.unwrap_or_else(|| UNKNOWN.to_owned());
            code.places.insert(address, Place { functions, line });
        }
        Ok(code)
    }

    fn name(&mut self, known: &mut HashMap<String, Name>, name: String) -> Name {
        *known.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            Name(self.names.len() - 1)
        })
    }

    /// Whether an address ran, and was looked up.
    pub(super) fn knows(&self, address: u32) -> bool {
        self.places.contains_key(&address)
    }

    /// The functions that the instruction at an address that ran is part of, outermost first.
    ///
    /// # Panics
    /// If the address was not looked up.
    pub(super) fn functions(&self, address: u32) -> &[Name] {
        &self.places[&address].functions
    }

    /// The function of the image that an address is in.
    pub(super) fn outermost(&self, address: u32) -> Name {
        self.functions(address)[0]
    }

    /// File and line of the instruction's source, the innermost that is ours.
    pub(super) fn line(&self, address: u32) -> &str {
        &self.places[&address].line
    }

    /// A name in words.
    pub(super) fn word(&self, name: Name) -> &str {
        &self.names[name.0]
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Code whose every address has these functions, outermost first, as in `a > b`, and the line `LAST:ADDRESS`.
    pub(in super::super) fn code(places: &[(u32, &str)]) -> Code {
        let (mut code, mut known) = (Code::default(), HashMap::new());
        for &(address, functions) in places {
            let functions: Vec<&str> = functions.split(" > ").collect();
            let line = format!("{}.rs:{address}", functions[functions.len() - 1]);
            let functions = functions
                .into_iter()
                .map(|name| code.name(&mut known, name.to_owned()))
                .collect();
            code.places.insert(address, Place { functions, line });
        }
        code
    }
}
