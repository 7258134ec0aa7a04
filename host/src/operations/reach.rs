//! What a function in an image consists of: itself, and everything it calls.

use std::collections::{BTreeMap, BTreeSet};

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// The functions of an image and their code.
#[derive(Debug)]
pub struct Code {
    functions: BTreeMap<u64, Function>,
}

#[derive(Debug)]
struct Function {
    name: String,
    words: Vec<u32>,
}

impl Function {
    /// Whether it begins a panic. What follows is the board's, and no part of an operation.
    fn panics(&self) -> bool {
        self.name.contains("panic")
    }

    fn bytes(&self) -> u64 {
        if self.panics() {
            0
        } else {
            4 * self.words.len() as u64
        }
    }
}

/// A function with all that it calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Bytes of code, each function counted once, and without what a panic does.
    pub bytes: u64,
    /// The functions' symbols.
    pub symbols: Vec<String>,
}

impl Code {
    /// Reads the A32 functions of an ELF file.
    pub fn of(elf: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(elf).map_err(|error| error.to_string())?;
        let functions = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter_map(|symbol| {
                let section = file.section_by_index(symbol.section_index()?).ok()?;
                let code = section.data_range(symbol.address(), symbol.size()).ok()??;
                let (words, _) = code.as_chunks::<4>();
                let function = Function {
                    name: symbol.name().ok()?.to_owned(),
                    words: words.iter().map(|&word| u32::from_le_bytes(word)).collect(),
                };
                Some((symbol.address(), function))
            })
            .collect();
        Ok(Self { functions })
    }

    /// The function at an address, with all that it calls; `None` where no function starts.
    pub fn from(&self, address: u64) -> Option<Reach> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![address]);
        self.functions.get(&address)?;
        while let Some(address) = open.pop() {
            if let Some(function) = self.functions.get(&address)
                && seen.insert(address)
                && !function.panics()
            {
                open.extend(targets(address, &function.words));
            }
        }
        let reached = || seen.iter().filter_map(|address| self.functions.get(address));
        Some(Reach {
            bytes: reached().map(Function::bytes).sum(),
            symbols: reached().map(|function| function.name.clone()).collect(),
        })
    }
}

/// The tables of a crate in an image: symbols and bytes.
pub fn tables(elf: &[u8], crate_name: &str) -> Result<BTreeMap<String, u64>, String> {
    let file = object::File::parse(elf).map_err(|error| error.to_string())?;
    let data = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
    let named = data.filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.size())));
    Ok(named.filter(|(name, _)| name.contains(crate_name)).collect())
}

/// Where a function's branches lead. A constant between the instructions may look like one, but hardly leads to where a
/// function starts.
fn targets(address: u64, words: &[u32]) -> impl Iterator<Item = u64> {
    const BRANCH: u32 = 0b101 << 25;
    const KIND: u32 = 0b111 << 25;
    (address..).step_by(4).zip(words).filter_map(|(at, &word)| {
        // The distance in words from two instructions on, in 24 bits.
        let distance = i64::from((word << 8) as i32 >> 6) + 8;
        (word & KIND == BRANCH).then(|| at.wrapping_add_signed(distance))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_followed_once_each() {
        // At 0: b 8; at 4: bx lr; at 8: bl 0; at 12: bx lr.
        let function = |name: &str, words: &[u32]| Function {
            name: name.to_owned(),
            words: words.to_vec(),
        };
        let code = Code {
            functions: BTreeMap::from([
                (0, function("first", &[0xea00_0000, 0xe12f_ff1e])),
                (8, function("second", &[0xebff_fffc, 0xe12f_ff1e])),
                (16, function("third", &[0xe12f_ff1e])),
            ]),
        };
        let reach = code.from(0).expect("a function");
        assert_eq!(
            (reach.bytes, reach.symbols),
            (16, vec!["first".to_owned(), "second".to_owned()])
        );
        assert_eq!(code.from(16).expect("a function").bytes, 4);
        assert_eq!(code.from(4), None);
    }
}
