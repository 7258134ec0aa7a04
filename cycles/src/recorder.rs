//! Writes a flow down while a core runs. Whoever runs the core says what it does; the plugin of QEMU's, or a test.

use std::collections::HashMap;
use std::ops::Range;

use crate::branch::cut;
use crate::flow::{Block, Edge, Flow, Instruction, Isa, Recording};
use crate::price::watched;

/// Where and how to record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The instruction set.
    pub isa: Isa,
    /// The functions' first addresses.
    pub entries: Vec<u32>,
    /// Whether each call is a flow of its own.
    pub each: bool,
    /// Accesses below this address are of instruction memory.
    pub code_end: u32,
}

/// Why there is no recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRecording {
    /// A call has not returned.
    #[error("the core ended within the recorded function")]
    Unfinished,
    /// What is recorded is of one instruction set.
    #[error(
        "the recorded function runs code of another instruction set at {0:#x}: what it calls must be compiled as it is"
    )]
    Foreign(u32),
}

/// A block, and what was counted of it.
#[derive(Debug)]
struct Seen {
    /// Without instructions where they are of another instruction set.
    block: Block,
    start: u32,
    end: u32,
    is_entry: bool,
    executions: u64,
    /// The blocks that ran before, and how often. The one of the last time comes first: it mostly comes again.
    before: Vec<(usize, u64)>,
    /// The execution in which each instruction last accessed memory: a load of many registers is many accesses.
    accessed: Vec<u64>,
}

/// Stands for "no block before".
const NONE: usize = usize::MAX;

/// Records while the core is in one of the wanted functions.
#[derive(Debug)]
pub struct Recorder {
    wanted: Wanted,
    known: HashMap<Vec<Instruction>, usize>,
    known_foreign: HashMap<Range<u32>, usize>,
    seen: Vec<Seen>,
    /// The block that ran last, the one before it, and where the last ended.
    last: usize,
    last_but_one: usize,
    last_end: u32,
    /// Where the recorded call returns to, while one is recorded.
    returns_to: Option<u32>,
    /// Where a recorded call first ran code of another instruction set.
    foreign: Option<u32>,
    segments: Vec<Flow>,
}

impl Recorder {
    /// Has seen nothing yet.
    pub fn new(wanted: Wanted) -> Self {
        Self {
            wanted,
            known: HashMap::new(),
            known_foreign: HashMap::new(),
            seen: Vec::new(),
            last: NONE,
            last_but_one: NONE,
            last_end: 0,
            returns_to: None,
            foreign: None,
            segments: Vec::new(),
        }
    }

    /// The instruction set.
    pub fn isa(&self) -> Isa {
        self.wanted.isa
    }

    /// The number of the block of these instructions: the same whenever they are translated again.
    pub fn block(&mut self, instructions: Vec<Instruction>) -> usize {
        if let Some(&number) = self.known.get(&instructions) {
            return number;
        }
        let length = instructions.len();
        let block = Block {
            instructions: instructions.clone(),
            passed: vec![0; length],
            from_code: vec![0; length],
        };
        let extent = block.start().unwrap_or_default()..block.end().unwrap_or_default();
        let number = self.add(extent, block);
        self.known.insert(instructions, number);
        number
    }

    /// The number of a block of another instruction set, which may call the recorded function and be returned to.
    pub fn foreign_block(&mut self, extent: Range<u32>) -> usize {
        if let Some(&number) = self.known_foreign.get(&extent) {
            return number;
        }
        let number = self.add(extent.clone(), Block::default());
        self.known_foreign.insert(extent, number);
        number
    }

    fn add(&mut self, Range { start, end }: Range<u32>, block: Block) -> usize {
        self.seen.push(Seen {
            start,
            end,
            is_entry: self.wanted.entries.contains(&start),
            executions: 0,
            before: Vec::new(),
            accessed: vec![0; block.instructions.len()],
            block,
        });
        self.seen.len() - 1
    }

    /// Which instructions of a block have to report their accesses to memory.
    pub fn watched(&self, number: usize) -> Vec<bool> {
        watched(self.wanted.isa, &self.seen[number].block.instructions)
    }

    /// A block begins to run.
    #[inline]
    pub fn executed(&mut self, number: usize) {
        let seen = &mut self.seen[number];
        match self.returns_to {
            Some(address) if address == seen.start => self.returned(),
            Some(_) => match seen.before.first_mut() {
                Some((before, count)) if *before == self.last => {
                    *count += 1;
                    seen.executions += 1;
                }
                _ => self.follows_another(number),
            },
            None if seen.is_entry => {
                self.returns_to = Some(self.last_end);
                self.last = NONE;
                self.follows_another(number);
            }
            None => {}
        }
        self.last_but_one = std::mem::replace(&mut self.last, number);
        self.last_end = self.seen[number].end;
    }

    /// An instruction of a block that runs accesses memory.
    #[inline]
    pub fn accessed(&mut self, number: usize, place: usize, address: u32) {
        let seen = &mut self.seen[number];
        // What runs apart from its block, for a device, is in no call's execution.
        if self.returns_to.is_none() || seen.executions == 0 {
            return;
        }
        seen.block.from_code[place] += u64::from(address < self.wanted.code_end);
        if seen.accessed[place] != seen.executions {
            seen.accessed[place] = seen.executions;
            seen.block.passed[place] += 1;
        }
    }

    /// A block runs after another than the last time.
    fn follows_another(&mut self, number: usize) {
        if self.seen[number].block.instructions.is_empty() {
            self.foreign.get_or_insert(self.seen[number].start);
        }
        let (last, seen) = (self.last, &mut self.seen[number]);
        if let Some(place) = seen.before.iter().position(|&(before, _)| before == last) {
            seen.before.swap(0, place);
        } else if let Some(before) = self.cut_short(number) {
            // It did not run to its end: count it as the shorter block that ran in its place.
            self.last = before;
            return self.follows_another(number);
        } else {
            self.seen[number].before.insert(0, (last, 0));
        }
        let seen = &mut self.seen[number];
        seen.before[0].1 += 1;
        seen.executions += 1;
    }

    /// Where the last block was left before its end, for an access to a device or an exception, and went on in a block that begins
    /// within it: the part of it that ran, which is counted in its place.
    fn cut_short(&mut self, number: usize) -> Option<usize> {
        let last = self.seen.get(self.last)?;
        let length = cut(self.wanted.isa, &last.block.instructions, self.seen[number].start)?;
        let part = self.block(self.seen[self.last].block.instructions[..length].to_vec());
        let (whole, before) = (self.last, self.last_but_one);
        let place = self.seen[whole]
            .before
            .iter()
            .position(|&(known, _)| known == before)?;
        self.seen[whole].before[place].1 -= 1;
        self.seen[whole].executions -= 1;
        self.last = before;
        self.follows_another(part);
        Some(part)
    }

    fn returned(&mut self) {
        self.returns_to = None;
        if self.wanted.each {
            self.end_segment();
        }
    }

    /// All that was recorded.
    pub fn finish(mut self) -> Result<Recording, NoRecording> {
        if let Some(address) = self.foreign {
            return Err(NoRecording::Foreign(address));
        }
        if self.returns_to.is_some() {
            return Err(NoRecording::Unfinished);
        }
        if !self.wanted.each {
            self.end_segment();
        }
        Ok(Recording {
            segments: self.segments,
        })
    }

    /// Makes a flow of what has been counted since the last one, with the blocks that ran in it only.
    fn end_segment(&mut self) {
        let mut flow = Flow {
            isa: self.wanted.isa,
            blocks: Vec::new(),
            edges: Vec::new(),
        };
        let mut places = HashMap::new();
        let mut edges = Vec::new();
        for (number, seen) in self.seen.iter_mut().enumerate() {
            let mut before = std::mem::take(&mut seen.before);
            before.retain(|&(_, count)| count > 0);
            if before.is_empty() {
                continue;
            }
            places.insert(number, flow.blocks.len());
            flow.blocks.push(seen.block.clone());
            seen.block.passed.fill(0);
            seen.block.from_code.fill(0);
            edges.extend(before.into_iter().map(|(from, count)| (from, number, count)));
        }
        let edge = |(from, to, count)| Edge {
            from: places.get(&from).copied(),
            to: places[&to],
            count,
        };
        flow.edges = edges.into_iter().map(edge).collect();
        self.segments.push(flow);
    }
}
