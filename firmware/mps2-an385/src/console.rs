//! Messages, over the first of the CMSDK UARTs.

use runtime::registers::Register;

// SAFETY: the UART's data, state, control and rate registers, 32 bits wide, without DMA.
const DATA: Register<u32> = unsafe { Register::new(0x4000_4000) };
// SAFETY: as above.
const STATE: Register<u32> = unsafe { Register::new(0x4000_4004) };
// SAFETY: as above.
const CONTROL: Register<u32> = unsafe { Register::new(0x4000_4008) };
// SAFETY: as above.
const DIVIDER: Register<u32> = unsafe { Register::new(0x4000_4010) };

const TRANSMIT_FULL: u32 = 1;
const TRANSMIT_ON: u32 = 1;
/// 115,200 baud of 25 MHz.
const RATE: u32 = 25_000_000 / 115_200;

/// Writes one line.
#[inline(never)]
pub fn println(text: &str) {
    DIVIDER.write(RATE);
    CONTROL.write(TRANSMIT_ON);
    for byte in text.bytes().chain(*b"\r\n") {
        while STATE.read() & TRANSMIT_FULL != 0 {}
        DATA.write(byte.into());
    }
}
