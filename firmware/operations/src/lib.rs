//! Every arithmetic operation by name, so that a core and the host can go through the same list: one takes prices, the
//! other judges errors, and both give a transcript that must be the same.
//!
//! An [`Operation`] is a mathematical [`Function`] with the formats of its input and output and the domain it is judged
//! on. A [`Variant`] is one way to do it: a row of the price list. A [`Group`] of rows, of which a core's memory holds one
//! at a time, shows them to a [`Visitor`] in an order that is the same everywhere.
//!
//! To add a row is one line in `ours.rs` or `rivals.rs`; to add an operation is a marker in `op.rs` besides, and if its
//! function is new, that function's truth on the host.
#![no_std]
#![forbid(unsafe_code)]

mod group;
mod hard;
pub mod intersection;
pub mod number;
pub mod op;
mod operation;
mod ours;
pub mod price;
mod rivals;
mod row;
pub mod transcript;
mod variant;

pub use group::Group;
pub use number::{Input, Number};
pub use operation::{Format, Function, Operation};
pub use variant::{Maker, OperationInput, Variant, Visitor, accepts};
