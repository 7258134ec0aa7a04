//! The hottest basic blocks, with their instructions in the assembler's words.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;

use cycles::flow;
use cycles::flow::Flow;

use super::account::total;
use super::code::Code;
use super::cost::Cost;
use super::run::{Block, Instruction};
use crate::platform::interrupt;

/// Why there is no disassembly.
#[derive(Debug, thiserror::Error)]
pub enum DisassemblyError {
    /// The debugger could not be run.
    #[error("cannot run {}", debugger.display())]
    Start {
        /// The debugger.
        debugger: PathBuf,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },
    /// It did not answer as expected.
    #[error("{} gave no instruction at {address:#010x} of {}:\n{said}", debugger.display(), elf.display())]
    Answer {
        /// The debugger.
        debugger: PathBuf,
        /// The image.
        elf: PathBuf,
        /// The instruction asked for.
        address: u32,
        /// What it said.
        said: String,
    },
}

/// A block that ran: its instructions' costs by address.
type Run = Vec<(u32, Cost)>;

/// The `count` basic blocks that took most cycles, the hottest first, but for what they say.
pub(super) fn hottest(flow: &Flow, costs: &BTreeMap<u32, Cost>, code: &Code, count: usize) -> Vec<Block> {
    let mut runs: Vec<(Cost, Run)> = basic_blocks(flow, costs)
        .into_iter()
        .map(|run| (total(run.iter().map(|(_, cost)| cost)), run))
        .collect();
    runs.sort_by_key(|(cost, run)| (u64::MAX - cost.cycles, run[0].0));
    runs.truncate(count);
    let instruction = |(address, cost)| Instruction {
        address,
        text: String::new(),
        line: code.line(address).to_owned(),
        cost,
    };
    let block = |(cost, run): (Cost, Run)| Block {
        executions: run[0].1.instructions,
        function: code.word(code.outermost(run[0].0)).to_owned(),
        cost,
        instructions: run.into_iter().map(instruction).collect(),
    };
    runs.into_iter().map(block).collect()
}

/// Cuts what ran into basic blocks. QEMU's blocks are others: a jump into the middle of one begins another there, and a long one is
/// cut where nobody enters it.
fn basic_blocks(flow: &Flow, costs: &BTreeMap<u32, Cost>) -> Vec<Run> {
    let mut leaders = BTreeSet::new();
    for edge in &flow.edges {
        let start = flow.blocks[edge.to].start();
        let end = edge.from.and_then(|from| flow.blocks[from].end());
        if start != end {
            leaders.extend(start);
            leaders.extend(end);
        }
    }
    let instructions = flow.blocks.iter().flat_map(|block| &block.instructions);
    let ends: HashMap<u32, u32> = instructions
        .map(|instruction: &flow::Instruction| (instruction.address, instruction.end()))
        .collect();
    let mut runs: Vec<Run> = Vec::new();
    let mut next = None;
    for (&address, &cost) in costs {
        match runs.last_mut() {
            Some(run) if next == Some(address) && !leaders.contains(&address) => run.push((address, cost)),
            _ => runs.push(vec![(address, cost)]),
        }
        next = ends.get(&address).copied();
    }
    runs
}

/// Has the debugger say what the instructions of these blocks are.
pub(super) fn disassemble(debugger: &Path, elf: &Path, blocks: &mut [Block]) -> Result<(), DisassemblyError> {
    let mut command = Command::new(debugger);
    command.args(["-nx", "--batch"]);
    for block in blocks.iter() {
        if let Some(first) = block.instructions.first() {
            let order = format!("x/{}i {:#x}", block.instructions.len(), first.address);
            command.args(["-ex", &order]);
        }
    }
    let output = interrupt::output(command.arg(elf)).map_err(|cause| DisassemblyError::Start {
        debugger: debugger.to_owned(),
        cause,
    })?;
    let said = String::from_utf8_lossy(&output.stdout);
    let texts: HashMap<u32, String> = said.lines().filter_map(instruction).collect();
    for instruction in blocks.iter_mut().flat_map(|block| &mut block.instructions) {
        let text = texts
            .get(&instruction.address)
            .ok_or_else(|| DisassemblyError::Answer {
                debugger: debugger.to_owned(),
                elf: elf.to_owned(),
                address: instruction.address,
                said: format!("{said}{}", String::from_utf8_lossy(&output.stderr))
                    .trim_end()
                    .to_owned(),
            })?;
        instruction.text = text.clone();
    }
    Ok(())
}

/// Address and words of a line like `   0x28a8 <SYMBOL+4>:\tadd\tr11, sp, #28`, without the symbol of a branch's target.
fn instruction(line: &str) -> Option<(u32, String)> {
    let (place, words) = line.split_once(":\t")?;
    let address = place.trim_start().split(' ').next()?.strip_prefix("0x")?;
    let words = words.split("\t@ ").next()?;
    let words = words.split(" <").next()?.trim_end();
    Some((
        u32::from_str_radix(address, 16).ok()?,
        words.replacen('\t', " ", 1),
    ))
}

#[cfg(test)]
mod tests {
    use cycles::flow::{Edge, Isa};

    use super::super::code::tests::code;
    use super::*;

    #[test]
    fn lines_of_the_debugger_are_read() {
        for (line, expected) in [
            (
                "   0x28a8 <_RNv+4>:\tadd\tr11, sp, #28",
                Some((0x28a8, "add r11, sp, #28")),
            ),
            (
                "   0x28ac <_RNv+8>:\tsub\tsp, sp, #700\t@ 0x2bc",
                Some((0x28ac, "sub sp, sp, #700")),
            ),
            ("=> 0x28b0 <a>:\tbl\t0x100 <_RNvb>", None),
            ("   0x28b0 <a>:\tbl\t0x100 <_RNvb>", Some((0x28b0, "bl 0x100"))),
            ("   0x28b2:\tnop", Some((0x28b2, "nop"))),
            ("No symbol table is loaded.", None),
        ] {
            let expected = expected.map(|(address, words)| (address, words.to_owned()));
            assert_eq!(instruction(line), expected, "{line}");
        }
    }

    #[test]
    fn blocks_are_cut_where_the_flow_goes_elsewhere_and_nowhere_else() {
        let instruction = |address| flow::Instruction {
            address,
            encoding: 0,
            bytes: 4,
        };
        let block = |addresses: &[u32]| flow::Block {
            instructions: addresses.iter().copied().map(instruction).collect(),
            ..flow::Block::default()
        };
        // 0 4 | 8 12 16 with a loop from 16 back to 12, which is a block of its own to QEMU; 20 is reached from 16 only.
        let flow = Flow {
            isa: Isa::Arm,
            blocks: vec![
                block(&[0, 4]),
                block(&[8, 12, 16]),
                block(&[12, 16]),
                block(&[20]),
            ],
            edges: vec![
                Edge {
                    from: None,
                    to: 0,
                    count: 1,
                },
                Edge {
                    from: Some(0),
                    to: 1,
                    count: 1,
                },
                Edge {
                    from: Some(1),
                    to: 2,
                    count: 1,
                },
                Edge {
                    from: Some(2),
                    to: 2,
                    count: 8,
                },
                Edge {
                    from: Some(2),
                    to: 3,
                    count: 1,
                },
            ],
        };
        let cost = |count| Cost {
            cycles: count,
            instructions: count,
            ..Cost::default()
        };
        let costs: BTreeMap<u32, Cost> = [(0, 1), (4, 1), (8, 1), (12, 10), (16, 10), (20, 1)]
            .map(|(at, count)| (at, cost(count)))
            .into();
        let code = code(&[(0, "a"), (4, "a"), (8, "a"), (12, "a > b"), (16, "a"), (20, "a")]);
        let cut = |count| -> Vec<(u64, Vec<u32>)> {
            let blocks = hottest(&flow, &costs, &code, count).into_iter();
            let addresses = |block: &Block| block.instructions.iter().map(|i| i.address).collect();
            blocks
                .map(|block| (block.executions, addresses(&block)))
                .collect()
        };
        assert_eq!(cut(9), [(10, vec![12, 16]), (1, vec![0, 4, 8]), (1, vec![20])]);
        assert_eq!(cut(1).len(), 1);
    }
}
