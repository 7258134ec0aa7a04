//! What a price may be wrong by, and why: what the manuals give as a range, what a recording does not show, and what is assumed of memory.

use crate::arm9::Arm9;
use crate::class::Class;
use crate::flow::{Edge, Flow, Isa};
use crate::pipeline::{Estimate, Pipeline};
use crate::price::{Assumptions, Priced, price};

/// Something that a price does not see.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlindSpot {
    /// What it is.
    pub what: &'static str,
    /// Cycles that the price may be too high by.
    pub less: u64,
    /// Cycles that it may be too low by.
    pub more: u64,
}

/// All of them, with the worst that each can do to the price of this flow. What can do nothing is left out.
pub fn blind_spots(flow: &Flow) -> Vec<BlindSpot> {
    let estimates = [Estimate::Low, Estimate::Likely, Estimate::High];
    let [low, likely, high] = estimates.map(|estimate| {
        let assumptions = Assumptions {
            estimate,
            ..Assumptions::default()
        };
        price(flow, assumptions)
    });
    let of_class = |prices: &[Priced], class| -> u64 {
        let priced = prices.iter().filter(|priced| priced.class == class);
        priced.map(|priced| priced.cycles).sum()
    };
    let mut spots = Vec::new();
    for class in Class::ALL {
        let [low, likely, high] = [&low, &likely, &high].map(|prices| of_class(prices, class));
        let spot = BlindSpot {
            what: of(flow.isa, class),
            less: likely.saturating_sub(low),
            more: high.saturating_sub(likely),
        };
        add(&mut spots, spot);
    }
    let code_accesses = flow.blocks.iter().flat_map(|block| &block.from_code);
    let code_accesses = BlindSpot {
        what: "literals and tables in instruction memory, if an access takes a cycle longer there",
        less: 0,
        more: code_accesses.sum(),
    };
    add(&mut spots, code_accesses);
    if flow.isa == Isa::Arm {
        for spot in of_recordings(flow) {
            add(&mut spots, spot);
        }
    }
    spots.retain(|spot| spot.less + spot.more > 0);
    spots
}

/// Adds what is known of one to a list, in which each stands once.
pub fn add(spots: &mut Vec<BlindSpot>, spot: BlindSpot) {
    match spots.iter_mut().find(|known| known.what == spot.what) {
        Some(known) => {
            known.less += spot.less;
            known.more += spot.more;
        }
        None => spots.push(spot),
    }
}

/// What is not known of a class of instructions.
const fn of(isa: Isa, class: Class) -> &'static str {
    match (isa, class) {
        (Isa::Arm, Class::RegisterShift) => "whether conditional shifts by a register happened",
        (Isa::Arm, Class::Multiply | Class::LongMultiply) => "whether conditional products were computed",
        (Isa::Arm, _) => "waits for what may not have happened, and whether status registers were accessed",
        (Isa::Thumb, Class::Branch) => {
            "refills of the pipeline: 1 to 3 cycles by the target's place and the fetch unit"
        }
        (Isa::Thumb, Class::LongMultiply) => {
            "long products: 3 to 5 cycles by their factors, 4 to 7 with an addend"
        }
        (Isa::Thumb, Class::Divide) => "quotients: 2 to 12 cycles by their operands",
        (Isa::Thumb, Class::Load | Class::Store) => {
            "addresses just computed, and literals that meet the fetch unit"
        }
        (Isa::Thumb, Class::Other) => "which IT are folded into the instruction before, and barriers",
        (Isa::Thumb, _) => "whether conditional operations of more than a cycle happened",
    }
}

/// What QEMU's blocks hide of the interlocks between them.
fn of_recordings(flow: &Flow) -> [BlindSpot; 2] {
    let (mut short, mut shared) = (0, 0);
    let executions = flow.executions();
    for edge in &flow.edges {
        let Some(from) = edge.from else { continue };
        let block = &flow.blocks[from];
        // A loaded byte is late by two cycles, all else by one, which the block takes.
        if block.instructions.len() == 1
            && flow
                .edges
                .iter()
                .any(|before| before.to == from && ends_late(flow, before))
        {
            short += edge.count;
        }
        let last = block.instructions.iter().zip(&block.passed).rev().take(2);
        let passed = last.map(|(_, &passed)| passed).max().unwrap_or_default();
        let unequal = passed.min(executions[from].saturating_sub(passed));
        shared += 2 * unequal.min(edge.count);
    }
    [
        BlindSpot {
            what: "bytes that were loaded before a block of one instruction and used after it",
            less: 0,
            more: short,
        },
        BlindSpot {
            what: "which way a block was left whose last access happened only at times",
            less: shared,
            more: shared,
        },
    ]
}

/// Whether an edge leaves a register that is late by more than a cycle.
fn ends_late(flow: &Flow, edge: &Edge) -> bool {
    let last = edge.from.and_then(|from| flow.blocks[from].instructions.last());
    let timing = last.map(|last| Arm9::decode(&[*last]));
    timing.is_some_and(|timing| timing[0].late.iter().any(|&(_, cycles)| cycles > 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::{Block, Instruction};

    fn block(address: u32, words: &[u32], passed: u64) -> Block {
        let addresses = (address..).step_by(4);
        let instruction = |(address, &encoding)| Instruction {
            address,
            encoding,
            bytes: 4,
        };
        Block {
            instructions: addresses.zip(words).map(instruction).collect(),
            passed: vec![passed; words.len()],
            from_code: vec![passed; words.len()],
        }
    }

    fn edge(from: Option<usize>, to: usize) -> Edge {
        Edge { from, to, count: 10 }
    }

    #[test]
    fn every_blind_spot_is_as_large_as_what_it_hides() {
        // ldrb r0, [r1]; bne; add r2, r0, r3; mulne r4, r5, r6
        let blocks = vec![
            block(0x100, &[0xe5d1_0000], 10),
            block(0x104, &[0x1a00_0000], 0),
            block(0x108, &[0xe080_2003, 0x1004_0695], 0),
        ];
        let edges = vec![edge(None, 0), edge(Some(0), 1), edge(Some(1), 2)];
        let isa = Isa::Arm;
        let spots = blind_spots(&Flow { isa, blocks, edges });
        let found: Vec<_> = spots.iter().map(|spot| (spot.less, spot.more)).collect();
        // The product, the literal, the byte.
        assert_eq!(found, [(10, 0), (0, 10), (0, 10)], "{spots:?}");
    }

    #[test]
    fn a_load_that_happens_at_times_may_have_been_before_either_of_two_blocks() {
        // ldrne r0, [r1]; bne; add r2, r0, r3
        let blocks = vec![
            block(0x100, &[0x1591_0000, 0x1a00_0000], 4),
            block(0x108, &[0xe080_2003], 0),
        ];
        let edges = vec![edge(None, 0), edge(Some(0), 1)];
        let isa = Isa::Arm;
        let spots = blind_spots(&Flow { isa, blocks, edges });
        assert!(
            spots.iter().any(|spot| (spot.less, spot.more) == (8, 8)),
            "{spots:?}"
        );
    }
}
