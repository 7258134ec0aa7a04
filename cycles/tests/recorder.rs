//! The recorder against a core that a test plays, and the file that comes of it.

use cycles::file::{self, FileError};
use cycles::flow::{Edge, Flow, Instruction, Isa, Recording};
use cycles::recorder::{NoRecording, Recorder, Wanted};

const MOV: u32 = 0xe1a0_2003;
const BNE_BACK: u32 = 0x1aff_fffd; // bne .-4
const BX: u32 = 0xe12f_ff1e; // bx lr
const LDMNE: u32 = 0x1891_00f0; // ldmne r1, {r4, r5, r6, r7}

fn recorder(each: bool) -> Recorder {
    Recorder::new(Wanted {
        isa: Isa::Arm,
        entries: vec![0x200],
        each,
        code_end: 0x8000,
    })
}

fn block(address: u32, words: &[u32]) -> Vec<Instruction> {
    let addresses = (address..).step_by(4);
    let instruction = |(address, &encoding)| Instruction {
        address,
        encoding,
        bytes: 4,
    };
    addresses.zip(words).map(instruction).collect()
}

/// Edges by the addresses of their blocks.
fn edges(flow: &Flow) -> Vec<(Option<u32>, u32, u64)> {
    let start = |number: usize| flow.blocks[number].start().expect("a block has an instruction");
    let by_address = |edge: &Edge| (edge.from.map(start), start(edge.to), edge.count);
    let mut edges: Vec<_> = flow.edges.iter().map(by_address).collect();
    edges.sort_unstable();
    edges
}

#[test]
fn recording_is_on_from_the_entry_to_the_return() {
    let mut recorder = recorder(false);
    let caller = recorder.block(block(0x100, &[MOV, 0xeb00_003d])); // bl 0x200
    let after = recorder.block(block(0x108, &[MOV]));
    let loops = recorder.block(block(0x200, &[MOV, BNE_BACK]));
    let ends = recorder.block(block(0x208, &[BX]));
    for _ in 0..2 {
        for number in [caller, loops, loops, loops, ends, after] {
            recorder.executed(number);
        }
    }
    let recording = recorder.finish().expect("the call has returned");
    let [flow] = &recording.segments[..] else {
        panic!("one flow: {recording:?}")
    };
    let expected = [(None, 0x200, 2), (Some(0x200), 0x200, 4), (Some(0x200), 0x208, 2)];
    assert_eq!(edges(flow), expected);
    assert_eq!(
        (flow.calls(), flow.instructions(), flow.interruption()),
        (2, 14, None)
    );
}

#[test]
fn each_call_is_a_flow_of_its_own_where_that_is_wanted() {
    let mut recorder = recorder(true);
    let caller = recorder.block(block(0x100, &[0xeb00_003e])); // bl 0x200
    let entry = recorder.block(block(0x200, &[MOV, BNE_BACK]));
    let ends = recorder.block(block(0x208, &[BX]));
    let after = recorder.block(block(0x104, &[MOV]));
    for loops in [1, 3] {
        recorder.executed(caller);
        (0..loops).for_each(|_| recorder.executed(entry));
        recorder.executed(ends);
        recorder.executed(after);
    }
    let recording = recorder.finish().expect("both have returned");
    let counts: Vec<u64> = recording.segments.iter().map(Flow::instructions).collect();
    assert_eq!(counts, [3, 7]);
}

#[test]
fn what_a_core_did_not_finish_is_not_recorded() {
    let mut recorder = recorder(false);
    let [caller, entry] = [block(0x100, &[MOV]), block(0x200, &[MOV])].map(|block| recorder.block(block));
    recorder.executed(caller);
    recorder.executed(entry);
    assert_eq!(recorder.finish(), Err(NoRecording::Unfinished));
}

#[test]
fn a_caller_may_be_of_another_instruction_set_but_nothing_that_is_called() {
    let run = |calls_foreign: bool| {
        let mut recorder = recorder(false);
        let caller = recorder.foreign_block(0x100..0x106);
        let entry = recorder.block(block(0x200, &[MOV, BX]));
        let other = recorder.foreign_block(0x300..0x302);
        let after = recorder.foreign_block(0x106..0x108);
        let way = [caller, entry, other, after];
        let ran = way.into_iter().filter(|&number| calls_foreign || number != other);
        ran.for_each(|number| recorder.executed(number));
        recorder.finish()
    };
    let recording = run(false).expect("it has returned");
    assert_eq!(recording.segments[0].instructions(), 2);
    assert_eq!(run(true), Err(NoRecording::Foreign(0x300)));
}

/// An access to a device ends a block in its middle, and the core goes on in a block that begins there.
#[test]
fn a_block_that_was_left_early_counts_for_what_of_it_ran() {
    let mut recorder = recorder(false);
    let caller = recorder.block(block(0x100, &[MOV]));
    let whole = recorder.block(block(0x200, &[MOV, MOV, MOV, BX]));
    let rest = recorder.block(block(0x208, &[MOV, BX]));
    let after = recorder.block(block(0x104, &[MOV]));
    for way in [&[caller, whole, after][..], &[caller, whole, rest, after]] {
        way.iter().for_each(|&number| recorder.executed(number));
    }
    let recording = recorder.finish().expect("both have returned");
    let flow = &recording.segments[0];
    assert_eq!(flow.instructions(), 8);
    let lengths: Vec<usize> = flow.blocks.iter().map(|block| block.instructions.len()).collect();
    assert_eq!((lengths, flow.calls()), (vec![4, 2, 2], 2));
    assert_eq!(flow.interruption(), None);
}

/// What comes after a block is not where its last instruction could go.
#[test]
fn an_exception_is_found() {
    let mut recorder = recorder(false);
    let caller = recorder.block(block(0x100, &[MOV]));
    let entry = recorder.block(block(0x200, &[MOV, BNE_BACK]));
    let handler = recorder.block(block(0x18, &[MOV, BX]));
    let after = recorder.block(block(0x104, &[MOV]));
    for number in [caller, entry, handler, entry, after] {
        recorder.executed(number);
    }
    let recording = recorder.finish().expect("it has returned");
    assert_eq!(recording.segments[0].interruption(), Some((0x204, 0x18)));
}

/// A load of four registers is four accesses, and happens once. Of instruction memory each word counts.
#[test]
fn accesses_are_counted_once_an_execution() {
    let mut recorder = recorder(false);
    let caller = recorder.block(block(0x100, &[MOV]));
    let entry = recorder.block(block(0x200, &[LDMNE, BNE_BACK]));
    let after = recorder.block(block(0x104, &[MOV]));
    assert_eq!(recorder.watched(entry), [true, false]);
    // Before the call nothing counts.
    recorder.accessed(entry, 0, 0x40_0000);
    recorder.executed(caller);
    for (accesses, address) in [(4, 0x40_0000), (0, 0), (4, 0x1000)] {
        recorder.executed(entry);
        (0..accesses).for_each(|_| recorder.accessed(entry, 0, address));
    }
    recorder.executed(after);
    let recording = recorder.finish().expect("it has returned");
    let block = &recording.segments[0].blocks[0];
    assert_eq!(
        (&block.passed[..], &block.from_code[..]),
        (&[2, 0][..], &[4, 0][..])
    );
}

#[test]
fn a_file_reads_back_the_same_and_what_is_none_is_refused_by_name() {
    let mut recorder = recorder(true);
    let caller = recorder.block(block(0x100, &[MOV]));
    let entry = recorder.block(block(0x200, &[LDMNE, MOV]));
    let after = recorder.block(block(0x104, &[MOV]));
    for number in [caller, entry, after] {
        recorder.executed(number);
    }
    let recording: Recording = recorder.finish().expect("it has returned");
    let bytes = file::encode(&recording);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flow");
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("it can be written");
        file::read(&path)
    };
    assert_eq!(read(&bytes).expect("a recording"), recording);
    assert!(matches!(read(b"something else"), Err(FileError::Magic(_))));
    assert!(matches!(
        read(&bytes[..bytes.len() - 1]),
        Err(FileError::Damaged(_))
    ));
    let mut newer = bytes.clone();
    newer[8] += 1;
    let error = read(&newer).expect_err("another version").to_string();
    assert!(
        error.contains("version 3") && error.contains("record it again"),
        "{error}"
    );
    let missing = file::read(&folder.path().join("no-such")).expect_err("no file");
    assert!(matches!(missing, FileError::Read { .. }));
}
