//! What is looked at of a profile while it walks, beyond what it says itself.

use std::marker::PhantomData;

use fixedmath::{I2F30, I16F16, U0F32};
use floating::Floating;
use tracer::arithmetic::{Formats, Mixed, Published, Sampling};
use tracer::material::{HemisphereSampling, MalleyDisc, RejectedDisc};
use tracer::profile::{Profile, Quadratic};
use tracer::random::Random;

/// Formats whose numbers can be read exactly.
pub trait Readable: Formats {
    /// A length, in the scene's unit.
    fn length_of(length: Self::Length) -> f64;
    /// A direction's component.
    fn component(unit: Self::Unit) -> f64;
    /// A length to the nearest multiple of 2^-16, halves away from 0, if the format is a finer one.
    fn rounded_length(length: Self::Length) -> Self::Length {
        length
    }
    /// A component to the nearest multiple of 2^-30, likewise.
    fn rounded_component(unit: Self::Unit) -> Self::Unit {
        unit
    }
}

impl Readable for Mixed {
    fn length_of(length: I16F16) -> f64 {
        length.to_num()
    }

    fn component(unit: I2F30) -> f64 {
        unit.to_num()
    }
}

impl Readable for Published {
    fn length_of(length: I16F16) -> f64 {
        length.to_num()
    }

    fn component(unit: I16F16) -> f64 {
        unit.to_num()
    }
}

impl Readable for Floating<f64> {
    fn length_of(length: f64) -> f64 {
        length
    }

    fn component(unit: f64) -> f64 {
        unit
    }

    fn rounded_length(length: f64) -> f64 {
        rounded(length, 16)
    }

    fn rounded_component(unit: f64) -> f64 {
        rounded(unit, 30)
    }
}

fn rounded(value: f64, fraction_bits: i32) -> f64 {
    let unit = 2f64.powi(fraction_bits);
    (value * unit).round() / unit
}

/// A way to sample the hemisphere that has one frame for some normals and another for the rest.
pub trait Framed: HemisphereSampling {
    /// Whether this normal has the second frame.
    fn is_turned<N: Sampling>(normal: [N::Unit; 3]) -> bool;
}

impl Framed for MalleyDisc {
    /// The axis that the frame starts from is y where the normal's x exceeds 0.1 either way, else x.
    fn is_turned<N: Sampling>(normal: [N::Unit; 3]) -> bool {
        let near_axis = N::unit(I2F30::from_num(0.1));
        normal[0] > near_axis || -normal[0] > near_axis
    }
}

impl Framed for RejectedDisc {
    /// The frame is turned over for a normal that points below.
    fn is_turned<N: Sampling>(normal: [N::Unit; 3]) -> bool {
        normal[2] < N::ZERO
    }
}

/// A profile whose paths can be explained.
pub trait Explicable: Profile<Numbers: Readable, Random: Clone, Hemisphere: Framed> {}

impl<P: Profile<Numbers: Readable, Random: Clone, Hemisphere: Framed>> Explicable for P {}

/// Profile `P`, whose draws are counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observed<P>(PhantomData<P>);

impl<P: Profile> Profile for Observed<P> {
    const NAME: &'static str = P::NAME;
    const STRATIFIED_NAME: &'static str = P::STRATIFIED_NAME;
    const EPSILON: I16F16 = P::EPSILON;
    const QUADRATIC: Quadratic = P::QUADRATIC;
    type Numbers = P::Numbers;
    type Random = Counted<P::Random>;
    type Hemisphere = P::Hemisphere;
}

/// Random numbers, and how many were drawn.
#[derive(Clone, Debug)]
pub(super) struct Counted<R> {
    random: R,
    pub(super) drawn: u32,
}

impl<R: Random> Random for Counted<R> {
    fn for_unit(seed: u64, id: u32) -> Self {
        Self {
            random: R::for_unit(seed, id),
            drawn: 0,
        }
    }

    fn fraction(&mut self) -> U0F32 {
        self.drawn = self.drawn.wrapping_add(1);
        self.random.fraction()
    }
}
