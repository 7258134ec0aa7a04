//! Runs a loop of known length and compares the clock: under `-icount shift=0`, 24 ticks must be 1000 instructions.
#![no_std]
#![no_main]

use board::Core;
use node::{Clock, Words};
use runtime::{Board, Exit, die};

/// Rounds of two instructions: 24 million in all, which are 576,000 ticks.
const ROUNDS: u32 = 12_000_000;
const EXPECTED: u32 = ROUNDS * 2 / 1000 * 24;
/// Reading the clock twice takes some instructions, and it counts whole ticks.
const TOLERANCE: u32 = 2;

#[board::entry]
fn start() -> ! {
    let mut clock = Core::clock();
    let before = clock.ticks();
    // SAFETY: counts a register down, and changes nothing but that and the flags.
    unsafe {
        core::arch::asm!("2: subs {0}, {0}, #1", "bne 2b", inout(reg) ROUNDS => _, options(nomem, nostack))
    };
    let ticks = clock.ticks().wrapping_sub(before);
    let mut words = Words::of("ticks: ");
    words.decimal(ticks).and(", expected: ").decimal(EXPECTED);
    if ticks.abs_diff(EXPECTED) > TOLERANCE {
        die::<Core>(&words, Exit::Fault);
    }
    Core::say(words.as_str());
    Core::exit(Exit::Done)
}
