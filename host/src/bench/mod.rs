//! Prices: of the arithmetic's operations, of whole samples and of many cores, and the judgement of the random generators and of the
//! reference's efficiency.

pub mod baseline;
pub mod generators;
pub mod operations;
pub mod reference;
pub mod samples;
pub mod scaling;
