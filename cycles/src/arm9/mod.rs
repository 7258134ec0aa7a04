//! The ARM9E-S, the processor of the ARM968E-S, with tightly coupled memory and no caches.

mod decode;

use std::collections::BTreeMap;

use crate::class::Class;
use crate::flow::{Flow, Instruction};
use decode::{Timing, decode, is_conditional};

/// What an instruction has cost in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Priced {
    /// Where it lies.
    pub address: u32,
    /// How often it ran, failed conditions included.
    pub executions: u64,
    /// Its cycles, with its stalls and its jumps.
    pub cycles: u64,
    /// Cycles that it waited for a load.
    pub load_stalls: u64,
    /// Cycles that it waited for a product.
    pub multiply_stalls: u64,
    /// Its kind.
    pub class: Class,
}

/// Prices a flow, instruction by instruction, in the order of their addresses.
pub fn price(flow: &Flow) -> Vec<Priced> {
    let timings: Vec<Vec<Timing>> = flow
        .blocks
        .iter()
        .map(|block| {
            block
                .instructions
                .iter()
                .map(|instruction| decode(instruction.encoding))
                .collect()
        })
        .collect();
    let executions = flow.executions();
    let mut ends: Vec<u64> = executions.clone();
    let mut prices = BTreeMap::new();
    for edge in &flow.edges {
        let mut board = Scoreboard::default();
        if let Some(from) = edge.from {
            ends[from] = ends[from].saturating_sub(edge.count);
            let (block, timings) = (&flow.blocks[from], &timings[from]);
            let jumped = block.end() != flow.blocks[edge.to].start();
            for (place, timing) in timings.iter().enumerate() {
                let last = place + 1 == timings.len();
                let failed = last && timing.jumps && !jumped;
                board.issue(timing, !failed);
            }
            if let (Some(instruction), Some(timing)) = (block.instructions.last(), timings.last()) {
                charge_jump(&mut prices, instruction, timing, jumped, edge.count);
            }
        }
        let block = &flow.blocks[edge.to];
        let runs = executions[edge.to];
        for ((instruction, timing), &passed) in block
            .instructions
            .iter()
            .zip(&timings[edge.to])
            .zip(&block.passed)
        {
            let stall = board.issue(timing, true);
            let price = entry(&mut prices, instruction, timing);
            price.executions += edge.count;
            price.load_stalls += edge.count * u64::from(stall.load);
            price.multiply_stalls += edge.count * u64::from(stall.multiply);
            price.cycles += edge.count * u64::from(stall.load + stall.multiply);
            if !timing.jumps {
                let accesses = matches!(timing.class, Class::Load | Class::Store);
                let passed = match is_conditional(instruction.encoding) && accesses {
                    // Of all that passed, this edge's share.
                    true => (u128::from(passed) * u128::from(edge.count) / u128::from(runs)) as u64,
                    false => edge.count,
                };
                price.cycles += passed * u64::from(timing.cycles) + (edge.count - passed);
            }
        }
    }
    for ((block, timings), ends) in flow.blocks.iter().zip(&timings).zip(ends) {
        if let (Some(instruction), Some(timing)) = (block.instructions.last(), timings.last()) {
            charge_jump(&mut prices, instruction, timing, true, ends);
        }
    }
    prices.into_values().collect()
}

fn entry<'a>(
    prices: &'a mut BTreeMap<u32, Priced>,
    instruction: &Instruction,
    timing: &Timing,
) -> &'a mut Priced {
    prices.entry(instruction.address).or_insert(Priced {
        address: instruction.address,
        executions: 0,
        cycles: 0,
        load_stalls: 0,
        multiply_stalls: 0,
        class: timing.class,
    })
}

fn charge_jump(
    prices: &mut BTreeMap<u32, Priced>,
    instruction: &Instruction,
    timing: &Timing,
    jumped: bool,
    count: u64,
) {
    if timing.jumps {
        let jumped = jumped || !is_conditional(instruction.encoding);
        let cycles = if jumped { timing.cycles } else { 1 };
        entry(prices, instruction, timing).cycles += count * u64::from(cycles);
    }
}

/// What an instruction waits for.
#[derive(Clone, Copy, Debug, Default)]
struct Stall {
    load: u32,
    multiply: u32,
}

/// Which registers are not there yet.
#[derive(Clone, Debug, Default)]
struct Scoreboard {
    /// Cycles until each register can be used.
    late: [u32; 16],
    /// Those that come of a load.
    loaded: u16,
}

impl Scoreboard {
    /// Issues an instruction whose condition holds or fails, and says what it waits for.
    fn issue(&mut self, timing: &Timing, passed: bool) -> Stall {
        let waits = |register: &u32| {
            let bit = 1 << register;
            let forwarded = timing.accumulates & bit != 0 && self.loaded & bit == 0;
            timing.reads & bit != 0 || timing.accumulates & bit != 0 && !forwarded
        };
        let late = |register: u32| self.late[register as usize];
        let longest = (0..16).filter(waits).max_by_key(|&register| late(register));
        let mut stall = Stall::default();
        if let Some(register) = longest {
            let cycles = late(register);
            match self.loaded >> register & 1 {
                1 => stall.load = cycles,
                _ => stall.multiply = cycles,
            }
        }
        let cycles = if passed { timing.cycles } else { 1 };
        self.advance(stall.load + stall.multiply + cycles);
        if passed {
            self.write(timing);
        }
        stall
    }

    fn advance(&mut self, cycles: u32) {
        for late in &mut self.late {
            *late = late.saturating_sub(cycles);
        }
    }

    fn write(&mut self, timing: &Timing) {
        for register in (0..16).filter(|register| timing.writes >> register & 1 == 1) {
            self.late[register] = 0;
        }
        for &(register, cycles) in &timing.late {
            self.late[register as usize] = cycles;
            let bit = 1 << register;
            match timing.class {
                Class::Load => self.loaded |= bit,
                _ => self.loaded &= !bit,
            }
        }
    }
}
