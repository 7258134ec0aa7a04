//! The ARM9E-S, the processor of the ARM968E-S, with tightly coupled memory and no caches.
//!
//! Its table is chapter 8 of the ARM9E-S Technical Reference Manual (ARM DDI 0165 and DDI 0240): cycles of each instruction, and the
//! interlocks between them; `tests/arm9.rs` has each rule with its source. A result that is late makes the first instruction that needs it wait, unless others passed the time; a
//! product is not waited for by what adds to it, because the multiplier forwards it to its own accumulator.

mod decode;

use crate::class::Class;
use crate::flow::Instruction;
use crate::pipeline::{Estimate, Pipeline, Stall, Timing};

/// Which registers are not there yet.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arm9 {
    /// Cycles until each register can be used.
    late: [u32; 16],
    /// Those that come of a load.
    loaded: u16,
    /// Those that come of a saturating sum, which is in time for being stored.
    saturated: u16,
}

impl Arm9 {
    /// Cycles until an instruction that begins now has a register, if it needs it.
    fn lacks(&self, timing: &Timing, register: u32) -> u32 {
        let (late, bit) = (self.late[register as usize], 1 << register);
        let is_product = self.loaded & bit == 0;
        let accumulates = timing.accumulates & bit != 0 && !is_product;
        if timing.reads & bit != 0 || accumulates {
            late
        } else if timing.stores & bit & !self.saturated != 0 {
            // Registers are stored one a cycle.
            late.saturating_sub((timing.stores & (bit - 1)).count_ones())
        } else {
            0
        }
    }

    fn write(&mut self, timing: &Timing) {
        for register in (0..16).filter(|register| timing.writes >> register & 1 == 1) {
            self.late[register] = 0;
        }
        for &(register, cycles) in &timing.late {
            self.late[register as usize] = cycles;
            let bit = 1 << register;
            self.loaded &= !bit;
            self.saturated &= !bit;
            match timing.class {
                Class::Load => self.loaded |= bit,
                Class::Alu => self.saturated |= bit,
                _ => {}
            }
        }
    }
}

impl Pipeline for Arm9 {
    fn decode(instructions: &[Instruction]) -> Vec<Timing> {
        let words = instructions.iter().map(|instruction| instruction.encoding);
        words.map(decode::decode).collect()
    }

    fn wait(&self, timing: &Timing, _estimate: Estimate) -> Stall {
        let mut stall = Stall::default();
        for register in 0..16 {
            let late = self.lacks(timing, register);
            if late > stall.cycles() {
                let loaded = self.loaded >> register & 1 == 1;
                let (load, multiply) = if loaded { (late, 0) } else { (0, late) };
                stall = Stall { load, multiply };
            }
        }
        stall
    }

    fn issue(&mut self, timing: &Timing, passed: bool, estimate: Estimate) -> u32 {
        let cycles = if passed { timing.cycles.of(estimate) } else { 1 };
        let elapsed = self.wait(timing, estimate).cycles() + cycles;
        for late in &mut self.late {
            *late = late.saturating_sub(elapsed);
        }
        if passed {
            self.write(timing);
        }
        cycles
    }
}
