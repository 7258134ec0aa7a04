//! What a Thumb-2 instruction costs on a Cortex-M3.

use crate::class::Class;
use crate::flow::Instruction;
use crate::pipeline::{Range, Timing, bit, field};

/// The program counter, the link register and the stack pointer.
const PC: u32 = 15;
const LR: u32 = 14;
const SP: u32 = 13;

/// Cycles until the pipeline is full again after a jump.
const REFILL: Range = Range::new(1, 2, 3);
/// A product of 64 bits, by the size of its factors; the same with an addend; and a quotient.
const LONG: Range = Range::new(3, 4, 5);
const LONG_SUM: Range = Range::new(4, 6, 7);
const QUOTIENT: Range = Range::new(2, 7, 12);
/// An address in the code may have to wait for the fetch unit.
const LITERAL: Range = Range::new(2, 2, 3);

/// The timings of a block.
pub(super) fn decode(instructions: &[Instruction]) -> Vec<Timing> {
    let mut governed = 0;
    let mut narrow_before = false;
    let mut timings = Vec::with_capacity(instructions.len());
    for instruction in instructions {
        let word = instruction.encoding;
        let narrow = instruction.bytes == 2;
        let mut timing = if narrow {
            short(word)
        } else {
            long(word >> 16, word & 0xffff)
        };
        if let Some(count) = governs(instruction) {
            governed = count;
            // It is folded into a narrow instruction before it.
            timing.cycles = Range::new(0, if narrow_before { 0 } else { 1 }, 1);
        } else if governed > 0 {
            governed -= 1;
            timing.conditional = true;
        }
        narrow_before = narrow;
        timings.push(timing);
    }
    timings
}

/// How many instructions an `IT` governs.
fn governs(instruction: &Instruction) -> Option<u32> {
    let mask = instruction.encoding & 15;
    let is_it = instruction.bytes == 2 && instruction.encoding >> 8 == 0xbf && mask != 0;
    is_it.then(|| 4 - mask.trailing_zeros())
}

fn alu(to: u32, reads: u16) -> Timing {
    Timing::new(Class::Alu, 1, reads, bit(to))
}

/// An instruction that writes no register.
const fn plain(class: Class) -> Timing {
    Timing::new(class, 1, 0, 0)
}

fn jump(cycles: u32) -> Timing {
    Timing::branch(Range::exactly(cycles).plus(REFILL), 0)
}

fn may_jump(cycles: u32) -> Timing {
    Timing {
        conditional: true,
        ..jump(cycles)
    }
}

/// A load of a register from an address that these registers make.
fn load(to: u32, cycles: Range, address: u16) -> Timing {
    if to == PC {
        return Timing::branch(cycles.plus(REFILL), address);
    }
    Timing {
        cycles,
        late: vec![(to, 0)],
        ..Timing::new(Class::Load, 2, address, 0)
    }
}

/// Loads or stores of many registers.
fn many(loads: bool, list: u16, base: u16) -> Timing {
    let cycles = 1 + list.count_ones();
    match loads {
        true if list & bit(PC) != 0 => Timing::branch(Range::exactly(cycles).plus(REFILL), base),
        true => Timing::new(Class::Load, cycles.max(3), base, list),
        false => Timing::new(Class::Store, cycles.max(3), base, 0),
    }
}

fn short(word: u32) -> Timing {
    let (a, b, c) = (word & 7, word >> 3 & 7, word >> 6 & 7);
    let upper = word >> 8 & 7;
    match word >> 12 {
        0 | 1 => alu(a, bit(b)),
        // CMP has no destination.
        2 if word >> 11 & 1 == 1 => plain(Class::Alu),
        2 | 3 => alu(upper, bit(upper)),
        4 => short_registers(word),
        5 if word >> 9 & 7 < 3 => Timing::new(Class::Store, 2, bit(b) | bit(c), 0),
        5 => load(a, Range::exactly(2), bit(b) | bit(c)),
        6..=8 if word >> 11 & 1 == 1 => load(a, Range::exactly(2), bit(b)),
        6..=8 => Timing::new(Class::Store, 1, bit(b), 0),
        9 if word >> 11 & 1 == 1 => load(upper, Range::exactly(2), bit(SP)),
        9 => Timing::new(Class::Store, 1, bit(SP), 0),
        10 => alu(upper, 0),
        11 => short_miscellaneous(word),
        12 => many(word >> 11 & 1 == 1, word as u16 & 0xff, bit(upper)),
        13 if word >> 8 & 15 < 14 => may_jump(1),
        // What is undefined, and SVC.
        13 if word >> 8 & 15 == 14 => plain(Class::Other),
        _ => jump(1),
    }
}

/// Operations on two registers, high registers, and literals.
fn short_registers(word: u32) -> Timing {
    let (a, b) = (word & 7, word >> 3 & 7);
    if word >> 11 & 1 == 1 {
        return load(word >> 8 & 7, LITERAL, 0);
    }
    if word >> 10 & 1 == 0 {
        return match word >> 6 & 15 {
            8 | 10 | 11 => plain(Class::Alu),
            13 => Timing::new(Class::Multiply, 1, bit(a) | bit(b), bit(a)),
            2..=4 | 7 => Timing::new(Class::RegisterShift, 1, bit(a) | bit(b), bit(a)),
            _ => alu(a, bit(a) | bit(b)),
        };
    }
    let to = word >> 4 & 8 | a;
    match word >> 8 & 3 {
        3 => jump(1),
        1 => plain(Class::Alu),
        _ if to == PC => jump(1),
        _ => alu(to, bit(field(word, 3))),
    }
}

fn short_miscellaneous(word: u32) -> Timing {
    match word >> 8 & 15 {
        0 => alu(SP, bit(SP)),
        1 | 3 | 9 | 11 => may_jump(1),
        2 | 10 => alu(word & 7, bit(word >> 3 & 7)),
        4 => many(false, word as u16 & 0xff, bit(SP)),
        5 => many(false, word as u16 & 0xff | bit(LR), bit(SP)),
        12 => many(true, word as u16 & 0xff, bit(SP)),
        13 => many(true, word as u16 & 0xff | bit(PC), bit(SP)),
        _ => plain(Class::Other),
    }
}

fn long(first: u32, second: u32) -> Timing {
    let base = bit(first & 15);
    match first >> 9 {
        0x74 if first >> 6 & 1 == 0 => many(first >> 4 & 1 == 1, second as u16, base),
        0x74 => double_or_table(first, second),
        0x75 => operation(second, first >> 5 & 15, first),
        0x78..=0x7b if second >> 15 == 0 => operation(second, first >> 5 & 15, first),
        0x78..=0x7b => long_branch(first, second),
        0x7c => long_access(first, second),
        0x7d => long_registers(first, second),
        _ => plain(Class::Other),
    }
}

/// `LDRD`, `STRD`, the exclusive accesses, and jumps by tables.
fn double_or_table(first: u32, second: u32) -> Timing {
    let base = bit(first & 15);
    let loads = first >> 4 & 1 == 1;
    if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 {
        return Timing::branch(Range::exactly(3).plus(REFILL), base | bit(second & 15));
    }
    if first & 0xff60 == 0xe840 || first & 0xffe0 == 0xe8c0 {
        return Timing::new(Class::Load, 2, base, bit(field(second, 12)));
    }
    let both = bit(field(second, 12)) | bit(field(second, 8));
    match loads {
        true => Timing::new(Class::Load, 3, base, both),
        false => Timing::new(Class::Store, 3, base, 0),
    }
}

/// Data processing, with a shifted register or a constant: without a destination where it compares.
fn operation(second: u32, operation: u32, first: u32) -> Timing {
    let to = field(second, 8);
    let compares = to == PC && first >> 4 & 1 == 1 && matches!(operation, 0 | 4 | 8 | 13);
    if compares {
        plain(Class::Alu)
    } else {
        alu(to, bit(first & 15))
    }
}

fn long_branch(first: u32, second: u32) -> Timing {
    if second & 0x5000 != 0 {
        return jump(1);
    }
    match first >> 7 & 7 {
        // Barriers, hints and status registers.
        7 => Timing {
            cycles: Range::new(1, 2, 2),
            ..plain(Class::Other)
        },
        _ => may_jump(1),
    }
}

fn long_access(first: u32, second: u32) -> Timing {
    let base = first & 15;
    let to = field(second, 12);
    let by_register = first >> 7 & 1 == 0 && second & 0x0fc0 == 0 && base != PC;
    let address = bit(base) | if by_register { bit(second & 15) } else { 0 };
    let is_word = first & 0x0160 == 0x0040;
    match (first >> 4 & 1, base) {
        // A hint for a cache that there is none of.
        (1, _) if to == PC && !is_word => plain(Class::Other),
        (1, PC) => load(to, LITERAL, 0),
        (1, _) => load(to, Range::exactly(2), address),
        _ => Timing::new(Class::Store, if by_register { 2 } else { 1 }, address, 0),
    }
}

/// Shifts by registers, extensions, products and quotients.
fn long_registers(first: u32, second: u32) -> Timing {
    let (to, other) = (field(second, 8), field(second, 12));
    let factors = bit(first & 15) | bit(second & 15);
    match first >> 4 & 0x1f {
        0..=7 if second & 0xf0 == 0 => Timing::new(Class::RegisterShift, 1, factors, bit(to)),
        0..=15 => alu(to, factors),
        16 if other == PC => Timing::new(Class::Multiply, 1, factors, bit(to)),
        16..=23 => Timing::new(Class::Multiply, 2, factors, bit(to)),
        kind => Timing {
            cycles: match kind {
                24 | 26 => LONG,
                25 | 27 => QUOTIENT,
                _ => LONG_SUM,
            },
            ..match kind {
                25 | 27 => Timing::new(Class::Divide, 2, factors, bit(to)),
                _ => Timing::new(Class::LongMultiply, 3, factors, bit(to) | bit(other)),
            }
        },
    }
}
