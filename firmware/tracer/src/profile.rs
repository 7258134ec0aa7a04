//! Arithmetic profiles: named, compile-time sets of choices.

use fixedmath::I16F16;

use crate::aggregate::RoomNumbers;
use crate::arithmetic::{Mixed, Published, Sampling};
use crate::camera::FilmNumbers;
use crate::geometry::ShapeNumbers;
use crate::light::LightNumbers;
use crate::material::{HemisphereSampling, MalleyDisc, MaterialNumbers, RadianceNumbers, RejectedDisc};
use crate::random::{FullState, LowBits, Random};

/// Everything a tracer computes with.
pub trait Numbers:
    Sampling + FilmNumbers + RadianceNumbers + ShapeNumbers + RoomNumbers + MaterialNumbers + LightNumbers
{
}

impl<
    N: Sampling + FilmNumbers + RadianceNumbers + ShapeNumbers + RoomNumbers + MaterialNumbers + LightNumbers,
> Numbers for N
{
}

/// A named set of arithmetic choices.
pub trait Profile: Sized + 'static {
    /// The name used by `--profile` and in reports.
    const NAME: &'static str;
    /// The name by which host and core agree on it with samples by an additive recurrence ([`Stratified`](crate::kronecker::Stratified)).
    const STRATIFIED_NAME: &'static str;
    /// Self-intersection epsilon, unless the job says otherwise.
    const EPSILON: I16F16;
    /// How a quadratic surface is intersected.
    const QUADRATIC: Quadratic;
    /// Number formats, and the operations on them.
    type Numbers: Numbers;
    /// Random numbers.
    type Random: Random;
    /// How a diffuse surface picks a direction.
    type Hemisphere: HemisphereSampling;
}

/// How the quadratic equation of a ray and a surface is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadratic {
    /// By the textbook's formula: both roots, the first that exceeds epsilon. The hit point is where the ray is then.
    Textbook,
    /// By the power of the ray's origin, which says without a root whether a hit can be nearer than the best so far. Of the
    /// surface that a ray leaves, one root is the start itself, which is left out by identity and not by distance. The hit point
    /// is put back on its surface.
    Power,
}

/// The published system's choices: all 16:16 and epsilon 0.1.
#[derive(Clone, Copy, Debug)]
pub enum Paper {}

/// Ours, and the default: directions in 2:30, squares in 32:32, no cancellation, and no epsilon.
#[derive(Clone, Copy, Debug)]
pub enum Precise {}

impl Profile for Paper {
    const NAME: &'static str = "paper";
    const STRATIFIED_NAME: &'static str = "paper+k";
    const EPSILON: I16F16 = I16F16::from_bits(6554);
    const QUADRATIC: Quadratic = Quadratic::Textbook;
    type Numbers = Published;
    type Random = LowBits;
    type Hemisphere = MalleyDisc;
}

impl Profile for Precise {
    const NAME: &'static str = "precise";
    const STRATIFIED_NAME: &'static str = "precise+k";
    const EPSILON: I16F16 = I16F16::ZERO;
    const QUADRATIC: Quadratic = Quadratic::Power;
    type Numbers = Mixed;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}
