//! Where an instruction may go.

use crate::flow::{Instruction, Isa};

/// Where the core may be after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// At the next one.
    Following,
    /// There, or at the next one.
    Target(u32),
    /// Anywhere: a register or memory says where.
    Anywhere,
}

/// Where an instruction may go.
pub fn next(isa: Isa, instruction: &Instruction) -> Next {
    match isa {
        Isa::Arm => arm(instruction),
        Isa::Thumb => thumb(instruction),
    }
}

/// How many instructions of a block ran when the next block to run begins at `start`, within it; none where that is no sign that
/// it was left before its end.
pub fn cut(isa: Isa, instructions: &[Instruction], start: u32) -> Option<usize> {
    let length = instructions
        .iter()
        .position(|instruction| instruction.address == start)?;
    let jumped = next(isa, instructions.last()?) == Next::Target(start);
    (length > 0 && !jumped).then_some(length)
}

fn arm(instruction: &Instruction) -> Next {
    let word = instruction.encoding;
    let to_pc = word >> 12 & 15 == 15;
    match word >> 25 & 7 {
        5 => {
            let offset = ((word << 8) as i32 >> 6) as u32;
            let half = if word >> 28 == 15 { word >> 23 & 2 } else { 0 };
            Next::Target(
                instruction
                    .address
                    .wrapping_add(8)
                    .wrapping_add(offset)
                    .wrapping_add(half),
            )
        }
        _ if word >> 28 == 15 => Next::Following,
        // BX and BLX.
        0 if word & 0x0ff0_00d0 == 0x0120_0010 => Next::Anywhere,
        0 if word & 0x90 == 0x90 || word & 0x0190_0000 == 0x0100_0000 => Next::Following,
        // Comparisons have no destination.
        0 | 1 if to_pc && word >> 23 & 3 != 2 => Next::Anywhere,
        2 | 3 if to_pc && word >> 20 & 1 == 1 => Next::Anywhere,
        4 if word >> 15 & 1 == 1 && word >> 20 & 1 == 1 => Next::Anywhere,
        // SVC.
        7 if word >> 24 & 1 == 1 => Next::Anywhere,
        _ => Next::Following,
    }
}

fn thumb(instruction: &Instruction) -> Next {
    let word = instruction.encoding;
    let pc = instruction.address.wrapping_add(4);
    if instruction.bytes == 2 {
        return match word >> 12 {
            0xd if word >> 8 & 15 == 15 => Next::Anywhere,
            0xd if word >> 8 & 15 != 14 => Next::Target(pc.wrapping_add(signed(word << 1, 9))),
            0xe if word >> 11 & 1 == 0 => Next::Target(pc.wrapping_add(signed(word << 1, 12))),
            // CBZ and CBNZ.
            0xb if word & 0x0500 == 0x0100 => {
                Next::Target(pc.wrapping_add(word >> 2 & 0x3e | word >> 3 & 0x40))
            }
            // POP with the program counter.
            0xb if word & 0x0f00 == 0x0d00 => Next::Anywhere,
            // BX, BLX, and ADD or MOV to the program counter.
            0x4 if word & 0x0f00 == 0x0700 => Next::Anywhere,
            0x4 if word & 0x0d87 == 0x0487 => Next::Anywhere,
            _ => Next::Following,
        };
    }
    wide_thumb(word, pc)
}

fn wide_thumb(word: u32, pc: u32) -> Next {
    let (first, second) = (word >> 16, word & 0xffff);
    if first >> 11 == 0x1e && second >> 15 == 1 {
        return wide_branch(first, second, pc);
    }
    let loads = first >> 4 & 1 == 1;
    let multiple = first & 0xfe40 == 0xe800 && loads && second >> 15 == 1;
    let single = first & 0xff70 == 0xf850 && second >> 12 == 15;
    // TBB and TBH.
    let table = first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000;
    if multiple || single || table {
        Next::Anywhere
    } else {
        Next::Following
    }
}

/// `B`, `BL`, and what shares their space: barriers and status registers.
fn wide_branch(first: u32, second: u32, pc: u32) -> Next {
    let sign = first >> 10 & 1;
    let (j1, j2) = (second >> 13 & 1, second >> 11 & 1);
    let low = (second & 0x7ff) << 1;
    if second & 0x5000 == 0 {
        if first >> 7 & 7 == 7 {
            return Next::Following;
        }
        let offset = sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3f) << 12 | low;
        return Next::Target(pc.wrapping_add(signed(offset, 21)));
    }
    let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
    let offset = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3ff) << 12 | low;
    Next::Target(pc.wrapping_add(signed(offset, 25)))
}

/// A number of so many bits with its sign.
const fn signed(value: u32, bits: u32) -> u32 {
    ((value << (32 - bits)) as i32 >> (32 - bits)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(address: u32, encoding: u32, bytes: u8) -> Instruction {
        Instruction {
            address,
            encoding,
            bytes,
        }
    }

    #[test]
    fn arm_branches_go_where_the_assembler_meant() {
        for (word, expected) in [
            (0xeaff_fffe, Next::Target(0x100)), // b .
            (0x1a00_0002, Next::Target(0x110)), // bne .+16
            (0xeb00_0000, Next::Target(0x108)), // bl .+8
            (0xe12f_ff1e, Next::Anywhere),      // bx lr
            (0xe12f_ff33, Next::Anywhere),      // blx r3
            (0xe1a0_f00e, Next::Anywhere),      // mov pc, lr
            (0xe08f_f100, Next::Anywhere),      // add pc, pc, r0, lsl #2
            (0xe59f_f004, Next::Anywhere),      // ldr pc, [pc, #4]
            (0xe8bd_80f0, Next::Anywhere),      // pop {r4-r7, pc}
            (0xe92d_40f0, Next::Following),     // push {r4-r7, lr}
            (0xe15f_000f, Next::Following),     // cmp pc, pc
            (0xe0c3_2190, Next::Following),     // smull r2, r3, r0, r1
            (0xe16f_0f11, Next::Following),     // clz r0, r1
            (0xe58f_f000, Next::Following),     // str pc, [pc]
        ] {
            assert_eq!(next(Isa::Arm, &at(0x100, word, 4)), expected, "{word:08x}");
        }
    }

    #[test]
    fn thumb_branches_go_where_the_assembler_meant() {
        for (word, bytes, expected) in [
            (0xe7fe, 2, Next::Target(0x100)),      // b .
            (0xd1fc, 2, Next::Target(0xfc)),       // bne .-4
            (0xd002, 2, Next::Target(0x108)),      // beq .+8
            (0xb108, 2, Next::Target(0x106)),      // cbz r0, .+6
            (0xb910, 2, Next::Target(0x108)),      // cbnz r0, .+8
            (0x4770, 2, Next::Anywhere),           // bx lr
            (0x4798, 2, Next::Anywhere),           // blx r3
            (0x46f7, 2, Next::Anywhere),           // mov pc, lr
            (0xbd10, 2, Next::Anywhere),           // pop {r4, pc}
            (0xbf18, 2, Next::Following),          // it ne
            (0x4608, 2, Next::Following),          // mov r0, r1
            (0xb510, 2, Next::Following),          // push {r4, lr}
            (0xf000_f802, 4, Next::Target(0x108)), // bl .+8
            (0xf7ff_fffe, 4, Next::Target(0x100)), // bl .
            (0xf000_b800, 4, Next::Target(0x104)), // b.w .+4
            (0xf47f_affe, 4, Next::Target(0x100)), // bne.w .
            (0xe8bd_83f0, 4, Next::Anywhere),      // pop.w {r4-r9, pc}
            (0xe8df_f000, 4, Next::Anywhere),      // tbb [pc, r0]
            (0xf852_f003, 4, Next::Anywhere),      // ldr.w pc, [r2, r3]
            (0xfb82_0103, 4, Next::Following),     // smull r0, r1, r2, r3
            (0xf3bf_8f4f, 4, Next::Following),     // dsb sy
        ] {
            assert_eq!(next(Isa::Thumb, &at(0x100, word, bytes)), expected, "{word:x}");
        }
    }
}
