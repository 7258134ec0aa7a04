//! The log: `defmt`'s frames, by semihosting, each with the time by the core's clock.

// The transport. Nothing of it is called by name.
use defmt_semihosting as _;

defmt::timestamp!("{=u64:us}", runtime::log::uptime::<crate::Core>());
