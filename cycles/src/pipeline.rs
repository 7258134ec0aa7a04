//! What a processor's model has to say of its instructions, so that a flow can be priced.

use crate::class::Class;
use crate::flow::Instruction;

/// A figure that the manual gives as a range, or that a recording leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    pub(crate) low: u32,
    pub(crate) likely: u32,
    pub(crate) high: u32,
}

impl Range {
    /// A figure without doubt.
    pub(crate) const fn exactly(cycles: u32) -> Self {
        Self::new(cycles, cycles, cycles)
    }

    pub(crate) const fn new(low: u32, likely: u32, high: u32) -> Self {
        Self { low, likely, high }
    }

    pub(crate) const fn of(self, estimate: Estimate) -> u32 {
        match estimate {
            Estimate::Low => self.low,
            Estimate::Likely => self.likely,
            Estimate::High => self.high,
        }
    }

    pub(crate) const fn plus(self, other: Self) -> Self {
        Self::new(
            self.low + other.low,
            self.likely + other.likely,
            self.high + other.high,
        )
    }
}

/// Which end of what is not known for sure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimate {
    /// Everything in favour of the code.
    Low,
    /// The figure that is quoted.
    #[default]
    Likely,
    /// Everything against it.
    High,
}

/// What one instruction does to the pipeline, if its condition holds.
#[derive(Clone, Debug)]
pub(crate) struct Timing {
    /// Its kind.
    pub(crate) class: Class,
    /// Its cycles, without what it waits for; of a jump, with what it costs to go elsewhere.
    pub(crate) cycles: Range,
    /// Registers that it needs at its start, a bit each.
    pub(crate) reads: u16,
    /// Registers whose values it stores, in their order: one a cycle.
    pub(crate) stores: u16,
    /// Registers that it needs as an accumulator only.
    pub(crate) accumulates: u16,
    /// Registers that are there later, and how many cycles after its end.
    pub(crate) late: Vec<(u32, u32)>,
    /// Registers that it writes in time.
    pub(crate) writes: u16,
    /// Whether it may go elsewhere.
    pub(crate) jumps: bool,
    /// Whether it may do nothing.
    pub(crate) conditional: bool,
}

impl Timing {
    pub(crate) const fn new(class: Class, cycles: u32, reads: u16, writes: u16) -> Self {
        Self {
            class,
            cycles: Range::exactly(cycles),
            reads,
            stores: 0,
            accumulates: 0,
            late: Vec::new(),
            writes,
            jumps: false,
            conditional: false,
        }
    }

    pub(crate) const fn branch(cycles: Range, reads: u16) -> Self {
        let mut timing = Self::new(Class::Branch, 0, reads, 0);
        timing.cycles = cycles;
        timing.jumps = true;
        timing
    }

    /// Whether it is a load or a store, of which a recording says how often they happened.
    pub(crate) fn accesses(&self) -> bool {
        matches!(self.class, Class::Load | Class::Store)
    }
}

/// A register's bit.
pub(crate) const fn bit(register: u32) -> u16 {
    1 << register
}

/// The number of a register, whose four bits begin at a place of the word.
pub(crate) const fn field(word: u32, place: u32) -> u32 {
    word >> place & 15
}

/// What an instruction waits for, in cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stall {
    pub(crate) load: u32,
    pub(crate) multiply: u32,
}

impl Stall {
    pub(crate) const fn cycles(self) -> u32 {
        self.load + self.multiply
    }
}

/// A processor between two instructions.
pub(crate) trait Pipeline: Clone + Default {
    /// The timings of a block.
    fn decode(instructions: &[Instruction]) -> Vec<Timing>;

    /// What the next instruction would wait for.
    fn wait(&self, timing: &Timing, estimate: Estimate) -> Stall;

    /// Runs the next instruction, and says what it takes without what it waits for.
    fn issue(&mut self, timing: &Timing, passed: bool, estimate: Estimate) -> u32;
}
