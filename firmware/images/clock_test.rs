//! Runs a loop of known length and compares the clock: under `-icount shift=0`, 24 ticks must be 1000 instructions.
#![no_std]
#![no_main]

use board::Core;
use node::{Clock as _, Text};
use runtime::clock::Clock;
use runtime::{Board, ExitCode, report_fault};

/// Rounds of two instructions: 24 million in all, which are 576,000 ticks.
const ROUNDS: u32 = 12_000_000;
const EXPECTED: u32 = ROUNDS * 2 / 1000 * 24;
/// Reading the clock twice takes some instructions, and it counts whole ticks.
const TOLERANCE: u32 = 2;

runtime::report_panics!(board::Core);

#[board::entry]
fn start() -> ! {
    let mut clock = Clock::<Core>::start();
    let before = clock.ticks();
    // SAFETY: counts a register down, and changes nothing but that and the flags.
    unsafe {
        core::arch::asm!("2: subs {0}, {0}, #1", "bne 2b", inout(reg) ROUNDS => _, options(nomem, nostack))
    };
    let ticks = clock.ticks().wrapping_sub(before);
    let mut line = Text::from("ticks: ");
    line.push_decimal(ticks)
        .push_str(", expected: ")
        .push_decimal(EXPECTED);
    if ticks.abs_diff(EXPECTED) > TOLERANCE {
        report_fault::<Core>(&line, ExitCode::Fault);
    }
    Core::println(line.as_str());
    Core::exit(ExitCode::Success)
}
