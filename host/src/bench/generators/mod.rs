//! Random number generators, judged as such.
//!
//! What can be proven is proven: [`spectral`] measures the lattice that the points of a generator form, and [`period`]
//! how long it takes to repeat and how far apart its streams are. What is left to chance is tested on the very numbers
//! the tracer takes, in the order it takes them ([`streams`]): [`uniformity`] by chi-squared and serial correlation.
//! `dieharder` (Debian) is fed with them by [`dieharder`]. [`low_bits`] shows what a bad generator does to a picture. [`judgement`] puts it together for the generators that the profiles use.

pub mod dieharder;
pub mod judgement;
mod lattice;
pub mod low_bits;
pub mod period;
pub mod spectral;
pub mod streams;
pub mod uniformity;
