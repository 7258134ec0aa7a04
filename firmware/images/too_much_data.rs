//! An image that must not link: its data and its stacks do not fit data memory together.
//!
//! The linker places both without a complaint of its own; a test builds this and expects `memory.x` to refuse it.
#![no_std]
#![no_main]

use core::hint::black_box;

use board::Core;
use panic_halt as _;
use runtime::{Board, ExitCode};

/// More than half of what the boot block leaves of data memory: it fits by itself, but not with the stacks.
static mut TOO_MUCH: [u32; 3 * 1024] = [0; 3 * 1024];

#[board::entry]
fn start() -> ! {
    black_box(&raw mut TOO_MUCH);
    Core::exit(ExitCode::Success)
}
