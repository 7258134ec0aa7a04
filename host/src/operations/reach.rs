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
    code: Vec<u8>,
}

impl Function {
    /// Whether it begins a panic. What follows is the board's, and no part of an operation.
    fn panics(&self) -> bool {
        self.name.contains("panic")
    }

    fn bytes(&self) -> u64 {
        if self.panics() { 0 } else { self.code.len() as u64 }
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
    /// Reads the functions of an ELF file. An odd address says that a function is Thumb code.
    pub fn of(elf: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(elf).map_err(|error| error.to_string())?;
        let functions = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter_map(|symbol| {
                let section = file.section_by_index(symbol.section_index()?).ok()?;
                let code = section.data_range(symbol.address() & !1, symbol.size()).ok()??;
                let function = Function {
                    name: symbol.name().ok()?.to_owned(),
                    code: code.to_vec(),
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
                open.extend(if address & 1 == 0 {
                    a32_targets(address, &function.code)
                } else {
                    thumb_targets(address, &function.code)
                });
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
fn a32_targets(address: u64, code: &[u8]) -> Vec<u64> {
    const BRANCH: u32 = 0b101 << 25;
    const KIND: u32 = 0b111 << 25;
    let (words, _) = code.as_chunks::<4>();
    let places = (address..).step_by(4).zip(words);
    let targets = places.filter_map(|(at, &word)| {
        let word = u32::from_le_bytes(word);
        // The distance in words from two instructions on, in 24 bits.
        let distance = i64::from((word << 8) as i32 >> 6) + 8;
        (word & KIND == BRANCH).then(|| at.wrapping_add_signed(distance))
    });
    targets.collect()
}

/// As [`a32_targets`], for branches and calls that reach other functions: `B.W` and `BL` (*ARMv7-M Architecture Reference
/// Manual*, ARM DDI 0403E, A7.7.12 and A7.7.18).
fn thumb_targets(address: u64, code: &[u8]) -> Vec<u64> {
    let (halves, _) = code.as_chunks::<2>();
    let half = |index: usize| halves.get(index).map(|&half| u32::from(u16::from_le_bytes(half)));
    let (mut index, mut targets) = (0, Vec::new());
    while let Some(first) = half(index) {
        // These begin an instruction of two halves.
        let is_wide = first >= 0xe800;
        if let (true, 0b11110, Some(second)) = (is_wide, first >> 11, half(index + 1))
            && second & 0x9000 == 0x9000
        {
            let sign = first >> 10 & 1;
            let [i1, i2] = [second >> 13 & 1, second >> 11 & 1].map(|bit| !(bit ^ sign) & 1);
            let distance = sign << 31 | i1 << 30 | i2 << 29 | (first & 0x3ff) << 19 | (second & 0x7ff) << 8;
            // From the instruction after this one, two bytes a step.
            let distance = i64::from(distance as i32 >> 7) + 4;
            targets.push((address + 2 * index as u64).wrapping_add_signed(distance));
        }
        index += 1 + usize::from(is_wide);
    }
    targets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_followed_once_each() {
        // At 0: b 8; at 4: bx lr; at 8: bl 0; at 12: bx lr.
        let function = |name: &str, words: &[u32]| Function {
            name: name.to_owned(),
            code: words.iter().flat_map(|word| word.to_le_bytes()).collect(),
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

    #[test]
    fn thumb_code_has_branches_of_its_own() {
        let code =
            |halves: &[u16]| -> Vec<u8> { halves.iter().flat_map(|half| half.to_le_bytes()).collect() };
        // At 0: nop; bl 0x20; b.w 0x100; bx lr.
        let forth = code(&[0xbf00, 0xf000, 0xf80d, 0xf000, 0xb87b, 0x4770]);
        assert_eq!(thumb_targets(1, &forth), [0x21, 0x101]);
        // At 0x40: bl 0, which is 0x44 back.
        assert_eq!(thumb_targets(0x41, &code(&[0xf7ff, 0xffde])), [1]);
        // movw r0, #0xf000 has a half that looks like a branch's first, but is none.
        assert_eq!(
            thumb_targets(1, &code(&[0xf24f, 0x0000, 0xf800, 0x4770])),
            [0u64; 0]
        );
    }
}
