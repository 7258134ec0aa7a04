//! Prices: of the arithmetic's operations, of whole samples, and the judgement of the random generators.

pub mod baseline;
pub mod generators;
pub mod operations;
pub mod samples;
