//! Flows made by hand, and the sum of their prices.

use cycles::flow::{Block, Edge, Flow, Instruction, Isa};

/// Blocks of words, one after the other in memory from address 0x100, with the edges that were taken between them.
pub(crate) fn flow(isa: Isa, blocks: &[&[u32]], edges: &[(Option<usize>, usize, u64)]) -> Flow {
    let mut address = 0x100;
    let mut instruction = |&encoding: &u32| {
        let is_long = isa == Isa::Arm || encoding >> 16 != 0;
        let bytes = if is_long { 4 } else { 2 };
        let at = address;
        address += u32::from(bytes);
        Instruction {
            address: at,
            encoding,
            bytes,
        }
    };
    let block = |words: &&[u32]| Block {
        instructions: words.iter().map(&mut instruction).collect(),
        passed: vec![0; words.len()],
        from_code: vec![0; words.len()],
    };
    Flow {
        isa,
        blocks: blocks.iter().map(block).collect(),
        edges: edges
            .iter()
            .map(|&(from, to, count)| Edge { from, to, count })
            .collect(),
    }
}

/// The flow of a sequence that runs once. Where a condition may fail, an access happens.
pub(crate) fn straight(isa: Isa, words: &[u32]) -> Flow {
    let mut flow = flow(isa, &[words], &[(None, 0, 1)]);
    flow.blocks[0].passed.fill(1);
    flow
}
