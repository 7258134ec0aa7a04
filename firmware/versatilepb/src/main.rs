//! One core: reads its boot block, works until told to stop, exits with a code.
#![no_std]
#![no_main]

use node::Words;
use node::ethernet::Ethernet;
use versatilepb::clock::Counter;
use versatilepb::fault::die;
use versatilepb::image::{ImageNeeds, ImageProfile};
use versatilepb::semihosting::{Exit, exit};
use versatilepb::smc91c111::Smc91c111;
use versatilepb::{BOARD, memory};
use wire::Boot;

#[aarch32_rt::entry]
fn start() -> ! {
    memory::paint_stack();
    let boot = match Boot::decode(memory::boot_block()) {
        Ok(boot) => boot,
        Err(error) => die(Words::of("bad boot block: ").and(error.as_str()), Exit::BadBoot),
    };
    let Some(mut card) = Smc91c111::start(boot.mac()) else {
        die(
            &Words::of("no SMC91C111 answers: start QEMU with -nic user,model=smc91c111"),
            Exit::Fault,
        );
    };
    let mut network = Ethernet::new(&boot, &mut card);
    // A lost announcement costs nothing: requests for the address are answered.
    let _ = network.announce();
    match node::run::<ImageProfile, ImageNeeds>(&boot, BOARD, network, Counter, memory::stack_use) {
        Ok(outcome) if outcome.stack.used >= outcome.stack.size => die(
            &Words::of("the stack ran over: enlarge _sys_stack_size in memory.x"),
            Exit::Fault,
        ),
        Ok(_) => exit(Exit::Done),
        Err(fault) => die(&Words::of(fault.as_str()), Exit::Fault),
    }
}
