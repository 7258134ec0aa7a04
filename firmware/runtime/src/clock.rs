//! A core's clock: the board's counter, told in ticks of 24 MHz.

use core::marker::PhantomData;

use node::TICKS_PER_SECOND;

use crate::board::Board;

const TICKS_PER_MICROSECOND: u32 = TICKS_PER_SECOND / 1_000_000;

/// The clock. Under QEMU's `-icount shift=0`, 24 ticks are 1000 instructions.
///
/// It must be read at least once in each turn of the counter, or that turn is lost.
#[derive(Debug)]
pub struct Clock<B> {
    /// The counter when it was last read.
    count: u32,
    /// Ticks until then, and what is left over of a division by the counter's rate.
    ticks: u32,
    remainder: u32,
    board: PhantomData<B>,
}

impl<B: Board> Clock<B> {
    /// The clock, from now on.
    pub fn start() -> Self {
        Self {
            count: B::count(),
            ticks: 0,
            remainder: 0,
            board: PhantomData,
        }
    }
}

impl<B: Board> node::Clock for Clock<B> {
    fn ticks(&mut self) -> u32 {
        // The log's own clock misses no turn of the counter if it is read whenever this one is.
        #[cfg(feature = "log")]
        crate::log::uptime::<B>();
        let count = B::count();
        if B::COUNTER_MEGAHERTZ == TICKS_PER_MICROSECOND {
            return count;
        }
        let passed = count.wrapping_sub(self.count);
        self.count = count;
        let remainder = passed % B::COUNTER_MEGAHERTZ * TICKS_PER_MICROSECOND + self.remainder;
        let ticks = passed / B::COUNTER_MEGAHERTZ * TICKS_PER_MICROSECOND + remainder / B::COUNTER_MEGAHERTZ;
        self.remainder = remainder % B::COUNTER_MEGAHERTZ;
        self.ticks = self.ticks.wrapping_add(ticks);
        self.ticks
    }
}
