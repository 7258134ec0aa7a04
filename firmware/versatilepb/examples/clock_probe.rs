//! Runs a loop of known length and compares the clock: under `-icount shift=0`, 24 ticks must be 1000 instructions.
#![no_std]
#![no_main]

use node::{Clock, Words};
use versatilepb::clock::Counter;
use versatilepb::console;
use versatilepb::fault::die;
use versatilepb::semihosting::{Exit, exit};

/// Rounds of two instructions: 24 million in all, which are 576,000 ticks.
const ROUNDS: u32 = 12_000_000;
const EXPECTED: u32 = ROUNDS * 2 / 1000 * 24;
/// Reading the clock twice takes some instructions, and it counts whole ticks.
const TOLERANCE: u32 = 2;

#[aarch32_rt::entry]
fn start() -> ! {
    let before = Counter.ticks();
    // SAFETY: counts a register down, and changes nothing but that and the flags.
    unsafe {
        core::arch::asm!("2: subs {0}, {0}, #1", "bne 2b", inout(reg) ROUNDS => _, options(nomem, nostack))
    };
    let ticks = Counter.ticks().wrapping_sub(before);
    let mut words = Words::of("ticks: ");
    words.decimal(ticks).and(", expected: ").decimal(EXPECTED);
    if ticks.abs_diff(EXPECTED) > TOLERANCE {
        die(&words, Exit::Fault);
    }
    console::line(words.as_str());
    exit(Exit::Done)
}
