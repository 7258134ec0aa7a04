//! What every board's image does, from the boot block to the last words.
//!
//! A board is a crate that implements [`Board`] and brings the start-up code of its processor, a `board.x`, and handlers for its
//! processor's exceptions. The rest of an image is here: [`run`] is all of its `main`, and [`die`] is where every failure ends.
//! What touches memory as such is in three small rooms:
//!
//! | module        | what it touches                                    |
//! | ------------- | -------------------------------------------------- |
//! | [`registers`] | volatile access; every device driver is made of it |
//! | [`memory`]    | boot block and stack, as the linker placed them    |
//! | [`fault`]     | a flag: the core is dying already                  |
//!
//! With the feature `log`, a core's log is stamped with `log::uptime`.
#![no_std]

pub mod fault;
pub mod image;
#[cfg(feature = "log")]
pub mod log;
pub mod memory;
pub mod registers;

pub use fault::{die, exception, panicked};

use image::{ImageIntegrator, ImageProfile};
use node::ethernet::{Ethernet, Frames};
use node::{Clock, Network, Outcome, Words};
#[cfg(feature = "log")]
use tracer::profile::Profile;
use wire::{Boot, Name};

// What nobody calls: no_float.x sees by it whether the linker knows what it has dropped.
core::arch::global_asm!(
    ".section .text.__dropped_by_the_linker, \"ax\", %progbits",
    ".globl __dropped_by_the_linker",
    "__dropped_by_the_linker:",
    "nop"
);

/// A board: what differs from one to another.
pub trait Board {
    /// The name HELLO gives.
    const NAME: &'static str;
    /// What is said where no network controller answers.
    const NO_CONTROLLER: &'static str;
    /// The driver of its Ethernet controller.
    type Controller: Frames;
    /// Its clock.
    type Clock: Clock;

    /// Starts the Ethernet controller with this address; in whatever state it was, it starts anew. None where there is no such
    /// controller.
    fn controller(mac: [u8; 6]) -> Option<Self::Controller>;

    /// The clock.
    fn clock() -> Self::Clock;

    /// Writes one line on the console.
    fn say(line: &str);

    /// Ends the program.
    fn exit(code: Exit) -> !;
}

/// How a core ended; the value is the exit code. After one of the last two, the fleet starts the core again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// It was told to stop.
    Done = 0,
    /// It cannot go on: see the console.
    Fault = 1,
    /// Its boot block is unusable.
    BadBoot = 2,
    /// The program has a bug: it panicked.
    Panic = 3,
    /// The processor took an exception.
    Exception = 4,
}

impl Exit {
    /// The operation SYS_EXIT_EXTENDED of a semihosting call, whose second argument points to [`Exit::semihosting`].
    pub const SEMIHOSTING_OPERATION: u32 = 0x20;

    /// ADP_Stopped_ApplicationExit, "the program ended by itself", and the exit code.
    pub const fn semihosting(self) -> [u32; 2] {
        [0x2_0026, self as u32]
    }
}

/// Works until told to stop. The tracer is compiled into this function, once, whatever board and image call it.
#[inline(never)]
pub fn work(
    boot: &Boot<'_>,
    board: Name,
    network: &mut dyn Network,
    clock: &mut dyn Clock,
) -> Result<Outcome, node::Fault> {
    node::run::<ImageProfile, ImageIntegrator>(boot, board, network, clock, memory::stack_use)
}

/// One core's whole life: reads its boot block, works until told to stop, exits with a code. To be called first and once.
pub fn run<B: Board>() -> ! {
    memory::paint_stack();
    let boot = match Boot::decode(memory::boot_block()) {
        Ok(boot) => boot,
        Err(error) => die::<B>(Words::of("bad boot block: ").and(error.as_str()), Exit::BadBoot),
    };
    let Some(mut controller) = B::controller(boot.mac()) else {
        die::<B>(&Words::of(B::NO_CONTROLLER), Exit::Fault);
    };
    let mut network = Ethernet::new(&boot, &mut controller);
    // A lost announcement costs nothing: requests for the address are answered.
    let _ = network.announce();
    #[cfg(feature = "log")]
    defmt::info!("{=str} with profile {=str}", B::NAME, ImageProfile::NAME);
    let name = const { Name::new(B::NAME) };
    match work(&boot, name, &mut network, &mut B::clock()) {
        Ok(outcome) if outcome.stack.used >= outcome.stack.size => die::<B>(
            &Words::of("the stack ran over: enlarge it in board.x"),
            Exit::Fault,
        ),
        Ok(_) => B::exit(Exit::Done),
        Err(fault) => die::<B>(&Words::of(fault.as_str()), Exit::Fault),
    }
}
