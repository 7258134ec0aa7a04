//! The 25 MHz counter of the board's I/O registers, told in ticks of 24 MHz.

use node::Clock;
use runtime::registers::Register;

// SAFETY: FPGAIO's COUNTER, a 32-bit counter; it is only read.
const COUNTER: Register<u32> = unsafe { Register::new(0x4002_8018) };

/// The counter counts so many while the clock ticks [`TICKS`] times.
const COUNTS: u32 = 25;
const TICKS: u32 = 24;

/// What the counter shows.
pub(crate) fn count() -> u32 {
    COUNTER.read()
}

/// The clock. Under QEMU's `-icount shift=0` an instruction takes a nanosecond of its time, so that 24 ticks are 1000
/// instructions.
///
/// It must be read at least every three minutes, or it loses a turn of the counter.
#[derive(Clone, Copy, Debug)]
pub struct Counter {
    /// The counter when it was last read.
    count: u32,
    /// Ticks until then, and 25ths of a tick beyond them.
    ticks: u32,
    rest: u32,
}

impl Counter {
    /// The clock, from now on.
    pub fn start() -> Self {
        Self {
            count: count(),
            ticks: 0,
            rest: 0,
        }
    }
}

impl Clock for Counter {
    fn ticks(&mut self) -> u32 {
        #[cfg(feature = "log")]
        crate::log::uptime();
        let count = count();
        let passed = count.wrapping_sub(self.count);
        self.count = count;
        let rest = passed % COUNTS * TICKS + self.rest;
        let ticks = passed / COUNTS * TICKS + rest / COUNTS;
        self.rest = rest % COUNTS;
        self.ticks = self.ticks.wrapping_add(ticks);
        self.ticks
    }
}
