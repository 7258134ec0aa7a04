//! Sleep: the processor stops until a packet or a timeout, so that an idle core leaves the host's processors to busy ones.
//!
//! Interrupts stay masked. A pending one ends wait-for-interrupt all the same, and nobody has to handle it.

use runtime::registers::Register;

// SAFETY: registers of the PL190 interrupt controller, of the board's secondary controller and of the first SP804 timer, all 32
// bits wide, without DMA.
const PRIMARY_ENABLE: Register<u32> = unsafe { Register::new(0x1014_0010) };
// SAFETY: as above.
const SECONDARY_ENABLE: Register<u32> = unsafe { Register::new(0x1000_3008) };
// SAFETY: as above.
const TIMER_LOAD: Register<u32> = unsafe { Register::new(0x101E_2000) };
// SAFETY: as above.
const TIMER_CONTROL: Register<u32> = unsafe { Register::new(0x101E_2008) };
// SAFETY: as above.
const TIMER_CLEAR: Register<u32> = unsafe { Register::new(0x101E_200C) };

/// Inputs of the primary controller: the timer's, and the secondary controller's.
const TIMER_INPUT: u32 = 1 << 4;
const SECONDARY_INPUT: u32 = 1 << 31;
/// The Ethernet controller's input of the secondary controller.
const ETHERNET_INPUT: u32 = 1 << 25;

/// Enabled, with interrupt, 32 bits, once.
const ONE_SHOT: u32 = 0x80 | 0x20 | 0x02 | 0x01;

/// Ticks of the clock in one tick of the timer, which runs at 1 MHz.
const TICKS_PER_MICROSECOND: u32 = node::TICKS_PER_SECOND / 1_000_000;

/// Stops the processor until the Ethernet controller asks for attention or `ticks` of the clock have passed.
#[inline(never)]
pub fn until_packet_or_timeout(ticks: u32) {
    TIMER_LOAD.write((ticks / TICKS_PER_MICROSECOND).max(1));
    TIMER_CONTROL.write(ONE_SHOT);
    SECONDARY_ENABLE.write(ETHERNET_INPUT);
    PRIMARY_ENABLE.write(TIMER_INPUT | SECONDARY_INPUT);
    wait_for_interrupt();
    TIMER_CONTROL.write(0);
    TIMER_CLEAR.write(0);
}

/// Apart, because an image that looks for light has the rest of this crate in Thumb code, which has no such instruction.
#[instruction_set(arm::a32)]
#[inline(never)]
fn wait_for_interrupt() {
    // SAFETY: CP15's wait-for-interrupt, which takes any value; it changes neither memory nor flags.
    unsafe {
        core::arch::asm!("mcr p15, 0, {}, c7, c0, 4", in(reg) 0, options(nomem, nostack, preserves_flags))
    };
}
