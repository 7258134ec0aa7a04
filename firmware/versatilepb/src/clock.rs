//! The 24 MHz counter of the system registers.

use node::Clock;

use runtime::registers::Register;

// SAFETY: SYS_24MHZ, a read-only 32-bit counter.
const COUNTER: Register<u32> = unsafe { Register::new(0x1000_005C) };

/// What the counter shows.
pub(crate) fn count() -> u32 {
    COUNTER.read()
}

/// The counter. Under QEMU's `-icount shift=0` an instruction takes a nanosecond of its time, so that 24 ticks are 1000
/// instructions.
#[derive(Clone, Copy, Debug)]
pub struct Counter;

impl Clock for Counter {
    fn ticks(&mut self) -> u32 {
        #[cfg(feature = "log")]
        crate::log::uptime();
        count()
    }
}
