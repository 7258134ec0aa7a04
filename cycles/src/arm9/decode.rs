//! What an A32 instruction reads, writes and costs on an ARM9E-S.

use crate::class::Class;
use crate::pipeline::{Range, Timing, bit, field};

/// The program counter.
const PC: u32 = 15;

/// A jump that takes so many cycles.
const fn branch(cycles: u32, reads: u16) -> Timing {
    Timing::branch(Range::exactly(cycles), reads)
}

/// The timing of a word.
pub(super) fn decode(word: u32) -> Timing {
    if word >> 28 == 0xf {
        return unconditional(word);
    }
    Timing {
        conditional: word >> 28 != 0xe,
        ..conditional(word)
    }
}

fn conditional(word: u32) -> Timing {
    match word >> 25 & 7 {
        0 if word & 0x90 == 0x90 => multiply_or_small_access(word),
        0 if word & 0x0190_0000 == 0x0100_0000 => miscellaneous(word),
        1 if word & 0x01b0_0000 == 0x0120_0000 => to_status(word, 0),
        0 | 1 => data_processing(word),
        2 | 3 => single_access(word),
        4 => multiple_access(word),
        5 => Timing {
            writes: if word >> 24 & 1 == 1 { bit(14) } else { 0 },
            ..branch(3, 0)
        },
        // SVC.
        7 if word >> 24 & 1 == 1 => branch(3, 0),
        _ => Timing::new(Class::Other, 1, 0, 0),
    }
}

/// `BLX` to an address, and `PLD`.
fn unconditional(word: u32) -> Timing {
    if word >> 25 & 7 == 5 {
        return branch(3, 0);
    }
    Timing::new(Class::Other, 1, bit(field(word, 16)), 0)
}

fn data_processing(word: u32) -> Timing {
    let opcode = word >> 21 & 15;
    let by_register = word >> 25 & 1 == 0 && word & 0x10 != 0;
    let mut reads = 0;
    if word >> 25 & 1 == 0 {
        reads |= bit(field(word, 0));
    }
    if by_register {
        reads |= bit(field(word, 8));
    }
    // MOV and MVN have no first operand.
    if !matches!(opcode, 13 | 15) {
        reads |= bit(field(word, 16));
    }
    let compares = matches!(opcode, 8..=11);
    let to = field(word, 12);
    let (class, cycles) = if by_register {
        (Class::RegisterShift, 2)
    } else {
        (Class::Alu, 1)
    };
    match to {
        PC if !compares => branch(cycles + 2, reads),
        _ => Timing::new(class, cycles, reads, if compares { 0 } else { bit(to) }),
    }
}

fn to_status(word: u32, reads: u16) -> Timing {
    // Flags alone take one cycle, all else refills the pipeline.
    let flags_only = word >> 16 & 15 == 8;
    Timing::new(Class::Other, if flags_only { 1 } else { 3 }, reads, 0)
}

fn miscellaneous(word: u32) -> Timing {
    let (a, b, c, to) = (field(word, 0), field(word, 8), field(word, 16), field(word, 12));
    match (word >> 4 & 15, word >> 21 & 3) {
        (0, 1 | 3) => to_status(word, bit(a)),
        (0, _) => Timing::new(Class::Other, 2, 0, bit(to)),
        (1, 3) => Timing::new(Class::Alu, 1, bit(a), bit(to)),
        (1 | 3, 1) => branch(3, bit(a)),
        (5, _) => Timing {
            late: vec![(to, 1)],
            ..Timing::new(Class::Alu, 1, bit(a) | bit(c), 0)
        },
        (low, kind) if low & 9 == 8 => halfword_product(kind, low, [a, b, c, to]),
        _ => Timing::new(Class::Other, 1, 0, 0),
    }
}

/// `SMULxy` and its kin.
fn halfword_product(kind: u32, low: u32, [a, b, to, accumulator]: [u32; 4]) -> Timing {
    let factors = bit(a) | bit(b);
    let adds = kind == 0 || kind == 1 && low & 2 == 0;
    match kind {
        2 => Timing {
            accumulates: bit(to) | bit(accumulator),
            late: vec![(to, 1)],
            ..Timing::new(Class::Multiply, 2, factors, bit(accumulator))
        },
        _ => Timing {
            accumulates: if adds { bit(accumulator) } else { 0 },
            late: vec![(to, 1)],
            ..Timing::new(Class::Multiply, 1, factors, 0)
        },
    }
}

fn multiply_or_small_access(word: u32) -> Timing {
    if word & 0x60 != 0 {
        return small_access(word);
    }
    let (a, b) = (field(word, 0), field(word, 8));
    let (high, low) = (field(word, 16), field(word, 12));
    let adds = word >> 21 & 1 == 1;
    // Whose flags are set takes two cycles more, after which the whole result is there.
    let (flags, late) = if word >> 20 & 1 == 1 {
        (2, Vec::new())
    } else {
        (0, vec![(high, 1)])
    };
    match word >> 23 & 3 {
        0 => Timing {
            accumulates: if adds { bit(low) } else { 0 },
            late,
            ..Timing::new(Class::Multiply, 2 + flags, bit(a) | bit(b), bit(high))
        },
        1 => Timing {
            accumulates: if adds { bit(low) | bit(high) } else { 0 },
            late,
            ..Timing::new(
                Class::LongMultiply,
                3 + flags,
                bit(a) | bit(b),
                bit(low) | bit(high),
            )
        },
        // SWP.
        _ => Timing {
            stores: bit(a),
            late: vec![(low, 1)],
            ..Timing::new(Class::Load, 2, bit(high), 0)
        },
    }
}

/// The registers that make an address, and the one that is written back.
fn address(word: u32, offset_in_register: bool) -> (u16, u16) {
    let base = field(word, 16);
    let offset = if offset_in_register {
        bit(field(word, 0))
    } else {
        0
    };
    let post_indexed = word >> 24 & 1 == 0;
    let written = post_indexed || word >> 21 & 1 == 1;
    (bit(base) | offset, if written { bit(base) } else { 0 })
}

/// Halfwords, signed bytes and doublewords.
fn small_access(word: u32) -> Timing {
    let (reads, writes) = address(word, word >> 22 & 1 == 0);
    let to = field(word, 12);
    let loads = word >> 20 & 1 == 1;
    match (loads, word >> 5 & 3) {
        (true, _) => Timing {
            late: vec![(to, 2)],
            ..Timing::new(Class::Load, 1, reads, writes)
        },
        (false, 2) => Timing {
            late: vec![(to | 1, 1)],
            ..Timing::new(Class::Load, 2, reads, writes | bit(to & !1))
        },
        (false, kind) => Timing {
            stores: if kind == 3 { bit(to) | bit(to | 1) } else { bit(to) },
            ..Timing::new(Class::Store, if kind == 3 { 2 } else { 1 }, reads, writes)
        },
    }
}

fn single_access(word: u32) -> Timing {
    let in_register = word >> 25 & 1 == 1;
    let (reads, writes) = address(word, in_register);
    let shifted = in_register && word & 0x0ff0 != 0;
    let to = field(word, 12);
    let cycles = if shifted { 2 } else { 1 };
    if word >> 20 & 1 == 0 {
        return Timing {
            stores: bit(to),
            ..Timing::new(Class::Store, cycles, reads, writes)
        };
    }
    if to == PC {
        return Timing {
            writes,
            ..branch(cycles + 4, reads)
        };
    }
    let byte = word >> 22 & 1 == 1;
    Timing {
        late: vec![(to, if byte { 2 } else { 1 })],
        ..Timing::new(Class::Load, cycles, reads, writes)
    }
}

fn multiple_access(word: u32) -> Timing {
    let list = word as u16;
    let base = bit(field(word, 16));
    let count = list.count_ones();
    let writes = if word >> 21 & 1 == 1 { base } else { 0 };
    let cycles = count.max(2);
    if word >> 20 & 1 == 0 {
        return Timing {
            stores: list,
            ..Timing::new(Class::Store, cycles, base, writes)
        };
    }
    if list & bit(PC) != 0 {
        return Timing {
            writes: writes | list & !bit(PC),
            ..branch(count + 4, base)
        };
    }
    let last = 15 - list.leading_zeros().min(15);
    let late = if count > 1 { vec![(last, 1)] } else { Vec::new() };
    Timing {
        late,
        ..Timing::new(Class::Load, cycles, base, writes | list & !bit(last))
    }
}
