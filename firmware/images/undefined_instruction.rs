//! A core that runs into something that is no instruction. Its fault report must say so, and its exit code be that of an exception.
#![no_std]
#![no_main]

use board::Core;
use runtime::{Board, ExitCode};

runtime::report_panics!(board::Core);

#[board::entry]
fn start() -> ! {
    // SAFETY: the instruction is defined to be undefined; the handler never returns.
    unsafe { core::arch::asm!("udf #0") };
    Core::exit(ExitCode::Success)
}
