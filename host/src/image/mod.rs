//! Pictures: gathered from units, estimated, drawn, and kept in files.

pub(crate) mod drawing;
pub mod film;
pub mod openexr;
pub mod picture;
pub(crate) mod raster;
