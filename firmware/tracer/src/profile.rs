//! Arithmetic profiles: named, compile-time sets of choices.

/// A named set of arithmetic choices.
pub trait Profile: Sized {
    /// The name used by `--profile` and in reports.
    const NAME: &'static str;
    /// Self-intersection epsilon in 16:16, unless the job says otherwise.
    const EPSILON: i32;
}

/// The published system's choices.
#[derive(Clone, Copy, Debug)]
pub enum Paper {}

/// Ours, and the default.
#[derive(Clone, Copy, Debug)]
pub enum Precise {}

impl Profile for Paper {
    const NAME: &'static str = "paper";
    const EPSILON: i32 = 6554;
}

impl Profile for Precise {
    const NAME: &'static str = "precise";
    const EPSILON: i32 = 16;
}
