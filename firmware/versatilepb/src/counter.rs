//! The 24 MHz counter of the system registers.

use runtime::registers::Register;

/// Its rate.
pub const MEGAHERTZ: u32 = 24;

// SAFETY: SYS_24MHZ, a read-only 32-bit counter.
const COUNTER: Register<u32> = unsafe { Register::new(0x1000_005C) };

/// What the counter shows.
pub fn count() -> u32 {
    COUNTER.read()
}
