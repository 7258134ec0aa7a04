//! The arithmetic profiles as a choice at run time.

use std::fmt;

use fixedmath::I16F16;
use tracer::profile::{Paper, Precise, Profile};

use crate::scene::Integrator;

/// A named set of arithmetic choices; the tracer is compiled once for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Arithmetic {
    /// The published system's choices.
    Paper,
    /// Ours.
    #[default]
    Precise,
}

impl Arithmetic {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Precise];

    /// The name used by `--profile` and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paper => Paper::NAME,
            Self::Precise => Precise::NAME,
        }
    }

    /// The profile's own self-intersection epsilon, in a core's unit, for a scene whose smallest sphere is 2^`magnification` times as
    /// large for a core as that of the Cornell box.
    ///
    /// Ours is none. The published one is a length of the published scene.
    pub fn epsilon(self, magnification: i32) -> I16F16 {
        match self {
            Self::Paper if magnification < 0 => {
                (Paper::EPSILON >> magnification.unsigned_abs().min(31)).max(I16F16::DELTA)
            }
            Self::Paper => Paper::EPSILON << magnification.min(10),
            Self::Precise => Precise::EPSILON,
        }
    }
}

impl Arithmetic {
    /// The sampler that a picture has unless another one is asked for.
    pub const fn sampler(self) -> Sampler {
        match self {
            Self::Paper => Sampler::Independent,
            Self::Precise => Sampler::Kronecker,
        }
    }

    /// The name by which host and cores agree on it and a sampler.
    pub const fn wire_name(self, sampler: Sampler) -> &'static str {
        with_profile!(self, sampler, P => P::NAME)
    }

    /// The integrator that a picture has unless another one is asked for.
    pub const fn integrator(self) -> Integrator {
        match self {
            Self::Paper => Integrator::Path,
            Self::Precise => Integrator::NextEvent,
        }
    }
}

/// Evaluates an expression with the type of a profile and a sampler that are chosen at run time under a name.
macro_rules! with_profile {
    ($profile:expr, $sampler:expr, $name:ident => $body:expr) => {{
        use $crate::firmware::arithmetic::{Arithmetic, Sampler};
        match ($profile, $sampler) {
            (Arithmetic::Paper, Sampler::Independent) => {
                type $name = tracer::profile::Paper;
                $body
            }
            (Arithmetic::Paper, Sampler::Kronecker) => {
                type $name = tracer::kronecker::Stratified<tracer::profile::Paper>;
                $body
            }
            (Arithmetic::Precise, Sampler::Independent) => {
                type $name = tracer::profile::Precise;
                $body
            }
            (Arithmetic::Precise, Sampler::Kronecker) => {
                type $name = tracer::kronecker::Stratified<tracer::profile::Precise>;
                $body
            }
        }
    }};
}
pub(crate) use with_profile;

/// Evaluates an expression with the type of `precise` but for a choice that is known at run time under a name.
macro_rules! with_choice {
    ($choice:expr, $name:ident => $body:expr) => {
        with_choice!($choice, $name => $body; Root 0, Division 1, Directions 2, Generator 3, Intersection 4, Hemisphere 5, Sine 6)
    };
    ($choice:expr, $name:ident => $body:expr; $($variant:ident $number:literal),+) => {
        match $choice {
            $(choices::Choice::$variant => {
                type $name = tracer::kronecker::Stratified<choices::Single<choices::Only<$number>>>;
                $body
            })+
        }
    };
}
pub(crate) use with_choice;

/// Where a picture's random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampler {
    /// Each sample's are independent of all others', as published.
    Independent,
    /// The first of each sample keep out of the way of those of its pixel's other samples, by an additive recurrence.
    Kronecker,
}

impl Sampler {
    /// All there are.
    pub const ALL: [Self; 2] = [Self::Independent, Self::Kronecker];

    /// The name used by `--sampler` and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Kronecker => "kronecker",
        }
    }
}

impl fmt::Display for Sampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Arithmetic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
