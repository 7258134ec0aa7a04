//! Numerical stability: the hard cases, counted in millions, and what came of them as tables and plots.
//!
//! Each part is a file that measures one thing. It ends in tables for `docs/stability.md`, plots where people would rather look, and
//! faults: what should have held and did not. To add a part is a module and a line in [`PARTS`].

mod boards;
mod convergence;
mod divergence;
mod draw;
mod exact;
pub(crate) mod figures;
mod hard;
mod intersection;
mod light;
mod part;
mod plot;
mod reintersection;
mod sheet;
mod table;
mod vast;

pub(crate) use convergence::error_beside;
pub(crate) use table::figure;

pub use part::{Effort, Error, Findings, Part, SCENE_FOLDERS, scene_files};
pub use plot::Plot;
pub use sheet::{Panel, Sheet};
pub use table::Table;

/// All parts, in the order of `docs/stability.md`.
pub const PARTS: &[Part] = &[
    intersection::PART,
    reintersection::PART,
    divergence::PART,
    figures::PART,
    convergence::PART,
    hard::PART,
    light::PART,
    boards::PART,
];
