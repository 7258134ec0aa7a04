//! A core with a bug: it divides by zero. Its last words must name this file, and its exit code must be that of a panic.
#![no_std]
#![no_main]

use core::hint::black_box;

use versatilepb::semihosting::{Exit, exit};

#[aarch32_rt::entry]
fn start() -> ! {
    black_box(1u32 / black_box(0));
    exit(Exit::Done)
}
