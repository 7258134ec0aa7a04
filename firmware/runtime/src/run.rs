//! A core's life.

use node::ethernet::Interface;
use node::{Clock, Network, Outcome, Text};
#[cfg(feature = "log")]
use tracer::profile::Profile;
use wire::{Boot, Name};

use crate::board::Board;
use crate::exit_code::ExitCode;
use crate::fault::report_fault;
use crate::image::{ImageIntegrator, ImageProfile};
use crate::{clock, memory};

/// One core's whole life: reads its boot block, works until told to stop, exits with a code. To be called first and once.
pub fn run<B: Board>() -> ! {
    run_with::<B>(work)
}

/// As [`work`], for another tracer than the image's.
pub type Work = fn(&Boot<'_>, Name, &mut dyn Network, &mut dyn Clock) -> Result<Outcome, node::Fault>;

/// As [`run`], with this work.
#[inline(always)]
pub fn run_with<B: Board>(work: Work) -> ! {
    memory::paint_stack();
    let boot = match Boot::decode(memory::boot_block()) {
        Ok(boot) => boot,
        Err(error) => report_fault::<B>(
            Text::from("bad boot block: ").push_str(error.as_str()),
            ExitCode::BadBoot,
        ),
    };
    let Some(mut controller) = B::controller(boot.mac()) else {
        report_fault::<B>(&Text::from(B::NO_CONTROLLER), ExitCode::Fault);
    };
    let mut network = Interface::new(&boot, &mut controller);
    // A lost announcement costs nothing: requests for the address are answered.
    let _ = network.announce();
    #[cfg(feature = "log")]
    defmt::info!("{=str} with profile {=str}", B::NAME, ImageProfile::NAME);
    let name = const { Name::new(B::NAME) };
    match work(&boot, name, &mut network, &mut clock::Clock::<B>::start()) {
        Ok(outcome) if outcome.stack.used >= outcome.stack.size => report_fault::<B>(
            &Text::from("the stack ran over: enlarge it in board.x"),
            ExitCode::Fault,
        ),
        Ok(_) => B::exit(ExitCode::Success),
        Err(fault) => report_fault::<B>(&Text::from(fault.as_str()), ExitCode::Fault),
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
