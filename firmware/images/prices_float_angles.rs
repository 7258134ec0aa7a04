//! Prices and transcripts of functions of angles in single precision.
#![no_std]
#![no_main]

mod bench;

use operations::Group;

// What no_float.x looks for before it refuses.
core::arch::global_asm!(
    ".globl __floating_point_is_measured",
    ".set __floating_point_is_measured, 1"
);

#[board::entry]
fn start() -> ! {
    bench::print(Group::FloatAngles)
}
