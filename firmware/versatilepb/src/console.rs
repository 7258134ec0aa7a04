//! Messages, over the first PL011 UART.

use runtime::registers::Register;

// SAFETY: the PL011's data and flag registers, 32 bits wide, without DMA.
const DATA: Register<u32> = unsafe { Register::new(0x101F_1000) };
// SAFETY: as above.
const FLAGS: Register<u32> = unsafe { Register::new(0x101F_1018) };

const TRANSMIT_FULL: u32 = 1 << 5;

/// Writes one line.
#[inline(never)]
pub fn println(text: &str) {
    for byte in text.bytes().chain(*b"\r\n") {
        while FLAGS.read() & TRANSMIT_FULL != 0 {}
        DATA.write(byte.into());
    }
}
