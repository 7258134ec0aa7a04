//! Fixed-point arithmetic for cores without a floating-point unit.
//!
//! Numbers are the types of the [`fixed`] crate; the operations are here. An operation has a name of its own for each
//! trade of speed against error, states its bound and its domain, and has a defined result for *every* input: nothing
//! here panics, and nothing wraps unless its name says so.
//!
//! | room | what |
//! | --- | --- |
//! | [`product`] | products with one rounding, dot products in 64 bits |
//! | [`halves`] | products of 16-bit numbers, two in a word |
//! | [`division`] | quotients and reciprocals of 16:16 |
//! | [`root`] | square roots and reciprocal square roots |
//! | [`mod@unit`] | lengths of vectors, and directions in 2:30 |
//! | [`angle`] | sine and cosine of a turn, the angle of a vector |
//! | [`exponential`] | e^x |
//! | [`warp`] | samples from random fractions: tent, sphere, cosine hemisphere |
//! | [`random`] | linear congruential generators with jump-ahead |
//!
//! A bound in *ulp* counts units in the last place of the result's own format.
//!
//! Plain names saturate where a result does not fit; `wrapping_` names are for results that are known to fit, `checked_`
//! names give `None` for those that do not and for arguments without a result.
//!
//! # Prices
//!
//! A cost is in instructions on an emulated ARM9E-S (ARMv5TE), compiled in line, loop overhead subtracted. Every variant
//! here, the published ones among them, and what other crates and soft float offer, cost against worst error:
//!
//! <div style="overflow-x: auto">
#![doc = include_str!("../prices.svg")]
//! </div>
#![no_std]
#![deny(unsafe_code)]

pub mod angle;
#[allow(unsafe_code)]
mod assembly;
pub mod division;
pub mod exponential;
pub mod halves;
pub mod product;
pub mod random;
pub mod root;
pub mod unit;
pub mod warp;

pub use fixed::types::{
    I1F31, I2F30, I4F28, I16F16, I18F46, I32F32, I36F28, I48F16, U0F32, U16F16, U19F45, U32F32, U48F16,
};

/// The README's examples.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
enum ReadMe {}
