//! What every board's image does, from the boot block to the exit code.
//!
//! A board is a crate that implements [`Board`] and brings the start-up code of its processor, a `board.x`, and handlers for its
//! processor's exceptions. The rest of an image is here: [`run`] is all of its `main`, [`report_fault`] is where every failure ends,
//! and [`report_panics`] makes its panics end there, too. What touches memory as such is in three small rooms:
//!
//! | module        | what it touches                                    |
//! | ------------- | -------------------------------------------------- |
//! | [`registers`] | volatile access; every device driver is made of it |
//! | [`memory`]    | boot block and stack, as the linker placed them    |
//! | `fault`       | a flag: a fault is being reported                  |
//!
//! With the feature `log`, a core's log is stamped with `log::uptime`.
#![no_std]

mod board;
pub mod clock;
mod exit_code;
mod fault;
pub mod image;
#[cfg(feature = "log")]
pub mod log;
pub mod memory;
pub mod registers;
mod run;

pub use board::Board;
pub use exit_code::ExitCode;
pub use fault::{report_exception, report_fault, report_panic};
pub use run::{Work, run, run_with, work};

// What nobody calls: no_float.x sees by it whether the linker knows what it has dropped.
core::arch::global_asm!(
    ".section .text.__dropped_by_the_linker, \"ax\", %progbits",
    ".globl __dropped_by_the_linker",
    "__dropped_by_the_linker:",
    "nop"
);

/// The panic handler of an image whose panics a board's console and the host are told of. An image that has nobody to report to
/// has `panic_halt` instead.
#[macro_export]
macro_rules! report_panics {
    ($board:ty) => {
        #[panic_handler]
        fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
            $crate::report_panic::<$board>(info)
        }
    };
}
