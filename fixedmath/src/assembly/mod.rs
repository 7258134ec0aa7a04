//! Where the instruction set does in two instructions what no compiler finds: rounding by the carry.
//!
//! A right shift leaves the last bit it drops in the carry, and that bit is what rounding to the nearest adds. A shift and
//! an `ADC` therefore bring a 64-bit sum into a word and round it, where adding half a unit first takes five
//! instructions, and `V` tells of the one sum that is rounded out of the format.
//!
//! The twins give the same bits; `build.rs` chooses.

#[cfg(shifted_operands)]
mod arm;
#[cfg(shifted_operands)]
pub(crate) use arm::{rounded, saturated};

#[cfg(not(shifted_operands))]
mod portable;
#[cfg(not(shifted_operands))]
pub(crate) use portable::{rounded, saturated};

#[cfg(half_products)]
mod halves;
#[cfg(half_products)]
pub(crate) use halves::{lower_halves, lower_lower, lower_upper, upper_halves, upper_upper};

#[cfg(not(half_products))]
mod portable_halves;
#[cfg(not(half_products))]
pub(crate) use portable_halves::{lower_halves, lower_lower, lower_upper, upper_halves, upper_upper};
