//! A core like any other, but that core 0, each time it is started, sends three units and then runs into something that is no
//! instruction. The fleet must start it again, give it up in the end, and say where it failed; the others do its work.
#![no_std]
#![no_main]

use board::Core;
use node::ethernet::Interface;
use node::{Network, SendError, Text};
use runtime::clock::Clock;
use runtime::{Board, ExitCode, memory, report_fault};
use wire::{Boot, FromCore, Message, Name};

/// Units that core 0 sends before it fails.
const GOOD_UNITS: u32 = 3;

runtime::report_panics!(board::Core);

#[board::entry]
fn start() -> ! {
    memory::paint_stack();
    let Ok(boot) = Boot::decode(memory::boot_block()) else {
        report_fault::<Core>(&Text::from("bad boot block"), ExitCode::BadBoot)
    };
    let Some(mut controller) = Core::controller(boot.mac()) else {
        report_fault::<Core>(&Text::from(Core::NO_CONTROLLER), ExitCode::Fault)
    };
    let mut network = Failing {
        network: Interface::new(&boot, &mut controller),
        good_units: if boot.core == 0 { GOOD_UNITS } else { u32::MAX },
    };
    let name = Name::new(Core::NAME);
    match runtime::work(&boot, name, &mut network, &mut Clock::<Core>::start()) {
        Ok(_) => Core::exit(ExitCode::Success),
        Err(fault) => report_fault::<Core>(&Text::from(fault.as_str()), ExitCode::Fault),
    }
}

/// A network after whose last good unit the core fails.
struct Failing<N> {
    network: N,
    good_units: u32,
}

impl<N: Network> Network for Failing<N> {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        let packet = FromCore::decode(payload);
        if packet.is_ok_and(|packet| matches!(packet.message, Message::Pixels(_))) {
            match self.good_units {
                0 => fail(),
                _ => self.good_units -= 1,
            }
        }
        self.network.send(payload)
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        self.network.receive(buffer)
    }

    fn wait(&mut self, ticks: u32) {
        self.network.wait(ticks);
    }
}

/// Runs into something that is no instruction.
fn fail() -> ! {
    // SAFETY: the instruction is defined to be undefined, and its handler never returns.
    unsafe { core::arch::asm!("udf #0", options(noreturn)) }
}
