//! The 25 MHz counter of the board's I/O registers.

use runtime::registers::Register;

/// Its rate.
pub const MEGAHERTZ: u32 = 25;

// SAFETY: FPGAIO's COUNTER, a 32-bit counter; it is only read.
const COUNTER: Register<u32> = unsafe { Register::new(0x4002_8018) };

/// What the counter shows.
pub fn count() -> u32 {
    COUNTER.read()
}
