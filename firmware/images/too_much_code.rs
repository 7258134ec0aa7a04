//! An image that must not link: its constants do not fit code memory.
#![no_std]
#![no_main]

use core::hint::black_box;

use board::Core;
use panic_halt as _;
use runtime::{Board, ExitCode};

/// All of code memory, so that nothing is left for code.
static TOO_MUCH: [u32; 8 * 1024] = [7; 8 * 1024];

#[board::entry]
fn start() -> ! {
    black_box(&TOO_MUCH);
    Core::exit(ExitCode::Success)
}
