//! The host side: what a scene becomes, what runs it, and what is made of the pixels that come back.
//!
//! In the order of a render: [`scene`] reads and compiles, [`setup`] and [`firmware`] build the image, [`fleet`] starts the
//! cores of a [`session`] and reads their [`log`], [`collector`] gathers their pixels on a [`film`], [`reference`](mod@reference) and [`lockstep`] say what
//! they should have been, [`compare`] and [`difference`] how far off they are, and [`report`] writes it down. [`job`] is
//! all of that in one call. [`capture`] reads the packets that a core's emulator recorded. [`generators`] judges the random
//! numbers by themselves, [`console`] is how programs speak, and [`mod@operations`] is the price list of the arithmetic, [`samples`] that of
//! whole samples.

pub mod arithmetic;
pub mod board;
pub mod capture;
pub mod collector;
pub mod compare;
pub mod console;
pub mod difference;
pub mod direct;
mod drawing;
pub mod file;
pub mod film;
pub mod firmware;
pub mod fleet;
pub mod generators;
pub mod interrupt;
pub mod job;
pub mod lockstep;
pub mod log;
pub mod memory;
pub mod noise;
pub mod openexr;
pub mod operations;
pub mod picture;
mod raster;
pub mod reference;
pub mod report;
pub mod samples;
pub mod scene;
pub mod session;
pub mod setup;
pub mod symbols;
pub mod workspace;
