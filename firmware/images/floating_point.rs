//! An image that must not link: it multiplies floating-point numbers.
//!
//! A test builds it and expects `no_float.x` to refuse it by name. Nothing else builds it: it is not a default target.
#![no_std]
#![no_main]

use core::hint::black_box;

use board::Core;
use panic_halt as _;
use runtime::{Board, ExitCode};

#[board::entry]
fn start() -> ! {
    let product = black_box(1.5f32) * black_box(2.0f32);
    black_box(product);
    Core::exit(ExitCode::Success)
}
