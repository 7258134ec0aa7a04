//! The host side: what a scene becomes, what runs it, and what is made of the pixels that come back.
//!
//! In the order of a render: [`scene`] reads and compiles, [`firmware`] builds the image, [`fleet`] starts the cores,
//! [`collector`] gathers their pixels into an [`image`], [`oracle`] says what they should have been and how far off they
//! are. [`render`] is all of that in one call, and writes it down. [`mod@bench`] is the prices: of operations, of whole
//! samples, of random generators; [`stability`] is the hard cases, and
//! [`mod@report`] shows all that on a page. Beneath all of them lies [`platform`]: files, processes, the terminal, set-up.
//!
//! Rooms depend on each other in one direction only, and so do the modules of a room (`tests/rooms.rs`).

pub mod bench;
pub mod collector;
pub mod firmware;
pub mod fleet;
pub mod image;
pub mod oracle;
pub mod platform;
pub mod profile;
pub mod render;
pub mod report;
pub mod scene;
pub mod stability;
