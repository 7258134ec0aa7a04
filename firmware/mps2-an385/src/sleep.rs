//! Sleep: the processor stops until a packet or a timeout, so that an idle core leaves the host's processors to busy ones.
//!
//! Interrupts stay masked. A pending one ends wait-for-interrupt all the same (*ARMv7-M Architecture Reference Manual*, ARM DDI
//! 0403E, B1.5.19), and nobody has to handle it.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m::{Peripherals, asm, interrupt};

/// The Ethernet controller's input of the interrupt controller.
#[derive(Clone, Copy)]
struct Ethernet;

// SAFETY: a constant, and the number of this interrupt on the board (*Application Note AN385*, table 3-7).
unsafe impl InterruptNumber for Ethernet {
    fn number(self) -> u16 {
        13
    }
}

/// The system timer counts the processor's 25 MHz in 24 bits.
const LONGEST: u32 = (1 << 24) - 1;

/// Stops the processor until the Ethernet controller asks for attention or `ticks` of the clock have passed; for no longer than
/// two thirds of a second.
#[inline(never)]
pub fn until_packet_or_timeout(ticks: u32) {
    interrupt::disable();
    // SAFETY: nobody else uses the system timer or the interrupt controller, and what is set here is taken back below.
    let mut processor = unsafe { Peripherals::steal() };
    let timer = &mut processor.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(ticks.clamp(1, LONGEST));
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
    // SAFETY: interrupts are disabled: this one wakes the processor, and is never taken.
    unsafe { NVIC::unmask(Ethernet) };
    asm::wfi();
    NVIC::mask(Ethernet);
    NVIC::unpend(Ethernet);
    timer.disable_counter();
    timer.disable_interrupt();
    SCB::clear_pendst();
}
