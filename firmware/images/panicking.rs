//! A core with a bug: it divides by zero. Its fault report must name this file, and its exit code must be that of a panic.
#![no_std]
#![no_main]

use core::hint::black_box;

use board::Core;
use runtime::{Board, ExitCode};

runtime::report_panics!(board::Core);

#[board::entry]
fn start() -> ! {
    black_box(1u32 / black_box(0));
    Core::exit(ExitCode::Success)
}
