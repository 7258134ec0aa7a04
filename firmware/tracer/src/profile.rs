//! Arithmetic profiles: named, compile-time sets of choices.

use crate::intersect::{Intersection, Power, Textbook};
use crate::material::{Basis, Diffuse, Offset};
use crate::numbers::{Mixed, Numbers, Published};
use crate::random::{FullState, LowBits, Random};

/// A named set of arithmetic choices.
pub trait Profile: Sized + 'static {
    /// The name used by `--profile` and in reports.
    const NAME: &'static str;
    /// Self-intersection epsilon in 16:16, unless the job says otherwise.
    const EPSILON: i32;
    /// Number formats, and the roots and divisions on them.
    type Numbers: Numbers;
    /// Random numbers.
    type Random: Random;
    /// How rays meet spheres, and where on them.
    type Intersection: Intersection;
    /// How a diffuse surface picks a direction.
    type Diffuse: Diffuse;
}

/// The published system's choices: all 16:16 and epsilon 0.1.
#[derive(Clone, Copy, Debug)]
pub enum Paper {}

/// Ours, and the default: directions in 2:30, squares in 32:32, no cancellation, and an epsilon of 2.4e-4 that only
/// grazing corners need.
#[derive(Clone, Copy, Debug)]
pub enum Precise {}

impl Profile for Paper {
    const NAME: &'static str = "paper";
    const EPSILON: i32 = 6554;
    type Numbers = Published;
    type Random = LowBits;
    type Intersection = Textbook;
    type Diffuse = Basis;
}

impl Profile for Precise {
    const NAME: &'static str = "precise";
    const EPSILON: i32 = 16;
    type Numbers = Mixed;
    type Random = FullState;
    type Intersection = Power;
    type Diffuse = Offset;
}
