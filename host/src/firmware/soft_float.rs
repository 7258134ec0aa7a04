//! Tracers that compute in soft float, in images of their own: what fixed point is measured against.

use std::fmt;

use super::arithmetic::Arithmetic;

/// A floating-point format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SoftFloat {
    /// Single precision.
    #[value(name = "f32")]
    Single,
    /// Double precision.
    #[value(name = "f64")]
    Double,
}

impl SoftFloat {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Rust's name of it, used by `--soft-float` and in lists.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "f32",
            Self::Double => "f64",
        }
    }

    /// What a profile is called that computes in fixed point, or in one of these formats.
    pub fn profile(profile: Arithmetic, format: Option<Self>) -> String {
        match format {
            Some(format) => format!("{profile} in {format}"),
            None => profile.name().to_owned(),
        }
    }

    /// The image, one of each board's examples.
    pub(super) const fn example(self) -> &'static str {
        match self {
            Self::Single => "soft_float_single",
            Self::Double => "soft_float_double",
        }
    }
}

impl fmt::Display for SoftFloat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
