//! The Cortex-M3 board: QEMU's `mps2-an385`, ARM's MPS2 with the image of application note AN385.
//!
//! Only what differs from other boards is here, in small rooms:
//!
//! | module           | what it touches                                       |
//! | ---------------- | ----------------------------------------------------- |
//! | [`console`]      | CMSDK UART, for messages                              |
//! | [`counter`]      | 25 MHz, for the clock                                 |
//! | [`sleep`]        | wait-for-interrupt, with the system timer as alarm    |
//! | [`lan9118`]      | the Ethernet controller                               |
//! | [`semihosting`]  | the exit, with its code                               |
//! | [`exception`]    | the processor's exceptions                            |
//! | `log`            | semihosting, with the feature `log`                   |
//!
//! Start-up code, vectors and the sections' layout are `cortex-m-rt`'s; `board.x` says where everything lies.
#![no_std]

pub mod console;
pub mod counter;
pub mod exception;
pub mod lan9118;
#[cfg(feature = "log")]
mod log;
pub mod semihosting;
pub mod sleep;

pub use cortex_m_rt::entry;

use runtime::{Board, ExitCode};

/// A core of this board.
#[derive(Clone, Copy, Debug)]
pub enum Core {}

impl Board for Core {
    const NAME: &'static str = "mps2-an385";
    const NO_CONTROLLER: &'static str = "no LAN9118 answers: start QEMU with -nic user,model=lan9118";
    const COUNTER_MEGAHERTZ: u32 = counter::MEGAHERTZ;
    type Controller = lan9118::Lan9118;

    fn controller(mac: [u8; 6]) -> Option<Self::Controller> {
        lan9118::Lan9118::start(mac)
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
