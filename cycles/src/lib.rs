//! What a core's execution costs in cycles.
//!
//! QEMU executes instructions and knows no pipeline. So a plugin (`cycles-plugin`) records which blocks of instructions ran after
//! which, a [`flow::Recording`], and this library prices it afterwards by the tables of the ARM9E-S or of the Cortex-M3: [`price()`]
//! instruction by instruction, [`cycles()`] in all.
//!
//! `host` has cores recorded (`cargo xtask render --cycles`, `bench`, `profile`), and `docs/cycles.md` says what is in the tables and what they
//! do not see: [`blind_spots()`] says how much that is for a given flow.
#![forbid(unsafe_code)]

mod arm9;
pub mod blind_spot;
pub mod branch;
pub mod class;
mod cortex_m3;
pub mod file;
pub mod flow;
pub mod options;
mod pipeline;
pub mod price;
pub mod recorder;

pub use blind_spot::{BlindSpot, blind_spots};
pub use pipeline::Estimate;
pub use price::{Assumptions, Cycles, Priced, cycles, price};
