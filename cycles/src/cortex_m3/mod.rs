//! The Cortex-M3 with memories that answer at once.
//!
//! Its table is section 3.3 of the Cortex-M3 Technical Reference Manual (ARM DDI 0337). The manual gives ranges where operands or the
//! fetch unit decide: a refill of the pipeline takes 1 to 3 cycles, a long product 3 to 5, with an addend 4 to 7, a quotient 2 to
//! 12. The quoted figure takes the middle of each range, and both ends are prices, too ([`crate::price::cycles`]).

mod decode;

use crate::class::Class;
use crate::flow::Instruction;
use crate::pipeline::{Estimate, Pipeline, Stall, Timing};

/// What the instruction before leaves behind.
#[derive(Clone, Debug, Default)]
pub(crate) struct CortexM3 {
    /// Registers that a load has loaded after which another access can be pipelined.
    loaded: Option<u16>,
    /// Registers that have just been computed: an address made of one has to wait until it is in the register bank.
    computed: u16,
}

impl Pipeline for CortexM3 {
    fn decode(instructions: &[Instruction]) -> Vec<Timing> {
        decode::decode(instructions)
    }

    fn wait(&self, timing: &Timing, estimate: Estimate) -> Stall {
        let waits = timing.accesses() && timing.reads & self.computed != 0 && estimate != Estimate::Low;
        Stall {
            load: waits.into(),
            multiply: 0,
        }
    }

    fn issue(&mut self, timing: &Timing, passed: bool, estimate: Estimate) -> u32 {
        let before = std::mem::take(self);
        if !passed {
            return 1;
        }
        let single = timing.accesses() && timing.cycles.low <= 2 && timing.late.len() <= 1;
        let pipelined = single && before.loaded.is_some_and(|loaded| timing.reads & loaded == 0);
        if timing.class == Class::Load && single {
            self.loaded = Some(
                timing
                    .late
                    .iter()
                    .fold(0, |all, &(register, _)| all | 1 << register),
            );
        } else if !timing.accesses() {
            self.computed = timing.writes;
        }
        let cycles = timing.cycles.of(estimate);
        if pipelined {
            cycles.saturating_sub(1).max(1)
        } else {
            cycles
        }
    }
}
