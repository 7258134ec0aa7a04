//! The tracer over floating point: its own source, a profile's formulas and random numbers, another arithmetic.
//!
//! Over `f64` it is the host's lockstep oracle. Over soft `f32` and `f64` on a core it is what fixed point is measured against, in images
//! of their own: no render's image depends on this crate. The scene's records stay in fixed point, and are converted as they are read.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod float;
mod numbers;

use core::marker::PhantomData;

use fixedmath::I16F16;
use tracer::profile::{Profile, Quadratic};

pub use float::Float;
pub use numbers::Floating;

/// Profile `P` in the format `F`: its random numbers, its formulas, this arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Lockstep<P, F>(PhantomData<(P, F)>);

impl<P: Profile, F: Float> Profile for Lockstep<P, F> {
    const NAME: &'static str = P::NAME;
    const STRATIFIED_NAME: &'static str = P::STRATIFIED_NAME;
    const EPSILON: I16F16 = P::EPSILON;
    const QUADRATIC: Quadratic = P::QUADRATIC;
    type Numbers = Floating<F>;
    type Random = P::Random;
    type Hemisphere = P::Hemisphere;
}
