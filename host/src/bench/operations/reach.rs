//! What a function in an image consists of: itself, everything it calls, and the tables that all this reads.

use std::collections::{BTreeMap, BTreeSet};
use std::iter;

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// The functions of an image with their code, and its tables.
#[derive(Debug)]
pub struct Code {
    functions: BTreeMap<u64, Function>,
    tables: BTreeMap<u64, Table>,
}

/// Data that has a name.
#[derive(Debug)]
struct Table {
    name: String,
    bytes: u64,
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

    /// Where its branches lead, if it stands at `address`.
    fn targets(&self, address: u64) -> Vec<u64> {
        if is_thumb(address) {
            thumb_targets(address, &self.code)
        } else {
            a32_targets(address, &self.code)
        }
    }

    /// What it has as constants, addresses among them.
    fn constants(&self, address: u64) -> Vec<u32> {
        if is_thumb(address) {
            thumb_constants(&self.code)
        } else {
            a32_constants(&self.code)
        }
    }
}

/// An odd address says that a function is Thumb code.
fn is_thumb(address: u64) -> bool {
    address & 1 == 1
}

/// A function with all that it calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Bytes of code, each function counted once, and without what a panic does.
    pub bytes: u64,
    /// The functions' symbols.
    pub symbols: Vec<String>,
    /// Bytes of the tables they read, by the tables' symbols. Constants without a name of their own are not seen.
    pub tables: BTreeMap<String, u64>,
}

impl Code {
    /// Reads the functions and tables of an ELF file.
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
        let tables = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Data && symbol.size() > 0)
            .filter_map(|symbol| {
                let (name, bytes) = (symbol.name().ok()?.to_owned(), symbol.size());
                Some((symbol.address(), Table { name, bytes }))
            })
            .collect();
        Ok(Self { functions, tables })
    }

    /// The function at an address, with all that it calls; `None` where no function starts.
    pub fn from(&self, address: u64) -> Option<Reach> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![address]);
        let mut constants = Vec::new();
        self.functions.get(&address)?;
        while let Some(address) = open.pop() {
            if let Some(function) = self.functions.get(&address)
                && seen.insert(address)
                && !function.panics()
            {
                open.extend(function.targets(address));
                constants.extend(function.constants(address));
            }
        }
        let reached = || seen.iter().filter_map(|address| self.functions.get(address));
        let tables = constants
            .into_iter()
            .filter_map(|constant| self.table_at(constant));
        Some(Reach {
            bytes: reached().map(Function::bytes).sum(),
            symbols: reached().map(|function| function.name.clone()).collect(),
            tables: tables.map(|table| (table.name.clone(), table.bytes)).collect(),
        })
    }

    /// The table that an address lies in.
    fn table_at(&self, address: u32) -> Option<&Table> {
        let (&start, table) = self.tables.range(..=u64::from(address)).next_back()?;
        (u64::from(address) < start + table.bytes).then_some(table)
    }
}

/// Where a function's branches lead; to Thumb code, whose addresses are odd, by `BLX` (*ARM Architecture Reference Manual*, ARM DDI 0100I,
/// A4.1.8). A constant between the instructions may look like one, but hardly leads to where a function starts.
fn a32_targets(address: u64, code: &[u8]) -> Vec<u64> {
    const BRANCH: u32 = 0b101 << 25;
    const KIND: u32 = 0b111 << 25;
    let (words, _) = code.as_chunks::<4>();
    let places = (address..).step_by(4).zip(words);
    let targets = places.filter_map(|(at, &word)| {
        let word = u32::from_le_bytes(word);
        // The distance in words from two instructions on, in 24 bits.
        let distance = i64::from((word << 8) as i32 >> 6) + 8;
        let target = at.wrapping_add_signed(distance);
        let exchanges = word >> 28 == 0xf;
        let half = u64::from(word >> 24 & 1) * 2;
        (word & KIND == BRANCH).then_some(if exchanges { (target + half) | 1 } else { target })
    });
    targets.collect()
}

/// Constants that a function has between its instructions, which may be addresses. An instruction may look like one, but hardly
/// like the address of a table.
fn a32_constants(code: &[u8]) -> Vec<u32> {
    let (words, _) = code.as_chunks::<4>();
    words.iter().map(|&word| u32::from_le_bytes(word)).collect()
}

/// The instructions of Thumb code: where each is, its first half, and its second if it has one.
fn thumb_instructions(code: &[u8]) -> impl Iterator<Item = (u64, u32, Option<u32>)> {
    let (halves, _) = code.as_chunks::<2>();
    let half = |index: usize| halves.get(index).map(|&half| u32::from(u16::from_le_bytes(half)));
    let mut index = 0;
    iter::from_fn(move || {
        let (at, first) = (2 * index as u64, half(index)?);
        // These begin an instruction of two halves.
        let is_wide = first >= 0xe800;
        let second = half(index + 1).filter(|_| is_wide);
        index += 1 + usize::from(is_wide);
        Some((at, first, second))
    })
}

/// As [`a32_targets`], for branches and calls that reach other functions: `B.W` and `BL` (*ARMv7-M Architecture Reference
/// Manual*, ARM DDI 0403E, A7.7.12 and A7.7.18).
fn thumb_targets(address: u64, code: &[u8]) -> Vec<u64> {
    let mut targets = Vec::new();
    for (at, first, second) in thumb_instructions(code) {
        if let (0b11110, Some(second)) = (first >> 11, second)
            && second & 0x9000 == 0x9000
        {
            let sign = first >> 10 & 1;
            let [i1, i2] = [second >> 13 & 1, second >> 11 & 1].map(|bit| !(bit ^ sign) & 1);
            let distance = sign << 31 | i1 << 30 | i2 << 29 | (first & 0x3ff) << 19 | (second & 0x7ff) << 8;
            // From the instruction after this one, two bytes a step.
            let distance = i64::from(distance as i32 >> 7) + 4;
            targets.push((address + at).wrapping_add_signed(distance));
        }
    }
    targets
}

/// As [`a32_constants`], for constants that `MOVW` and `MOVT` put into a register (A7.7.76 and A7.7.79).
fn thumb_constants(code: &[u8]) -> Vec<u32> {
    let (mut low, mut constants) = ([0; 16], Vec::new());
    for (_, first, second) in thumb_instructions(code) {
        let (kind, Some(second)) = (first & 0xfbf0, second) else {
            continue;
        };
        let register = (second >> 8 & 0xf) as usize;
        let half =
            (first & 0xf) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 0b111) << 8 | (second & 0xff);
        match kind {
            0xf240 if second >> 15 == 0 => low[register] = half,
            0xf2c0 if second >> 15 == 0 => constants.push(half << 16 | low[register]),
            _ => {}
        }
    }
    constants
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
            tables: BTreeMap::new(),
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
    fn calls_lead_from_a32_to_thumb() {
        let function = |name: &str, code: &[u8]| Function {
            name: name.to_owned(),
            code: code.to_vec(),
        };
        // At 0: blx 14, and at 4: blx 12, which differ by a half word; at 12 and 14: bx lr.
        let caller = [0xfb00_0001u32, 0xfa00_0000].map(u32::to_le_bytes).concat();
        let code = Code {
            functions: BTreeMap::from([
                (0, function("a32", &caller)),
                (13, function("thumb", &[0x70, 0x47])),
                (15, function("next", &[0x70, 0x47])),
            ]),
            tables: BTreeMap::new(),
        };
        let reach = code.from(0).expect("a function");
        assert_eq!(reach.symbols, ["a32", "thumb", "next"]);
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

    #[test]
    fn tables_are_found_by_the_addresses_that_code_has_of_them() {
        let table = |name: &str| Table {
            name: name.to_owned(),
            bytes: 8,
        };
        // At 0: ldr r0, 8; at 4: bx lr; at 8: an address inside the first table, and the one after it.
        let words: [u32; 4] = [0xe59f_0000, 0xe12f_ff1e, 0x1004, 0x1008];
        let function = Function {
            name: "reader".to_owned(),
            code: words.iter().flat_map(|word| word.to_le_bytes()).collect(),
        };
        let code = Code {
            functions: BTreeMap::from([(0, function)]),
            tables: BTreeMap::from([(0x1000, table("read")), (0x100c, table("other"))]),
        };
        let reach = code.from(0).expect("a function");
        assert_eq!(reach.tables, BTreeMap::from([("read".to_owned(), 8)]));
    }

    #[test]
    fn thumb_code_has_its_constants_in_two_halves() {
        let code =
            |halves: &[u16]| -> Vec<u8> { halves.iter().flat_map(|half| half.to_le_bytes()).collect() };
        // movw r1, #0x6a54; movw r0, #0x8fff; movt r1, #0x2000; movt r0, #0.
        let loads = code(&[0xf646, 0x2154, 0xf648, 0x70ff, 0xf2c2, 0x0100, 0xf2c0, 0x0000]);
        assert_eq!(thumb_constants(&loads), [0x2000_6a54, 0x8fff]);
    }
}
