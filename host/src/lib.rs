//! Stub.

pub mod collector;
pub mod file;
pub mod film;
pub mod openexr;
pub mod picture;
pub mod scene;
pub mod setup;
