//! Everything from the outside, with the firmware's compiler and QEMU, which must be there: `cargo xtask test` sees to that
//! first. It is one program so that the tests that wait for something leave the processors to the others.

#![expect(clippy::print_stdout, reason = "figures of tests, by helpers of theirs")]

mod boards;

mod debugger;
mod faults;
mod fleet;
mod image;
mod launcher;
mod log;
mod meter;
mod on_target;
mod operations;
mod output;
mod places;
mod processes;
mod profile;
mod size;
mod soft_float;
mod trace;
