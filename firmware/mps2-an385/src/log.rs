//! The log: `defmt`'s frames, by semihosting, each with the time by the core's clock.

// The transport. Nothing of it is called by name.
use defmt_semihosting as _;

/// Of the counter.
const MEGAHERTZ: u32 = 25;

defmt::timestamp!("{=u64:us}", uptime());

/// Microseconds since the start.
pub(crate) fn uptime() -> u64 {
    runtime::log::uptime(crate::clock::count(), MEGAHERTZ)
}
