//! Stub.

pub mod scene;
pub mod setup;
