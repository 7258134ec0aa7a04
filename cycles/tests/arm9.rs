//! The ARM9E-S's table by sequences counted by hand.
//!
//! Sources: ARM's manuals of the ARM9E-S (DDI 0165), of the ARM9EJ-S (DDI 0222), which has its pipeline, and of the ARM7EJ-S (DDI 0214),
//! which has its multiplier; and the ARM System Developer's Guide by Sloss, Symes and Wright ("Guide").

mod sequence;

use cycles::flow::{Flow, Isa};
use cycles::{Assumptions, cycles, price};
use sequence::{flow, straight};

/// What is shown, where it stands, the program, and its cycles.
type Sequence = (&'static str, &'static str, &'static [(&'static str, u32)], u64);

#[rustfmt::skip]
const SEQUENCES: &[Sequence] = &[
    ("an operation of the ALU", "DDI 0222B table 8-2", &[("add r0, r1, r2", 0xe081_0002)], 1),
    ("a shift by a constant is free", "DDI 0222B table 8-2", &[("add r0, r1, r2, lsl #3", 0xe081_0182)], 1),
    ("a shift by a register takes a cycle more", "DDI 0222B table 8-2", &[("add r0, r1, r2, lsl r3", 0xe081_0312)], 2),
    ("leading zeros", "DDI 0222B table 8-2", &[("clz r0, r1", 0xe16f_0f11)], 1),
    ("a loaded word that nobody waits for", "DDI 0222B table 8-2", &[("ldr r0, [r1]", 0xe591_0000), ("mov r2, r3", 0xe1a0_2003)], 2),
    ("a loaded word is late by one cycle", "DDI 0222B table 8-2", &[("ldr r0, [r1]", 0xe591_0000), ("add r2, r0, r3", 0xe080_2003)], 3),
    ("the next instruction but one does not wait", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("mov r4, r5", 0xe1a0_4005), ("add r2, r0, r3", 0xe080_2003)], 3),
    ("a loaded byte is late by two cycles, for the first that needs it", "DDI 0165B page 8-22", &[("ldrb r0, [r1, #1]", 0xe5d1_0001), ("add r2, r0, r3", 0xe080_2003), ("add r4, r0, r5", 0xe080_4005)], 5),
    ("the second instruction after a loaded byte waits one", "DDI 0165B page 8-22", &[("ldrb r0, [r1]", 0xe5d1_0000), ("mov r4, r5", 0xe1a0_4005), ("add r2, r0, r3", 0xe080_2003)], 4),
    ("an instruction of two cycles hides it", "DDI 0165B page 8-22", &[("ldrb r0, [r1]", 0xe5d1_0000), ("mul r6, r7, r8", 0xe006_0897), ("add r4, r0, r5", 0xe080_4005)], 4),
    ("a loaded halfword is late by two cycles", "DDI 0222B table 8-2", &[("ldrh r0, [r1]", 0xe1d1_00b0), ("sub r2, r0, r3", 0xe040_2003)], 4),
    ("a signed one, too", "DDI 0222B table 8-2", &[("ldrsh r0, [r1]", 0xe1d1_00f0), ("sub r2, r0, r3", 0xe040_2003)], 4),
    ("a loaded word is late for being stored", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("str r0, [r2]", 0xe582_0000)], 3),
    ("a loaded word is late as an accumulator", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("mla r2, r3, r4, r0", 0xe022_0493)], 4),
    ("a cycle between hides that", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("mov r5, r6", 0xe1a0_5006), ("str r0, [r2]", 0xe582_0000)], 3),
    ("a base that is late", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("stmia r0, {r1, r2}", 0xe880_0006)], 4),
    ("the first of the stored registers is late", "DDI 0165B page 8-22", &[("ldr r1, [r0]", 0xe590_1000), ("stmia r2, {r1, r3}", 0xe882_000a)], 4),
    ("the second is stored a cycle later", "DDI 0165B page 8-22", &[("ldr r3, [r0]", 0xe590_3000), ("stmia r2, {r1, r3}", 0xe882_000a)], 3),
    ("a scaled offset takes a cycle more", "DDI 0222B table 8-2", &[("ldr r0, [r1, r2, lsl #2]", 0xe791_0102)], 2),
    ("a plain one does not", "DDI 0222B table 8-2", &[("ldr r0, [r1, r2]", 0xe791_0002)], 1),
    ("a scaled offset, and a loaded word that is late", "DDI 0222B table 8-2", &[("ldr r0, [r1, r2, lsl #2]", 0xe791_0102), ("add r3, r0, r4", 0xe080_3004)], 4),
    ("a store with a scaled offset", "DDI 0222B table 8-2", &[("str r0, [r1, r2, lsl #2]", 0xe781_0102)], 2),
    ("a store", "DDI 0222B table 8-2", &[("str r0, [r1, #4]", 0xe581_0004)], 1),
    ("many registers take a cycle each", "DDI 0222B table 8-2", &[("ldmia r0, {r1, r2, r3, r4}", 0xe890_001e)], 4),
    ("the last of many is late", "DDI 0222B table 8-2", &[("ldmia r0, {r1, r2, r3, r4}", 0xe890_001e), ("add r5, r4, r6", 0xe084_5006)], 6),
    ("the last but one is not", "DDI 0222B table 8-2", &[("ldmia r0, {r1, r2, r3, r4}", 0xe890_001e), ("add r5, r3, r6", 0xe083_5006)], 5),
    ("one register takes two cycles", "DDI 0222B table 8-2", &[("ldmia r0, {r1}", 0xe890_0002)], 2),
    ("stored, too", "DDI 0222B table 8-2", &[("stmia r0, {r1}", 0xe880_0002)], 2),
    ("many registers are stored in a cycle each", "DDI 0222B table 8-2", &[("stmdb sp!, {r4, r5, r6, r7, lr}", 0xe92d_40f0)], 5),
    ("the second word of two is late", "DDI 0222B table 8-2", &[("ldrd r2, r3, [r0]", 0xe1c0_20d0), ("add r4, r3, r5", 0xe083_4005)], 4),
    ("the first is not", "DDI 0222B table 8-2", &[("ldrd r2, r3, [r0]", 0xe1c0_20d0), ("add r4, r2, r5", 0xe082_4005)], 3),
    ("two words are stored", "DDI 0222B table 8-2", &[("strd r2, r3, [r0]", 0xe1c0_20f0)], 2),
    ("a product is late by one cycle", "DDI 0214B 9.9.1", &[("mul r0, r1, r2", 0xe000_0291), ("sub r4, r0, r3", 0xe040_4003)], 4),
    ("also for being stored", "DDI 0214B 9.9.1", &[("mla r0, r1, r2, r3", 0xe020_3291), ("str r0, [r8]", 0xe588_0000)], 4),
    ("but not for being added to", "DDI 0214B 9.9.1", &[("mla r0, r1, r2, r0", 0xe020_0291), ("mla r0, r3, r4, r0", 0xe020_0493)], 4),
    ("as a factor it is late", "DDI 0214B 9.9.1", &[("mul r0, r1, r2", 0xe000_0291), ("mul r3, r0, r4", 0xe003_0490)], 5),
    ("whose flags are set is slow and not late", "DDI 0214B 9.9.1", &[("muls r0, r1, r2", 0xe010_0291), ("sub r4, r0, r3", 0xe040_4003)], 5),
    ("the low word of a long product is in time", "DDI 0214B table 9.12", &[("smull r0, r1, r2, r3", 0xe0c1_0392), ("add r4, r0, r5", 0xe080_4005)], 4),
    ("its high word is late by one cycle", "DDI 0214B table 9.12", &[("smull r0, r1, r2, r3", 0xe0c1_0392), ("add r4, r1, r5", 0xe081_4005)], 5),
    ("long products are summed without a wait", "DDI 0214B 9.9.1", &[("smull r0, r1, r2, r3", 0xe0c1_0392), ("smlal r0, r1, r4, r5", 0xe0e1_0594)], 6),
    ("a high word is late as a factor", "DDI 0214B 9.9.1", &[("smull r0, r1, r2, r3", 0xe0c1_0392), ("smull r4, r5, r1, r6", 0xe0c5_4691)], 7),
    ("a long product whose flags are set", "DDI 0214B 9.9.1", &[("umulls r0, r1, r2, r3", 0xe091_0392), ("add r4, r1, r5", 0xe081_4005)], 6),
    ("a product of halfwords takes one cycle and is late by one", "Guide D.5", &[("smulbb r0, r1, r2", 0xe160_0281), ("add r3, r0, r4", 0xe080_3004)], 3),
    ("and is added to without a wait", "Guide D.5", &[("smulbb r0, r1, r2", 0xe160_0281), ("smlabb r0, r3, r4, r0", 0xe100_0483)], 2),
    ("its sum in 64 bits takes two", "Guide D.5", &[("smlalbb r0, r1, r2, r3", 0xe141_0382)], 2),
    ("a saturated sum is late by one cycle", "DDI 0214B 9.10.1", &[("qadd r0, r1, r2", 0xe102_0051), ("sub r4, r0, r3", 0xe040_4003)], 3),
    ("but not for being stored", "DDI 0214B 9.10.1", &[("qsub r0, r1, r2", 0xe122_0051), ("str r0, [r8]", 0xe588_0000)], 2),
    ("nor as an accumulator", "DDI 0214B 9.10.1", &[("qadd r0, r4, r5", 0xe105_0054), ("mla r0, r3, r4, r0", 0xe020_0493)], 3),
    ("what waits once need not wait again", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("add r2, r0, r3", 0xe080_2003), ("add r4, r0, r5", 0xe080_4005)], 4),
    ("a register that is written anew is in time", "DDI 0165B page 8-22", &[("ldr r0, [r1]", 0xe591_0000), ("mov r0, r2", 0xe1a0_0002), ("add r3, r0, r4", 0xe080_3004)], 3),
];

#[test]
fn every_sequence_takes_the_cycles_that_the_manuals_give() {
    for &(about, source, program, expected) in SEQUENCES {
        let words: Vec<u32> = program.iter().map(|&(_, word)| word).collect();
        let found = cycles(&straight(Isa::Arm, &words), 0);
        let text: Vec<&str> = program.iter().map(|&(text, _)| text).collect();
        assert_eq!(
            (found.low, found.likely, found.high),
            (expected, expected, expected),
            "{about} ({source}): {}",
            text.join("; ")
        );
    }
}

const MOV: u32 = 0xe1a0_2003; // mov r2, r3
const LDR: u32 = 0xe591_0000; // ldr r0, [r1]
const LDRB: u32 = 0xe5d1_0000; // ldrb r0, [r1]
const ADD: u32 = 0xe080_2003; // add r2, r0, r3
const LDRNE: u32 = 0x1591_0000; // ldrne r0, [r1]
const BNE: u32 = 0x1a00_0000; // bne .+8
const B: u32 = 0xea00_0000; // b .+8
const BL: u32 = 0xeb00_0000; // bl .+8
const BX: u32 = 0xe12f_ff1e; // bx lr

fn likely(flow: &Flow) -> u64 {
    cycles(flow, 0).likely
}

/// `first`, then what is at its end or beyond it, by one edge.
fn pair(first: &[u32], second: &[u32], skipped: bool) -> Flow {
    let between = [MOV];
    let blocks: &[&[u32]] = if skipped {
        &[first, &between, second]
    } else {
        &[first, second]
    };
    let to = blocks.len() - 1;
    flow(Isa::Arm, blocks, &[(None, 0, 1), (Some(0), to, 1)])
}

/// Guide, D.5: B, BL and BX take 3 cycles, and a branch whose condition fails takes 1.
#[test]
fn a_branch_takes_three_cycles_where_it_is_taken_and_one_where_not() {
    assert_eq!(likely(&pair(&[BNE], &[MOV], true)), 3 + 1);
    assert_eq!(likely(&pair(&[BNE], &[MOV], false)), 1 + 1);
    assert_eq!(likely(&pair(&[B], &[MOV], true)), 3 + 1);
    assert_eq!(likely(&pair(&[B], &[MOV], false)), 3 + 1);
    assert_eq!(likely(&pair(&[BL], &[MOV], true)), 3 + 1);
    // The last block goes back to the caller.
    assert_eq!(likely(&pair(&[BL], &[MOV, BX], true)), 3 + 1 + 3);
    assert_eq!(likely(&straight(Isa::Arm, &[0xe12f_ff33])), 3); // blx r3
    assert_eq!(likely(&straight(Isa::Arm, &[0xe1a0_f00e])), 3); // mov pc, lr
    assert_eq!(likely(&straight(Isa::Arm, &[0xe08f_f110])), 4); // add pc, pc, r0, lsl r1
}

/// DDI 0222B, table 8-2: 5 cycles, 6 with a scaled offset, and n + 4 of many registers.
#[test]
fn a_load_of_the_program_counter_is_a_jump() {
    assert_eq!(likely(&straight(Isa::Arm, &[0xe591_f000])), 5); // ldr pc, [r1]
    assert_eq!(likely(&straight(Isa::Arm, &[0xe791_f102])), 6); // ldr pc, [r1, r2, lsl #2]
    assert_eq!(likely(&straight(Isa::Arm, &[0xe8bd_8070])), 8); // pop {r4, r5, r6, pc}
    assert_eq!(likely(&straight(Isa::Arm, &[0xe49d_f004])), 5); // pop {pc}
    // Not taken: its condition has failed.
    assert_eq!(likely(&pair(&[0x1591_f000], &[MOV], false)), 1 + 1); // ldrne pc, [r1]
}

/// DDI 0165B, page 8-22: interlocks are between instructions, wherever QEMU parts its blocks.
#[test]
fn interlocks_reach_across_blocks() {
    assert_eq!(likely(&pair(&[LDR], &[ADD], false)), 1 + 1 + 1);
    assert_eq!(likely(&pair(&[LDRB, BNE], &[ADD], false)), 1 + 1 + 1 + 1);
    // A taken branch passes the time.
    assert_eq!(likely(&pair(&[LDRB, BNE], &[ADD], true)), 1 + 3 + 1);
    // And a product's: smull r0, r1, r2, r3; bne; add r4, r1, r5.
    assert_eq!(likely(&pair(&[0xe0c1_0392], &[0xe081_4005], false)), 3 + 1 + 1);
}

/// The same block is entered from two sides, of which one makes it wait.
#[test]
fn a_block_is_priced_after_every_block_that_ran_before_it() {
    let blocks: &[&[u32]] = &[&[BNE], &[LDR], &[ADD]];
    let edges = [(None, 0, 10), (Some(0), 1, 4), (Some(0), 2, 6), (Some(1), 2, 4)];
    let flow = flow(Isa::Arm, blocks, &edges);
    assert_eq!(likely(&flow), (4 + 6 * 3) + 4 + (10 + 4));
    let prices = price(&flow, Assumptions::default());
    assert_eq!(
        prices.iter().map(|priced| priced.executions).collect::<Vec<_>>(),
        [10, 4, 10]
    );
    assert_eq!(
        (prices[2].load_stalls, prices[2].multiply_stalls, prices[2].cycles),
        (4, 0, 14)
    );
}

/// Guide, D.5: an instruction whose condition fails takes one cycle. Of accesses the recording says how often that was.
#[test]
fn a_failed_condition_takes_a_cycle_and_keeps_nobody_waiting() {
    let mut flow = flow(Isa::Arm, &[&[LDRNE, ADD]], &[(None, 0, 10)]);
    flow.blocks[0].passed[0] = 3;
    assert_eq!(likely(&flow), 10 + 3 + 10);
    // ldmne r1, {r4, r5, r6, r7}: 4 cycles of those that happened, 1 of the others.
    let mut flow = straight(Isa::Arm, &[0x1891_00f0]);
    flow.edges[0].count = 10;
    flow.blocks[0].passed[0] = 3;
    assert_eq!(likely(&flow), 3 * 4 + 7);
}

/// Whether a product was computed leaves no trace: its price has bounds.
#[test]
fn what_a_recording_does_not_show_is_between_bounds() {
    let found = cycles(&straight(Isa::Arm, &[0x1000_0291]), 0); // mulne r0, r1, r2
    assert_eq!((found.low, found.likely, found.high), (1, 2, 2));
    let found = cycles(&straight(Isa::Arm, &[0x11a0_0211]), 0); // movne r0, r1, lsl r2
    assert_eq!((found.low, found.likely, found.high), (1, 2, 2));
    let found = cycles(&straight(Isa::Arm, &[0x11a0_2003]), 0); // movne r2, r3
    assert_eq!((found.low, found.likely, found.high), (1, 1, 1));
}

#[test]
fn literals_in_instruction_memory_cost_what_is_assumed() {
    let mut flow = flow(Isa::Arm, &[&[LDR, MOV]], &[(None, 0, 10)]);
    flow.blocks[0].passed[0] = 10;
    flow.blocks[0].from_code[0] = 4;
    let total = |code_access| cycles(&flow, code_access).likely;
    assert_eq!((total(0), total(1), total(2)), (20, 24, 28));
}
