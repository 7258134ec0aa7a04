//! What a picture should be, in double precision, and how far from it one is.

pub mod compare;
pub mod difference;
pub mod direct;
pub mod divergence;
pub mod equivalence;
pub mod lockstep;
mod moments;
pub mod noise;
pub mod reference;
pub mod shortcuts;
pub mod spectrum;
