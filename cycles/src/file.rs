//! A recording as a file: a magic number, a version, and little-endian words.

use std::io;
use std::path::{Path, PathBuf};

use crate::flow::{Block, Edge, Flow, Instruction, Isa, Recording};

const MAGIC: [u8; 8] = *b"armflow\n";
const VERSION: u32 = 2;
/// Stands for "no block before".
const NONE: u32 = u32::MAX;

/// Why a file is no recording.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("cannot read the recording {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// It is something else.
    #[error("{} is no recording of a flow: record it again", .0.display())]
    Magic(PathBuf),
    /// It is of another version.
    #[error("{} is a recording of version {version}, and this program reads {VERSION}: record it again", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: u32,
    },
    /// It ends too early, or speaks of blocks that are not there.
    #[error("{} is damaged or cut short: record it again", .0.display())]
    Damaged(PathBuf),
}

/// The bytes of a recording's file.
pub fn encode(recording: &Recording) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    put(&mut bytes, VERSION);
    put(&mut bytes, recording.segments.len() as u32);
    for flow in &recording.segments {
        put(&mut bytes, matches!(flow.isa, Isa::Thumb).into());
        put(&mut bytes, flow.blocks.len() as u32);
        for block in &flow.blocks {
            put(&mut bytes, block.instructions.len() as u32);
            let counts = block.passed.iter().zip(&block.from_code);
            for (instruction, (passed, from_code)) in block.instructions.iter().zip(counts) {
                put(&mut bytes, instruction.address);
                put(&mut bytes, instruction.encoding);
                put(&mut bytes, instruction.bytes.into());
                bytes.extend(passed.to_le_bytes());
                bytes.extend(from_code.to_le_bytes());
            }
        }
        put(&mut bytes, flow.edges.len() as u32);
        for edge in &flow.edges {
            put(&mut bytes, edge.from.map_or(NONE, |from| from as u32));
            put(&mut bytes, edge.to as u32);
            bytes.extend(edge.count.to_le_bytes());
        }
    }
    bytes
}

/// Reads a recording.
pub fn read(path: &Path) -> Result<Recording, FileError> {
    let bytes = std::fs::read(path).map_err(|cause| FileError::Read {
        path: path.to_owned(),
        cause,
    })?;
    let mut rest = bytes.as_slice();
    if take(&mut rest) != Some(MAGIC) {
        return Err(FileError::Magic(path.to_owned()));
    }
    let damaged = || FileError::Damaged(path.to_owned());
    let version = word(&mut rest).ok_or_else(damaged)?;
    if version != VERSION {
        return Err(FileError::Version {
            path: path.to_owned(),
            version,
        });
    }
    let recording = recording(&mut rest).filter(|_| rest.is_empty());
    recording.ok_or_else(damaged)
}

fn recording(rest: &mut &[u8]) -> Option<Recording> {
    let segments = (0..word(rest)?).map(|_| flow(rest)).collect::<Option<_>>()?;
    Some(Recording { segments })
}

fn flow(rest: &mut &[u8]) -> Option<Flow> {
    let isa = match word(rest)? {
        0 => Isa::Arm,
        1 => Isa::Thumb,
        _ => return None,
    };
    let blocks: Vec<Block> = (0..word(rest)?).map(|_| block(rest)).collect::<Option<_>>()?;
    let edges = (0..word(rest)?)
        .map(|_| edge(rest, blocks.len()))
        .collect::<Option<_>>()?;
    Some(Flow { isa, blocks, edges })
}

fn block(rest: &mut &[u8]) -> Option<Block> {
    let mut block = Block::default();
    for _ in 0..word(rest)? {
        block.instructions.push(Instruction {
            address: word(rest)?,
            encoding: word(rest)?,
            bytes: u8::try_from(word(rest)?)
                .ok()
                .filter(|bytes| matches!(bytes, 2 | 4))?,
        });
        block.passed.push(double(rest)?);
        block.from_code.push(double(rest)?);
    }
    (!block.instructions.is_empty()).then_some(block)
}

fn edge(rest: &mut &[u8], blocks: usize) -> Option<Edge> {
    let known = |index: u32| Some(index as usize).filter(|&index| index < blocks);
    let from = match word(rest)? {
        NONE => None,
        from => Some(known(from)?),
    };
    let (to, count) = (known(word(rest)?)?, double(rest)?);
    Some(Edge { from, to, count })
}

fn put(bytes: &mut Vec<u8>, word: u32) {
    bytes.extend(word.to_le_bytes());
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(*first)
}

fn word(rest: &mut &[u8]) -> Option<u32> {
    take(rest).map(u32::from_le_bytes)
}

fn double(rest: &mut &[u8]) -> Option<u64> {
    take(rest).map(u64::from_le_bytes)
}
