//! The flow of a core's execution: which blocks of instructions ran, how often, and in which order.

use crate::branch::{self, Next};

/// The instruction set of a flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// A32, words of 32 bits.
    Arm,
    /// Thumb-2, words of 16 or 32 bits.
    Thumb,
}

/// An instruction in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Instruction {
    /// Where it lies.
    pub address: u32,
    /// Its word. The first halfword of a 32-bit Thumb instruction is in the upper half.
    pub encoding: u32,
    /// Its length: 2 or 4.
    pub bytes: u8,
}

impl Instruction {
    /// The instruction whose bytes are the first of these, as they lie in memory; none where they are too few.
    pub fn read(isa: Isa, address: u32, bytes: &[u8]) -> Option<Self> {
        let half = |place: usize| {
            let bytes = bytes.get(place..)?.first_chunk()?;
            Some(u32::from(u16::from_le_bytes(*bytes)))
        };
        let first = half(0)?;
        let (encoding, bytes) = match isa {
            Isa::Arm => (half(2)? << 16 | first, 4),
            Isa::Thumb if first >> 11 >= 0x1d => (first << 16 | half(2)?, 4),
            Isa::Thumb => (first, 2),
        };
        Some(Self {
            address,
            encoding,
            bytes,
        })
    }

    /// The address after it.
    pub fn end(&self) -> u32 {
        self.address.wrapping_add(self.bytes.into())
    }
}

/// Instructions that run one after the other. Only the last may go elsewhere.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block {
    /// The instructions, at least one.
    pub instructions: Vec<Instruction>,
    /// How often each really accessed memory, where it may not have or loads; else 0.
    pub passed: Vec<u64>,
    /// How many words of instruction memory it has accessed.
    pub from_code: Vec<u64>,
}

impl Block {
    /// Its first instruction's address.
    pub fn start(&self) -> Option<u32> {
        self.instructions.first().map(|instruction| instruction.address)
    }

    /// The address after its last instruction.
    pub fn end(&self) -> Option<u32> {
        self.instructions.last().map(Instruction::end)
    }
}

/// One block after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The block before; none where recording began.
    pub from: Option<usize>,
    /// The block that ran.
    pub to: usize,
    /// How often.
    pub count: u64,
}

/// What ran between the entry of the recorded function and its return, once or many times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flow {
    /// The instruction set.
    pub isa: Isa,
    /// All blocks.
    pub blocks: Vec<Block>,
    /// All pairs of blocks that ran one after the other.
    pub edges: Vec<Edge>,
}

impl Flow {
    /// How often each block ran.
    pub fn executions(&self) -> Vec<u64> {
        let mut executions = vec![0; self.blocks.len()];
        for edge in &self.edges {
            executions[edge.to] += edge.count;
        }
        executions
    }

    /// How often the recorded function was entered.
    pub fn calls(&self) -> u64 {
        let entries = self.edges.iter().filter(|edge| edge.from.is_none());
        entries.map(|edge| edge.count).sum()
    }

    /// Where an exception came between two blocks, if anywhere: the address before, and the one after. What it cost is not to be
    /// known, so such a flow has no price.
    pub fn interruption(&self) -> Option<(u32, u32)> {
        let edges = self.edges.iter().filter(|edge| edge.count > 0);
        edges.into_iter().find_map(|edge| {
            let last = self.blocks[edge.from?].instructions.last()?;
            let start = self.blocks[edge.to].start()?;
            let expected = match branch::next(self.isa, last) {
                Next::Following => start == last.end(),
                Next::Target(target) => start == target || start == last.end(),
                Next::Anywhere => true,
            };
            (!expected).then_some((last.address, start))
        })
    }

    /// Instructions that ran, those whose condition failed included.
    pub fn instructions(&self) -> u64 {
        let executions = self.executions();
        let lengths = self.blocks.iter().map(|block| block.instructions.len() as u64);
        lengths
            .zip(executions)
            .map(|(length, executions)| length * executions)
            .sum()
    }
}

/// What a plugin has recorded: one flow, or one a call of the function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// The flows.
    pub segments: Vec<Flow>,
}

impl Recording {
    /// How often the recorded functions were entered.
    pub fn calls(&self) -> u64 {
        self.segments.iter().map(Flow::calls).sum()
    }
}
