//! The ARMv5TE board: QEMU's `versatilepb` with an ARM946E-S, which has the memory map of a SpiNNaker core.
//!
//! Registers live here, and all `unsafe` of the firmware does, in small rooms:
//!
//! | module           | what it touches                                    |
//! | ---------------- | -------------------------------------------------- |
//! | [`registers`]    | volatile access; every device below is made of it  |
//! | [`console`]      | PL011, for messages                                |
//! | [`clock`]        | the 24 MHz counter                                 |
//! | [`rest`]         | wait-for-interrupt, with a timer as alarm          |
//! | [`smc91c111`]    | the Ethernet controller                            |
//! | [`memory`]       | boot block and stack, as the linker placed them    |
//! | [`semihosting`]  | the way out, with an exit code                     |
//! | [`fault`]        | panics and processor exceptions                    |
//!
//! Start-up code, vectors and the sections' layout are `aarch32-rt`'s.
#![no_std]

pub mod clock;
pub mod console;
pub mod fault;
pub mod image;
pub mod memory;
pub mod registers;
pub mod rest;
pub mod semihosting;
pub mod smc91c111;

/// The name HELLO gives.
pub const BOARD: wire::Name = wire::Name::new("versatilepb");
