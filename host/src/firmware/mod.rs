//! Firmware images: built for a scene and a profile, then measured and checked.
//!
//! An image holds only what its scene needs (`TRACER_NEEDS`) and one profile (`TRACER_PROFILE`). All images are built in one
//! target folder of their own, so that changing the scene compiles only the board's crate again, and so that the host's
//! builds are not kept waiting; the finished image is then put beside it under a name that says what it is.

pub mod arithmetic;
pub mod board;
mod build;
mod elf;
pub mod footprint;
pub mod growth;
pub mod log;
pub mod plugin;
mod recipe;
mod share;
mod soft_float;
pub mod symbols;

pub use choices::Choice;

pub use build::{
    FirmwareError, Image, build, build_examples, cargo, cargo_for, environment, example, target_folder,
};
pub use elf::{ElfError, ImageSize, board_of, compiler, entry, measure};
pub use recipe::{Level, Recipe};
pub use share::{code_bytes, tracer_bytes};
pub use soft_float::SoftFloat;
pub use tracer::scene::{Capabilities, Capability};
