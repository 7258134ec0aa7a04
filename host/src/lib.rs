//! Stub.

pub mod arithmetic;
pub mod collector;
pub mod compare;
pub mod difference;
pub mod file;
pub mod film;
pub mod firmware;
pub mod fleet;
pub mod interrupt;
pub mod job;
pub mod lockstep;
pub mod memory;
pub mod openexr;
pub mod picture;
pub mod reference;
pub mod report;
pub mod scene;
pub mod session;
pub mod setup;
