//! The ARMv5TE board: QEMU's `versatilepb` with an ARM946E-S, which has the memory map of a SpiNNaker core.
//!
//! Only what differs from other boards is here, in small rooms:
//!
//! | module           | what it touches                                    |
//! | ---------------- | -------------------------------------------------- |
//! | [`console`]      | PL011, for messages                                |
//! | [`counter`]      | 24 MHz, for the clock                              |
//! | [`sleep`]        | wait-for-interrupt, with a timer as alarm          |
//! | [`smc91c111`]    | the Ethernet controller                            |
//! | [`semihosting`]  | the exit, with its code                            |
//! | [`exception`]    | the processor's exceptions                         |
//! | `log`            | the second PL011, with the feature `log`           |
//!
//! Start-up code, vectors and the sections' layout are `aarch32-rt`'s; `board.x` says where everything lies.
#![no_std]

pub mod console;
pub mod counter;
pub mod exception;
#[cfg(feature = "log")]
mod log;
pub mod semihosting;
pub mod sleep;
pub mod smc91c111;

pub use aarch32_rt::entry;

use runtime::{Board, ExitCode};

/// A core of this board.
#[derive(Clone, Copy, Debug)]
pub enum Core {}

impl Board for Core {
    const NAME: &'static str = "versatilepb";
    const NO_CONTROLLER: &'static str = "no SMC91C111 answers: start QEMU with -nic user,model=smc91c111";
    const COUNTER_MEGAHERTZ: u32 = counter::MEGAHERTZ;
    type Controller = smc91c111::Smc91c111;

    fn controller(mac: [u8; 6]) -> Option<Self::Controller> {
        smc91c111::Smc91c111::start(mac)
    }

    fn count() -> u32 {
        counter::count()
    }

    fn println(line: &str) {
        console::println(line);
    }

    fn exit(code: ExitCode) -> ! {
        semihosting::exit(code)
    }
}
