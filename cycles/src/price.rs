//! The price of a flow: every block, after every block that ran before it, through a processor's pipeline.

use std::collections::BTreeMap;

use crate::class::Class;
use crate::flow::{Block, Edge, Flow, Instruction, Isa};
use crate::pipeline::{Estimate, Pipeline, Timing};
use crate::{arm9, cortex_m3};

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

/// What a price rests on besides the recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Assumptions {
    /// Which end of what is not known for sure.
    pub estimate: Estimate,
    /// Cycles that an access to instruction memory takes longer. 0 says that literals and tables lie in data memory, or that
    /// instruction memory has a second port.
    pub code_access: u32,
}

/// A price, and between what bounds the true one lies as far as the model knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycles {
    /// Everything that is not known taken in favour of the code.
    pub low: u64,
    /// The figure that is quoted.
    pub likely: u64,
    /// Everything taken against it.
    pub high: u64,
}

/// Prices a flow, instruction by instruction, in the order of their addresses, by the table of the processor that has its
/// instruction set: the ARM9E-S or the Cortex-M3.
pub fn price(flow: &Flow, assumptions: Assumptions) -> Vec<Priced> {
    match flow.isa {
        Isa::Arm => Walk::<arm9::Arm9>::new(flow, assumptions).prices(),
        Isa::Thumb => Walk::<cortex_m3::CortexM3>::new(flow, assumptions).prices(),
    }
}

/// The sum of a flow's prices, where an access to instruction memory takes so many cycles longer.
pub fn cycles(flow: &Flow, code_access: u32) -> Cycles {
    let [low, likely, high] = [Estimate::Low, Estimate::Likely, Estimate::High].map(|estimate| {
        let assumptions = Assumptions {
            estimate,
            code_access,
        };
        price(flow, assumptions).iter().map(|priced| priced.cycles).sum()
    });
    Cycles { low, likely, high }
}

impl std::ops::Add for Cycles {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            likely: self.likely + other.likely,
            high: self.high + other.high,
        }
    }
}

impl std::iter::Sum for Cycles {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, next| sum + next)
    }
}

/// For each instruction of a block, whether a recording has to count its accesses to memory.
pub(crate) fn watched(isa: Isa, instructions: &[Instruction]) -> Vec<bool> {
    let timings = match isa {
        Isa::Arm => arm9::Arm9::decode(instructions),
        Isa::Thumb => cortex_m3::CortexM3::decode(instructions),
    };
    let watched = |timing: &Timing| timing.class == Class::Load || timing.conditional && timing.accesses();
    timings.iter().map(watched).collect()
}

/// The processor where every access under a condition happened, and where none did. Of how many runs the first is true, the last
/// such access says.
#[derive(Clone)]
struct Lanes<P> {
    passed: P,
    failed: P,
    share: (u64, u64),
}

impl<P: Pipeline> Lanes<P> {
    fn new() -> Self {
        Self {
            passed: P::default(),
            failed: P::default(),
            share: (1, 1),
        }
    }

    /// Runs an instruction in both lanes; `passed` of its `runs` did what it says. Gives what it took where it did.
    fn issue(&mut self, timing: &Timing, passed: u64, runs: u64, estimate: Estimate) -> u32 {
        if passed == 0 {
            self.passed.issue(timing, false, estimate);
            return self.failed.issue(timing, false, estimate);
        }
        if passed < runs {
            self.share = (passed, runs);
        }
        self.failed.issue(timing, passed == runs, estimate);
        self.passed.issue(timing, true, estimate)
    }
}

struct Walk<'a, P> {
    flow: &'a Flow,
    assumptions: Assumptions,
    timings: Vec<Vec<Timing>>,
    executions: Vec<u64>,
    /// Executions of each block that edges have taken up, and those that went on to another block.
    taken: Vec<u64>,
    left: Vec<u64>,
    prices: BTreeMap<u32, Priced>,
    pipeline: std::marker::PhantomData<P>,
}

impl<'a, P: Pipeline> Walk<'a, P> {
    fn new(flow: &'a Flow, assumptions: Assumptions) -> Self {
        let decoded = flow.blocks.iter().map(|block| P::decode(&block.instructions));
        Self {
            flow,
            assumptions,
            timings: decoded.collect(),
            executions: flow.executions(),
            taken: vec![0; flow.blocks.len()],
            left: vec![0; flow.blocks.len()],
            prices: BTreeMap::new(),
            pipeline: std::marker::PhantomData,
        }
    }

    fn prices(mut self) -> Vec<Priced> {
        for edge in self.flow.edges.iter().filter(|edge| edge.count > 0) {
            let lanes = match edge.from {
                Some(from) => self.leave(from, edge),
                None => Lanes::new(),
            };
            self.enter(edge, lanes);
        }
        for (number, block) in self.flow.blocks.iter().enumerate() {
            let ended = self.executions[number].saturating_sub(self.left[number]);
            self.charge_jump(number, true, ended);
            for (place, &count) in block
                .from_code
                .iter()
                .enumerate()
                .filter(|&(_, &count)| count > 0)
            {
                let cycles = count * u64::from(self.assumptions.code_access);
                let priced = self.priced(number, place);
                priced.cycles += cycles;
                priced.load_stalls += cycles;
            }
        }
        self.prices.into_values().collect()
    }

    fn priced(&mut self, number: usize, place: usize) -> &mut Priced {
        let address = self.flow.blocks[number].instructions[place].address;
        self.prices.entry(address).or_insert(Priced {
            address,
            executions: 0,
            cycles: 0,
            load_stalls: 0,
            multiply_stalls: 0,
            class: self.timings[number][place].class,
        })
    }

    /// Charges the jump at a block's end, and gives the processor after it.
    fn leave(&mut self, from: usize, edge: &Edge) -> Lanes<P> {
        let jumped = self.flow.blocks[from].end() != self.flow.blocks[edge.to].start();
        self.charge_jump(from, jumped, edge.count);
        self.left[from] += edge.count;
        let (block, runs) = (&self.flow.blocks[from], self.executions[from]);
        let mut lanes = Lanes::new();
        for (place, timing) in self.timings[from].iter().enumerate() {
            let passed = match timing.jumps {
                true if jumped || !timing.conditional => runs,
                true => 0,
                false => self.happened(block, place, timing, runs),
            };
            lanes.issue(timing, passed, runs, self.assumptions.estimate);
        }
        lanes
    }

    fn charge_jump(&mut self, number: usize, jumped: bool, count: u64) {
        let Some(timing) = self.timings[number]
            .last()
            .filter(|timing| timing.jumps && count > 0)
        else {
            return;
        };
        let goes = jumped || !timing.conditional;
        let cycles = if goes {
            timing.cycles.of(self.assumptions.estimate)
        } else {
            1
        };
        let last = self.timings[number].len() - 1;
        self.priced(number, last).cycles += count * u64::from(cycles);
    }

    /// Charges a block's instructions but for the jump at its end.
    fn enter(&mut self, edge: &Edge, mut lanes: Lanes<P>) {
        let (flow, to, count) = (self.flow, edge.to, edge.count);
        let (block, runs, taken) = (&flow.blocks[to], self.executions[to], self.taken[to]);
        let estimate = self.assumptions.estimate;
        for place in 0..block.instructions.len() {
            let timing = self.timings[to][place].clone();
            let (passes, fails) = (
                lanes.passed.wait(&timing, estimate),
                lanes.failed.wait(&timing, estimate),
            );
            let waited = part(lanes.share, 0, count);
            let total =
                |passes: u32, fails: u32| waited * u64::from(passes) + (count - waited) * u64::from(fails);
            let load_stalls = total(passes.load, fails.load);
            let multiply_stalls = total(passes.multiply, fails.multiply);
            let happened = self.happened(block, place, &timing, runs);
            let cycles = lanes.issue(&timing, happened, runs, estimate);
            let happened = part((happened, runs), taken, count);
            let priced = self.priced(to, place);
            priced.executions += count;
            priced.load_stalls += load_stalls;
            priced.multiply_stalls += multiply_stalls;
            priced.cycles += load_stalls + multiply_stalls;
            if !timing.jumps {
                priced.cycles += happened * u64::from(cycles) + (count - happened);
            }
        }
        self.taken[to] += count;
    }

    /// How many of its block's runs an instruction did what it says. Of a condition that leaves no trace, the estimate decides.
    fn happened(&self, block: &Block, place: usize, timing: &Timing, runs: u64) -> u64 {
        match timing.conditional {
            true if timing.accesses() => block.passed[place].min(runs),
            true if self.assumptions.estimate == Estimate::Low => 0,
            _ => runs,
        }
    }
}

/// The part of an edge's executions that is its share of all, after so many have been taken: over all edges exactly the whole.
fn part((share, whole): (u64, u64), taken: u64, count: u64) -> u64 {
    let upto =
        |executions: u64| (u128::from(executions) * u128::from(share) / u128::from(whole.max(1))) as u64;
    upto(taken + count) - upto(taken)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branch::{self, Next};

    /// All upper halfwords with some lower ones: whoever follows the flow and whoever prices it must agree on what a jump is.
    #[test]
    fn what_may_go_elsewhere_is_priced_as_a_jump() {
        let mut differ = Vec::new();
        for upper in 0..=u16::MAX {
            for lower in [
                0x0000_u16, 0x0001, 0x0f10, 0x1234, 0x4567, 0x8090, 0x80ff, 0xb5d7, 0xf000, 0xf012, 0xf093,
                0xff1e, 0xff3e,
            ] {
                for isa in [Isa::Arm, Isa::Thumb] {
                    let bytes = match isa {
                        Isa::Arm => [lower, upper],
                        Isa::Thumb => [upper, lower],
                    };
                    let bytes: Vec<u8> = bytes.iter().flat_map(|half| half.to_le_bytes()).collect();
                    let instruction = Instruction::read(isa, 0x100, &bytes).expect("four bytes");
                    let goes = branch::next(isa, &instruction) != Next::Following;
                    let timing = match isa {
                        Isa::Arm => arm9::Arm9::decode(&[instruction]),
                        Isa::Thumb => cortex_m3::CortexM3::decode(&[instruction]),
                    };
                    if timing[0].jumps != goes {
                        differ.push((isa, format!("{:08x}", instruction.encoding), goes));
                    }
                }
            }
        }
        assert!(
            differ.is_empty(),
            "{} differ, the first {:?}",
            differ.len(),
            differ.first()
        );
    }
}
