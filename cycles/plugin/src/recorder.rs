//! What is remembered of each block while a core runs.

use std::collections::HashMap;

use cycles::access::conditional_accesses;
use cycles::flow::{Block, Edge, Flow, Instruction, Isa, Recording};

/// A block that was translated, the same for all its translations.
pub(crate) struct Seen {
    block: Block,
    index: usize,
    start: u32,
    end: u32,
    is_entry: bool,
    executions: u64,
    /// The blocks that ran before, by their index, and how often. The one before last time comes first: it mostly comes again.
    before: Vec<(usize, u64)>,
    /// The execution in which each instruction last accessed memory: a load of many registers is many accesses.
    accessed: Vec<u64>,
}

/// Stands for "no block before" among indices.
const NONE: usize = usize::MAX;

/// Where and how to record.
pub(crate) struct Wanted {
    /// The instruction set.
    pub(crate) isa: Isa,
    /// The functions' first addresses.
    pub(crate) entries: Vec<u32>,
    /// Whether each call is a flow of its own.
    pub(crate) each: bool,
}

/// Records while the core is in one of the wanted functions.
pub(crate) struct Recorder {
    wanted: Wanted,
    blocks: HashMap<Vec<Instruction>, *mut Seen>,
    order: Vec<*mut Seen>,
    /// The block that ran last, and where it ended.
    last: usize,
    last_end: u32,
    /// Where the recorded call returns to, while one is recorded.
    returns_to: Option<u32>,
    segments: Vec<Flow>,
}

impl Recorder {
    /// Has seen nothing yet.
    pub(crate) fn new(wanted: Wanted) -> Self {
        Self {
            wanted,
            blocks: HashMap::new(),
            order: Vec::new(),
            last: NONE,
            last_end: 0,
            returns_to: None,
            segments: Vec::new(),
        }
    }

    /// The block of these instructions, and which of them have to report their accesses.
    pub(crate) fn block(&mut self, instructions: Vec<Instruction>) -> (*mut Seen, Vec<bool>) {
        let conditional = conditional_accesses(self.wanted.isa, &instructions);
        let (order, wanted) = (&mut self.order, &self.wanted);
        let seen = self
            .blocks
            .entry(instructions)
            .or_insert_with_key(|instructions| {
                let block = Block {
                    instructions: instructions.clone(),
                    passed: vec![0; instructions.len()],
                };
                let start = block.start().unwrap_or_default();
                let seen = Box::into_raw(Box::new(Seen {
                    index: order.len(),
                    start,
                    end: block.end().unwrap_or_default(),
                    is_entry: wanted.entries.contains(&start),
                    executions: 0,
                    before: Vec::new(),
                    accessed: vec![0; instructions.len()],
                    block,
                }));
                order.push(seen);
                seen
            });
        (*seen, conditional)
    }

    /// Takes note that a block runs.
    #[inline]
    pub(crate) fn executed(&mut self, seen: &mut Seen) {
        match self.returns_to {
            Some(address) if address == seen.start => self.returned(),
            Some(_) => seen.follow(self.last),
            None if seen.is_entry => {
                self.returns_to = Some(self.last_end);
                seen.follow(NONE);
            }
            None => {}
        }
        (self.last, self.last_end) = (seen.index, seen.end);
    }

    /// Takes note that an instruction of a block that runs accesses memory.
    #[inline]
    pub(crate) fn accessed(&mut self, seen: &mut Seen, place: usize) {
        if self.returns_to.is_some() && seen.accessed[place] != seen.executions {
            seen.accessed[place] = seen.executions;
            seen.block.passed[place] += 1;
        }
    }

    #[cold]
    fn returned(&mut self) {
        self.returns_to = None;
        if self.wanted.each {
            let flow = self.take_flow();
            self.segments.push(flow);
        }
    }

    /// All that was recorded; nothing where a call has not returned.
    pub(crate) fn finish(&mut self) -> Option<Recording> {
        if self.returns_to.is_some() {
            return None;
        }
        if !self.wanted.each {
            let flow = self.take_flow();
            self.segments.push(flow);
        }
        Some(Recording {
            segments: std::mem::take(&mut self.segments),
        })
    }

    /// What has been counted since the last time, with the blocks that ran in it only.
    fn take_flow(&mut self) -> Flow {
        let mut flow = Flow {
            isa: self.wanted.isa,
            blocks: Vec::new(),
            edges: Vec::new(),
        };
        let mut places = HashMap::new();
        let mut edges = Vec::new();
        for &seen in &self.order {
            // SAFETY: it is of `Box::into_raw` and never freed, and no callback runs beside this one.
            let seen = unsafe { &mut *seen };
            let before = std::mem::take(&mut seen.before);
            if before.is_empty() {
                continue;
            }
            places.insert(seen.index, flow.blocks.len());
            flow.blocks.push(seen.block.clone());
            seen.block.passed.fill(0);
            edges.extend(before.into_iter().map(|(from, count)| (from, seen.index, count)));
        }
        flow.edges = edges
            .into_iter()
            .map(|(from, to, count)| Edge {
                from: (from != NONE).then(|| places[&from]),
                to: places[&to],
                count,
            })
            .collect();
        flow
    }
}

impl Seen {
    #[inline]
    fn follow(&mut self, before: usize) {
        self.executions += 1;
        match self.before.first_mut() {
            Some((first, count)) if *first == before => *count += 1,
            _ => self.follow_another(before),
        }
    }

    fn follow_another(&mut self, before: usize) {
        match self.before.iter().position(|(known, _)| *known == before) {
            Some(place) => {
                self.before[place].1 += 1;
                self.before.swap(0, place);
            }
            None => self.before.push((before, 1)),
        }
    }
}
