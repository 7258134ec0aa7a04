//! The time that the lines of a core's log are stamped with.

use core::cell::Cell;

use critical_section::Mutex;
use node::log::Uptime;

static UPTIME: Mutex<Cell<Uptime>> = Mutex::new(Cell::new(Uptime::new()));

/// Microseconds until a counter of so many megahertz, the same in every call, came to `count`.
///
/// A board's clock asks each time that it is read itself, so that no turn of the counter is missed.
#[inline(never)]
pub fn uptime(count: u32, megahertz: u32) -> u64 {
    critical_section::with(|section| {
        let mut uptime = UPTIME.borrow(section).get();
        let micros = uptime.micros(count, megahertz);
        UPTIME.borrow(section).set(uptime);
        micros
    })
}
