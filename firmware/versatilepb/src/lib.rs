//! The ARMv5TE board: QEMU's `versatilepb` with an ARM946E-S, which has the memory map of a SpiNNaker core.
//!
//! Only what differs from other boards is here, in small rooms:
//!
//! | module           | what it touches                                    |
//! | ---------------- | -------------------------------------------------- |
//! | [`console`]      | PL011, for messages                                |
//! | [`clock`]        | the 24 MHz counter                                 |
//! | [`rest`]         | wait-for-interrupt, with a timer as alarm          |
//! | [`smc91c111`]    | the Ethernet controller                            |
//! | [`semihosting`]  | the way out, with an exit code                     |
//! | [`fault`]        | panics and processor exceptions                    |
//! | `log`            | the second PL011, with the feature `log`           |
//!
//! Start-up code, vectors and the sections' layout are `aarch32-rt`'s; `board.x` says where everything lies.
#![no_std]

pub mod clock;
pub mod console;
pub mod fault;
#[cfg(feature = "log")]
mod log;
pub mod rest;
pub mod semihosting;
pub mod smc91c111;

pub use aarch32_rt::entry;

use runtime::{Board, Exit};

/// A core of this board.
#[derive(Clone, Copy, Debug)]
pub enum Core {}

impl Board for Core {
    const NAME: &'static str = "versatilepb";
    const NO_CONTROLLER: &'static str = "no SMC91C111 answers: start QEMU with -nic user,model=smc91c111";
    type Controller = smc91c111::Smc91c111;
    type Clock = clock::Counter;

    fn controller(mac: [u8; 6]) -> Option<Self::Controller> {
        smc91c111::Smc91c111::start(mac)
    }

    fn clock() -> Self::Clock {
        clock::Counter
    }

    fn say(line: &str) {
        console::line(line);
    }

    fn exit(code: Exit) -> ! {
        semihosting::exit(code)
    }
}
