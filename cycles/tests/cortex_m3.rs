//! The Cortex-M3's table by sequences counted by hand.
//!
//! The source is ARM's manual of the Cortex-M3 (DDI 0337): its table of instructions and what it says of loads and stores.

mod sequence;

use cycles::flow::{Flow, Isa};
use cycles::{Cycles, cycles};
use sequence::{flow, straight};

/// What is shown, where it stands, the program, and its cycles: at least, likely, and at most.
type Sequence = (
    &'static str,
    &'static str,
    &'static [(&'static str, u32)],
    [u64; 3],
);

#[rustfmt::skip]
const SEQUENCES: &[Sequence] = &[
    ("an operation of the ALU", "DDI 0337I table 3-1, Add", &[("adds r0, r1, r2", 0x1888)], [1, 1, 1]),
    ("with a shift, too", "DDI 0337I table 3-1, Add", &[("add.w r0, r1, r2, lsl #3", 0xeb01_00c2)], [1, 1, 1]),
    ("and a shift by a register", "DDI 0337I table 3-1, Shift", &[("lsl.w r0, r1, r2", 0xfa01_f002)], [1, 1, 1]),
    ("a product", "DDI 0337I table 3-1, Multiply", &[("mul r0, r1, r2", 0xfb01_f002)], [1, 1, 1]),
    ("a sum of a product", "DDI 0337I table 3-1, Multiply accumulate", &[("mla r0, r1, r2, r3", 0xfb01_3002)], [2, 2, 2]),
    ("a difference", "DDI 0337I table 3-1, Multiply subtract", &[("mls r0, r1, r2, r3", 0xfb01_3012)], [2, 2, 2]),
    ("a long product, by its factors", "DDI 0337I table 3-1, Long signed", &[("smull r0, r1, r2, r3", 0xfb82_0103)], [3, 4, 5]),
    ("an unsigned one", "DDI 0337I table 3-1, Long unsigned", &[("umull r0, r1, r2, r3", 0xfba2_0103)], [3, 4, 5]),
    ("a sum of a long product", "DDI 0337I table 3-1, Long signed accumulate", &[("smlal r0, r1, r2, r3", 0xfbc2_0103)], [4, 6, 7]),
    ("a quotient, by its operands", "DDI 0337I table 3-1, Unsigned divide", &[("udiv r0, r1, r2", 0xfbb1_f0f2)], [2, 7, 12]),
    ("leading zeros", "DDI 0337I table 3-1, Count leading zeroes", &[("clz r0, r1", 0xfab1_f081)], [1, 1, 1]),
    ("a load", "DDI 0337I table 3-1, Load", &[("ldr r0, [r1]", 0x6808)], [2, 2, 2]),
    ("two loads are pipelined", "DDI 0337I 3.3.2, LDR LDR", &[("ldr r0, [r1]", 0x6808), ("ldr r1, [r2]", 0x6811)], [3, 3, 3]),
    ("a load and a store are, too", "DDI 0337I 3.3.2, LDR STR", &[("ldr.w r0, [r1, r2]", 0xf851_0002), ("str r0, [r3, #20]", 0x6158)], [3, 3, 3]),
    ("also one with an offset in a register", "DDI 0337I 3.3.2, LDR STR", &[("ldr.w r0, [r1, r2]", 0xf851_0002), ("str r1, [r3, r2]", 0x5099)], [3, 3, 3]),
    ("three loads", "DDI 0337I 3.3.2, LDR LDR LDR", &[("ldr.w r0, [r1, r5]", 0xf851_0005), ("ldr r1, [r2]", 0x6811), ("ldr r2, [r3, #4]", 0x685a)], [4, 4, 4]),
    ("not where the address is what was loaded", "DDI 0337I 3.3.2, address", &[("ldr r0, [r1]", 0x6808), ("ldr r2, [r0]", 0x6802)], [4, 4, 4]),
    ("a store with a constant offset", "DDI 0337I 3.3.2, STR", &[("str r0, [r1, #4]", 0x6048)], [1, 1, 1]),
    ("after which nothing is pipelined", "DDI 0337I 3.3.2, STR", &[("str r0, [r1, #4]", 0x6048), ("ldr r2, [r3]", 0x681a)], [3, 3, 3]),
    ("an address that has just been computed", "DDI 0337I 3.3.2, address", &[("adds r1, r2, r3", 0x18d1), ("ldr r0, [r1]", 0x6808), ("mov r4, r5", 0x462c)], [4, 5, 5]),
    ("many registers", "DDI 0337I table 3-1, Load multiple", &[("ldm r0!, {r1, r2, r3}", 0xc80e)], [4, 4, 4]),
    ("and pushed", "DDI 0337I table 3-1, Push", &[("push {r4, lr}", 0xb510)], [3, 3, 3]),
    ("two words", "DDI 0337I table 3-1, Load doubleword", &[("ldrd r0, r1, [r2]", 0xe9d2_0100)], [3, 3, 3]),
    ("a literal, which may meet the fetch unit", "DDI 0337I 3.3.2, literals", &[("ldr r0, [pc, #8]", 0x4802)], [2, 2, 3]),
    ("an IT is folded into what is short before it", "DDI 0337I table 3-1, If-then", &[("cmp r0, #0", 0x2800), ("it ne", 0xbf18), ("movne r1, r2", 0x4611)], [2, 2, 3]),
    ("and not into what is long", "DDI 0337I table 3-1, If-then", &[("cmp.w r8, #0", 0xf1b8_0f00), ("it ne", 0xbf18), ("movne r1, r2", 0x4611)], [2, 3, 3]),
    ("an extension", "DDI 0337I table 3-1, Sign extension", &[("sxtb r0, r1", 0xb248)], [1, 1, 1]),
    ("a bit field", "DDI 0337I table 3-1, Bit field", &[("ubfx r0, r1, #4, #8", 0xf3c1_1007)], [1, 1, 1]),
];

fn bounds(flow: &Flow) -> [u64; 3] {
    let Cycles { low, likely, high } = cycles(flow, 0);
    [low, likely, high]
}

#[test]
fn every_sequence_takes_the_cycles_that_the_manual_gives() {
    for &(about, source, program, expected) in SEQUENCES {
        let words: Vec<u32> = program.iter().map(|&(_, word)| word).collect();
        let text: Vec<&str> = program.iter().map(|&(text, _)| text).collect();
        let found = bounds(&straight(Isa::Thumb, &words));
        assert_eq!(found, expected, "{about} ({source}): {}", text.join("; "));
    }
}

const MOV: u32 = 0x4622; // mov r2, r4

fn pair(first: &[u32], second: &[u32], skipped: bool) -> Flow {
    let between = [MOV];
    let blocks: &[&[u32]] = if skipped {
        &[first, &between, second]
    } else {
        &[first, second]
    };
    let to = blocks.len() - 1;
    flow(Isa::Thumb, blocks, &[(None, 0, 1), (Some(0), to, 1)])
}

/// DDI 0337I, table 3-1: 1 + P, and P is 1 to 3; a branch that is not taken takes 1.
#[test]
fn a_taken_branch_refills_the_pipeline() {
    for jump in [0xd100, 0xe7ff, 0xb900, 0xf000_b801, 0xf000_f801] {
        // bne, b, cbnz, b.w, bl
        assert_eq!(bounds(&pair(&[jump], &[MOV], true)), [3, 4, 5], "{jump:x}");
    }
    for branch in [0xd100, 0xb900] {
        assert_eq!(bounds(&pair(&[branch], &[MOV], false)), [2, 2, 2], "{branch:x}");
    }
    assert_eq!(bounds(&straight(Isa::Thumb, &[0x4770])), [2, 3, 4]); // bx lr
    assert_eq!(bounds(&straight(Isa::Thumb, &[0xbd70])), [6, 7, 8]); // pop {r4, r5, r6, pc}: 1 + N + P
    assert_eq!(bounds(&straight(Isa::Thumb, &[0xe8df_f000])), [4, 5, 6]); // tbb [pc, r0]: 3 + P
    assert_eq!(bounds(&straight(Isa::Thumb, &[0xf8d1_f000])), [3, 4, 5]); // ldr.w pc, [r1]: 2 + P
}

/// Of accesses under an `IT` the recording says how often they happened; of all else, that leaves no trace.
#[test]
fn what_an_it_skips_takes_a_cycle() {
    // cmp r0, #0; it ne; ldrne r1, [r2]
    let mut skipped = flow(Isa::Thumb, &[&[0x2800, 0xbf18, 0x6811]], &[(None, 0, 10)]);
    skipped.blocks[0].passed[2] = 4;
    assert_eq!(
        bounds(&skipped),
        [10 + 4 * 2 + 6, 10 + 4 * 2 + 6, 10 + 10 + 4 * 2 + 6]
    );
    // cmp r0, #0; it ne; mlane r0, r1, r2, r3
    let product = [0x2800, 0xbf18, 0xfb01_3002];
    assert_eq!(bounds(&straight(Isa::Thumb, &product)), [2, 3, 4]);
}

#[test]
fn pipelined_loads_reach_across_blocks() {
    assert_eq!(bounds(&pair(&[0x6808], &[0x6811], false)), [3, 3, 3]); // ldr r0, [r1]; ldr r1, [r2]
    assert_eq!(bounds(&pair(&[0x6808], &[0x6801], false)), [4, 4, 4]); // ldr r0, [r1]; ldr r1, [r0]
}
