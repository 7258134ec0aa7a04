//! The Cortex-M3 board: QEMU's `mps2-an385`, ARM's MPS2 with the image of application note AN385.
//!
//! Only what differs from other boards is here, in small rooms:
//!
//! | module           | what it touches                                       |
//! | ---------------- | ----------------------------------------------------- |
//! | [`console`]      | CMSDK UART, for messages                              |
//! | [`clock`]        | the 25 MHz counter                                    |
//! | [`rest`]         | wait-for-interrupt, with the system timer as alarm    |
//! | [`lan9118`]      | the Ethernet controller                               |
//! | [`semihosting`]  | the way out, with an exit code                        |
//! | [`fault`]        | panics and processor exceptions                       |
//! | `log`            | semihosting, with the feature `log`                   |
//!
//! Start-up code, vectors and the sections' layout are `cortex-m-rt`'s; `board.x` says where everything lies.
#![no_std]

pub mod clock;
pub mod console;
pub mod fault;
pub mod lan9118;
#[cfg(feature = "log")]
mod log;
pub mod rest;
pub mod semihosting;

pub use cortex_m_rt::entry;

use runtime::{Board, Exit};

/// A core of this board.
#[derive(Clone, Copy, Debug)]
pub enum Core {}

impl Board for Core {
    const NAME: &'static str = "mps2-an385";
    const NO_CONTROLLER: &'static str = "no LAN9118 answers: start QEMU with -nic user,model=lan9118";
    type Controller = lan9118::Lan9118;
    type Clock = clock::Counter;

    fn controller(mac: [u8; 6]) -> Option<Self::Controller> {
        lan9118::Lan9118::start(mac)
    }

    fn clock() -> Self::Clock {
        clock::Counter::start()
    }

    fn say(line: &str) {
        console::line(line);
    }

    fn exit(code: Exit) -> ! {
        semihosting::exit(code)
    }
}
