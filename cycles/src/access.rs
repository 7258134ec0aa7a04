//! Which instructions may or may not access memory, so that whoever records has to look at them.

use crate::flow::{Instruction, Isa};

/// The condition "always".
const ALWAYS: u32 = 0xe;
/// Instructions that an `IT` governs at most.
const IT_LENGTH: usize = 4;

/// For each instruction of a block, whether it is an access to memory under a condition.
///
/// A block's first instructions may stand under an `IT` of the block before, so they count as conditional, too.
pub fn conditional_accesses(isa: Isa, instructions: &[Instruction]) -> Vec<bool> {
    let conditional = |place: usize| match isa {
        Isa::Arm => arm(instructions[place].encoding),
        Isa::Thumb => {
            let before = &instructions[place.saturating_sub(IT_LENGTH)..place];
            place < IT_LENGTH || before.iter().any(is_it)
        }
    };
    (0..instructions.len()).map(conditional).collect()
}

/// Whether an instruction is Thumb-2's `IT`.
fn is_it(instruction: &Instruction) -> bool {
    instruction.bytes == 2 && instruction.encoding >> 8 == 0xbf && instruction.encoding & 0xf != 0
}

fn arm(word: u32) -> bool {
    let single = word >> 26 & 3 == 1;
    let multiple = word >> 25 & 7 == 4;
    let small = word & 0x0e00_0090 == 0x90 && word & 0x60 != 0;
    word >> 28 < ALWAYS && (single || multiple || small)
}
