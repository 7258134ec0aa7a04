//! A core with a bug: it divides by zero. Its last words must name this file, and its exit code must be that of a panic.
#![no_std]
#![no_main]

use core::hint::black_box;

use board::Core;
use runtime::{Board, Exit};

#[board::entry]
fn start() -> ! {
    black_box(1u32 / black_box(0));
    Core::exit(Exit::Done)
}
