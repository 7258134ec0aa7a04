//! What an image is built for.

use std::fmt;

use choices::Choice;
use tracer::scene::{Capabilities, Capability};
use tracer::unit::Termination;

use super::arithmetic::{Arithmetic, Sampler};
use super::board::Board;
use super::soft_float::SoftFloat;
use crate::scene::{CompiledScene, Scene, compile};

/// How grave a line is; a core with a log says all that is at least as grave as the level it was built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, clap::ValueEnum)]
pub enum Level {
    /// Why a core ends.
    Error,
    /// What should not happen: rejected packets, refused leases.
    Warn,
    /// The start and the end of a core.
    Info,
    /// A core's work: leases and units.
    Debug,
    /// Everything, each packet included.
    Trace,
}

impl Level {
    /// The name used by `--log` and by `DEFMT_LOG`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warn => "warn",
            Self::Info => "info",
            Self::Debug => "debug",
            Self::Trace => "trace",
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What an image is to be built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recipe {
    /// The arithmetic.
    pub profile: Arithmetic,
    /// What its scene, camera and integrator need.
    pub needs: Capabilities,
    /// What it logs; none for an image without a log, the one that is measured.
    pub log: Option<Level>,
    /// The format that it computes in instead of fixed point; none for an image that may be a render's.
    pub soft_float: Option<SoftFloat>,
    /// What is the published system's where all else is ours; none for an image that may be a render's.
    pub choice: Option<Choice>,
}

impl Recipe {
    /// What draws this scene, compiled for its integrator, by this profile and sampler, with paths that end so.
    pub fn of(
        profile: Arithmetic,
        sampler: Sampler,
        compiled: &CompiledScene,
        termination: Termination,
    ) -> Self {
        let needs = compiled
            .needs
            .with_if(termination == Termination::Roulette, Capability::Roulette)
            .with_if(sampler == Sampler::Kronecker, Capability::Kronecker);
        Self {
            profile,
            needs,
            log: None,
            soft_float: None,
            choice: None,
        }
    }

    /// What draws this scene by this profile as it does where nothing else is asked for.
    pub fn by_default(profile: Arithmetic, scene: &Scene) -> Self {
        // The image does not depend on the size of the picture.
        let compiled = compile(scene, 4, 3, profile.integrator());
        Self::of(profile, profile.sampler(), &compiled, Termination::Roulette)
    }

    /// The words of `TRACER_NEEDS`.
    pub(super) fn words(&self) -> String {
        self.needs.to_string()
    }

    /// The recipe in words.
    pub fn describe(&self) -> String {
        let log = self.log.map(|level| format!(", logging {level}"));
        let float = self.soft_float.map(|format| format!(", in soft {format}"));
        let choice = self
            .choice
            .map(|choice| format!(", with the published {}", choice.word()));
        let words = self.words().replace(',', ", ");
        format!(
            "profile {} and {words}{}{}{}",
            self.profile,
            float.unwrap_or_default(),
            choice.unwrap_or_default(),
            log.unwrap_or_default()
        )
    }

    /// The image's file name.
    pub(super) fn file_name(&self, board: Board) -> String {
        let log = self.log.map(|level| format!("-log-{level}"));
        let float = self.soft_float.map(|format| format!("-{format}"));
        let choice = self.choice.map(|choice| format!("-published-{}", choice.word()));
        let words = self.words().replace(',', "-");
        format!(
            "{board}-{}-{words}{}{}{}.elf",
            self.profile,
            float.unwrap_or_default(),
            choice.unwrap_or_default(),
            log.unwrap_or_default()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_named_after_what_it_is_for() {
        let needs = Capabilities::of(&[Capability::Diffuse, Capability::Glass, Capability::Roulette]);
        let recipe = Recipe {
            profile: Arithmetic::Paper,
            needs,
            log: None,
            soft_float: None,
            choice: None,
        };
        assert_eq!(recipe.words(), "diffuse,glass,roulette");
        assert_eq!(
            recipe.file_name(Board::Mps2An385),
            "mps2-an385-paper-diffuse-glass-roulette.elf"
        );
        let logging = Recipe {
            log: Some(Level::Debug),
            ..recipe
        };
        assert_eq!(
            logging.file_name(Board::Versatilepb),
            "versatilepb-paper-diffuse-glass-roulette-log-debug.elf"
        );
        let soft = Recipe {
            soft_float: Some(SoftFloat::Double),
            ..recipe
        };
        assert_eq!(
            soft.file_name(Board::Versatilepb),
            "versatilepb-paper-diffuse-glass-roulette-f64.elf"
        );
        let single = Recipe {
            choice: Some(Choice::Root),
            ..recipe
        };
        assert_eq!(
            single.file_name(Board::Versatilepb),
            "versatilepb-paper-diffuse-glass-roulette-published-root.elf"
        );
    }
}
