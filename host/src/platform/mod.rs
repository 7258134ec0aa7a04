//! The machine under the host's programs: its files, processes and terminal, and the programs that must be installed.

pub mod console;
pub mod file;
pub mod interrupt;
pub mod memory;
#[cfg(test)]
pub(crate) mod script;
pub mod setup;
mod wait;
pub mod workspace;

pub(crate) use wait::wait;
