//! The time that the lines of a core's log are stamped with.

use core::cell::Cell;

use critical_section::Mutex;
use node::log::Uptime;

use crate::board::Board;

static UPTIME: Mutex<Cell<Uptime>> = Mutex::new(Cell::new(Uptime::new()));

/// Microseconds by the board's counter since it was zero.
#[inline(never)]
pub fn uptime<B: Board>() -> u64 {
    critical_section::with(|section| {
        let mut uptime = UPTIME.borrow(section).get();
        let micros = uptime.micros(B::count(), B::COUNTER_MEGAHERTZ);
        UPTIME.borrow(section).set(uptime);
        micros
    })
}
