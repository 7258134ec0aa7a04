//! What a render is asked for: the flags of `cargo xtask render` and of the collector.

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser};
use fixedmath::I16F16;
use tracer::unit::{Plan, Termination};
use wire::boot::PixelOrder;

use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::firmware::{Choice, Level, SoftFloat};
use crate::platform::workspace::{self, NoWorkspace};
use crate::scene::{Integrator, MAX_LENGTH, Scale};

/// A film of this many pixels takes half a gigabyte.
const MOST_PIXELS: u32 = 1 << 24;

/// What the picture shall be.
#[derive(Clone, Debug, clap::Args)]
pub struct PictureOptions {
    /// Scene file [default: scenes/cornell.toml of the checkout]
    pub scene: Option<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "256x192")]
    pub size: Size,
    /// Samples per pixel in all, a multiple of 4
    #[arg(long, value_name = "N", default_value = "24", value_parser = samples_per_pixel, allow_negative_numbers = true)]
    pub spp: u32,
    /// Number of cores
    #[arg(long, value_name = "N", default_value = "4", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub cores: u16,
    /// Arithmetic
    #[arg(long, value_enum, default_value_t)]
    pub profile: Arithmetic,
    /// How radiance is found: by paths that meet light, or that look for it as well [default: the profile's own]
    #[arg(long, value_enum)]
    pub integrator: Option<Integrator>,
    /// Where random numbers come from [default: the profile's own]
    #[arg(long, value_enum)]
    pub sampler: Option<Sampler>,
    /// How far along a ray its first hit is at least, in the scene's unit of length [default: the profile's own]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub epsilon: Option<Epsilon>,
    /// When a path ends: `roulette`, or `depth:N` after N surfaces
    #[arg(long, value_name = "roulette|depth:N", default_value = "roulette")]
    pub termination: End,
    /// Who chooses the next unit: the host, or each core for itself
    #[arg(long, value_enum, default_value_t)]
    pub pixels: Pixels,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value = "1", allow_negative_numbers = true)]
    pub seed: u64,
    /// What to compare with: `none`, or an OpenEXR file [default: computed in double precision, and kept]
    #[arg(long, value_name = "none|FILE", value_parser = OsStringValueParser::new().map(Reference::from))]
    pub reference: Option<Reference>,
    /// Samples per pixel of the computed reference, a multiple of 4 [default: as many as it takes for half of the picture's noise]
    #[arg(long, value_name = "N", value_parser = samples_per_pixel, allow_negative_numbers = true)]
    pub reference_spp: Option<u32>,
    /// Give the cores up when none has said a word for so long [default: wait while their processes live; of cores started
    /// elsewhere, for a minute, and for 20 times what a unit has taken at most]
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    pub patience: Option<u64>,
    /// Folder where computed references are kept [default: fixed-point-path-tracer in XDG_CACHE_HOME or ~/.cache]
    #[arg(long, value_name = "DIR")]
    pub reference_cache: Option<PathBuf>,
    /// Folder for the results [default: out/SCENE-PROFILE of the checkout]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What `cargo xtask render` takes.
#[derive(Clone, Debug, clap::Args)]
pub struct RenderOptions {
    /// The picture.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Board of the cores; several boards, as in `versatilepb,mps2-an385`, take turns
    #[arg(
        long = "board",
        value_name = "BOARD,..",
        value_enum,
        value_delimiter = ',',
        default_value = "versatilepb"
    )]
    pub boards: Vec<Board>,
    /// Cores in QEMU, or as threads of this host
    #[arg(long, value_enum, default_value_t)]
    pub backend: Backend,
    /// Let the cores log what they do, into cores/fleet.log of the results [default: an image without a log]
    #[arg(long, value_name = "LEVEL", value_enum)]
    pub log: Option<Level>,
    /// Count cycles, too: with a plugin in QEMU, which then takes about twice as long
    #[arg(long)]
    pub cycles: bool,
    /// Cycles that an access to literals and tables in instruction memory takes longer, for the count
    #[arg(long, value_name = "N", default_value = "0", requires = "cycles")]
    pub code_access: u32,
    /// Compute in soft float instead of fixed point, by the profile's formulas, in an image that does not fit a core's memory
    #[arg(long, value_name = "f32|f64", value_enum)]
    pub soft_float: Option<SoftFloat>,
    /// Compute as `precise` does but for one choice, which is the published system's, in an image of its own
    #[arg(long, value_name = "CHOICE", value_parser = choice(), conflicts_with_all = ["soft_float", "profile", "sampler"])]
    pub choice: Option<Choice>,
    /// UDP port of the collector [default: any free one]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub port: Option<u16>,
    /// Say what is missing on this machine, and stop instead of installing it
    #[arg(long)]
    pub no_install: bool,
}

impl PictureOptions {
    /// The plan that all cores share, with units of so many samples per pixel, in a scene of this scale.
    pub fn plan(&self, samples_per_unit: u16, scale: Scale) -> Result<Plan, EpsilonError> {
        Ok(Plan {
            width: self.size.width,
            height: self.size.height,
            spp: self.spp,
            samples_per_unit,
            seed: self.seed,
            termination: self.termination.0,
            epsilon: match self.epsilon {
                Some(epsilon) => epsilon.for_core(scale.exponent)?,
                None => self.profile.epsilon(scale.magnification),
            },
        })
    }

    /// The integrator.
    pub fn integrator(&self) -> Integrator {
        self.integrator.unwrap_or(self.profile.integrator())
    }

    /// The sampler.
    pub fn sampler(&self) -> Sampler {
        self.sampler.unwrap_or(self.profile.sampler())
    }

    /// The folder for the results of the scene of this name.
    pub fn out(&self, scene: &str) -> Result<PathBuf, NoWorkspace> {
        let default = || workspace::file(&format!("out/{scene}-{}", self.profile));
        self.out.clone().map_or_else(default, Ok)
    }
}

/// Where the cores are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// One emulated board a core.
    #[default]
    Qemu,
    /// One thread of this host a core: the same units to the same bytes, without the emulator.
    Native,
}

/// Who chooses the next unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Pixels {
    /// The host leases units to cores.
    #[default]
    Leased,
    /// Each core goes through all units, from a start of its own.
    Sequential,
    /// Each core draws units at random.
    Stochastic,
}

impl Pixels {
    /// The name used by `--pixels` and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Leased => "leased",
            Self::Sequential => "sequential",
            Self::Stochastic => "stochastic",
        }
    }
}

impl From<Pixels> for PixelOrder {
    fn from(pixels: Pixels) -> Self {
        match pixels {
            Pixels::Leased => Self::Leased,
            Pixels::Sequential => Self::Sequential,
            Pixels::Stochastic => Self::Stochastic,
        }
    }
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width.
    pub width: u16,
    /// Height.
    pub height: u16,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse::<u16>().ok().filter(|&side| side > 0);
        let sides = text
            .split_once('x')
            .and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let (width, height) =
            sides.ok_or("width and height are whole numbers from 1 to 65535, as in 256x192")?;
        if u32::from(width) * u32::from(height) > MOST_PIXELS {
            return Err(format!("at most {MOST_PIXELS} pixels"));
        }
        Ok(Self { width, height })
    }
}

/// Self-intersection epsilon, in the scene's unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsilon(f64);

/// An epsilon that a core cannot have.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EpsilonError {
    /// It would skip what is to be seen.
    #[error("an --epsilon of {epsilon} is too long for this scene: use at most {most}")]
    Long {
        /// In the scene's unit.
        epsilon: f64,
        /// The longest, likewise.
        most: f64,
    },
    /// It is none.
    #[error(
        "an --epsilon of {epsilon} is shorter than what a core tells apart in this scene: use 0, or at least {least}"
    )]
    Short {
        /// In the scene's unit.
        epsilon: f64,
        /// The shortest, likewise.
        least: f64,
    },
}

impl Epsilon {
    /// As a core has it, in a scene whose lengths are times 2^`exponent` for a core.
    pub fn for_core(self, exponent: i32) -> Result<I16F16, EpsilonError> {
        // Camera rays of the standard scene start 140 before it; an epsilon of that size would skip all of it.
        const MOST: f64 = 100.0;
        let (epsilon, unit) = (self.0, 2f64.powi(exponent));
        if epsilon * unit > MOST {
            let most = MOST / unit;
            return Err(EpsilonError::Long { epsilon, most });
        }
        let bits = (epsilon * unit * 65536.0).round() as i32;
        if bits == 0 && epsilon > 0.0 {
            let least = 1.0 / 65536.0 / unit;
            return Err(EpsilonError::Short { epsilon, least });
        }
        Ok(I16F16::from_bits(bits))
    }
}

impl FromStr for Epsilon {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let value: f64 = text.parse().map_err(|_| "a number, as in 0.1".to_owned())?;
        if (0.0..=MAX_LENGTH).contains(&value) {
            Ok(Self(value))
        } else {
            Err("a distance from 0 on, in the scene's unit of length".to_owned())
        }
    }
}

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End(pub Termination);

impl FromStr for End {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let depth = |text: &str| text.parse::<u8>().ok().filter(|&depth| depth > 0);
        match text.split_once(':') {
            None if text == "roulette" => Ok(Self(Termination::Roulette)),
            Some(("depth", number)) => {
                let depth = depth(number).ok_or("a depth is a whole number from 1 to 255, as in depth:5")?;
                Ok(Self(Termination::Depth(depth)))
            }
            _ => Err("`roulette`, or a depth as in depth:5".to_owned()),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Termination::Roulette => f.write_str("roulette"),
            Termination::Depth(depth) => write!(f, "depth:{depth}"),
        }
    }
}

/// What to compare the picture with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Nothing.
    None,
    /// A picture in a file.
    File(PathBuf),
}

impl From<OsString> for Reference {
    fn from(text: OsString) -> Self {
        if text == "none" {
            Self::None
        } else {
            Self::File(text.into())
        }
    }
}

/// What `--choice` takes.
fn choice() -> impl TypedValueParser<Value = Choice> {
    let words = PossibleValuesParser::new(Choice::ALL.map(Choice::word));
    words.map(|word| Choice::ALL[Choice::number(Some(&word))])
}

/// What `--spp` takes.
pub fn samples_per_pixel(text: &str) -> Result<u32, String> {
    let samples = text
        .parse::<u32>()
        .ok()
        .filter(|&spp| spp > 0 && spp % 4 == 0 && spp <= 1 << 20);
    samples.ok_or_else(|| "a multiple of 4 (the 2x2 sub-pixels) from 4 to 1048576".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Program {
        #[command(flatten)]
        options: RenderOptions,
    }

    fn parse(arguments: &[&str]) -> Result<RenderOptions, String> {
        let words = ["render"].iter().chain(arguments);
        Program::try_parse_from(words)
            .map(|program| program.options)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn without_flags_it_is_the_standard_job() {
        let options = parse(&[]).expect("no flag is needed");
        let picture = &options.picture;
        assert_eq!(
            (options.backend, &options.boards[..], options.port),
            (Backend::Qemu, &[Board::Versatilepb][..], None)
        );
        assert_eq!(
            (picture.cores, picture.profile, picture.pixels),
            (4, Arithmetic::Precise, Pixels::Leased)
        );
        let out = picture.out("cornell").expect("tests run in the checkout");
        assert!(out.ends_with("out/cornell-precise"), "{}", out.display());
        assert_eq!(
            (picture.integrator(), picture.sampler()),
            (Integrator::NextEvent, Sampler::Kronecker)
        );
        let plan = picture.plan(24, published()).expect("no epsilon");
        assert_eq!(
            (plan.width, plan.height, plan.spp, plan.samples_per_unit),
            (256, 192, 24, 24)
        );
        assert_eq!(
            (plan.termination, plan.epsilon),
            (Termination::Roulette, Arithmetic::Precise.epsilon(0))
        );
    }

    /// The scale of the published scene.
    fn published() -> Scale {
        let path = workspace::scene(None).expect("tests run in the checkout");
        Scene::load(&path).expect("it is in order").scale()
    }

    #[test]
    fn every_flag_of_the_contract_is_taken() {
        let options = parse(&[
            "scenes/furnace.toml",
            "--size",
            "64x48",
            "--spp",
            "1024",
            "--cores",
            "2",
            "--board",
            "versatilepb,mps2-an385",
            "--backend",
            "native",
            "--profile",
            "paper",
            "--integrator",
            "next-event",
            "--sampler",
            "kronecker",
            "--epsilon",
            "0.1",
            "--termination",
            "depth:7",
            "--pixels",
            "stochastic",
            "--seed",
            "18446744073709551615",
            "--reference",
            "none",
            "--out",
            "x",
            "--port",
            "0",
            "--cycles",
            "--code-access",
            "1",
            "--no-install",
        ])
        .expect("these are all good");
        let plan = options.picture.plan(32, published()).expect("as published");
        assert_eq!(options.boards, Board::ALL);
        assert_eq!(
            (plan.spp, plan.samples_per_unit, plan.epsilon),
            (1024, 32, Arithmetic::Paper.epsilon(0))
        );
        assert_eq!((plan.termination, plan.seed), (Termination::Depth(7), u64::MAX));
        assert_eq!(options.picture.integrator(), Integrator::NextEvent);
        assert_eq!(options.picture.sampler(), Sampler::Kronecker);
        assert_eq!(options.picture.reference, Some(Reference::None));
    }

    #[test]
    fn an_epsilon_is_a_length_of_the_scene() {
        let epsilon = |text: &str| text.parse::<Epsilon>().expect("a length");
        assert_eq!(epsilon("0.1").for_core(0), Ok(Arithmetic::Paper.epsilon(0)));
        assert_eq!(epsilon("0.1").for_core(-3), Ok(I16F16::from_bits(819)));
        assert_eq!(epsilon("1e-11").for_core(40), Ok(I16F16::from_bits(720_576)));
        let refused = |text: &str, scale| epsilon(text).for_core(scale).unwrap_err().to_string();
        assert!(refused("32768", 0).contains("too long for this scene: use at most 100"));
        assert!(refused("1e-6", 0).contains("use 0, or at least 0.0000152587890625"));
    }

    #[test]
    fn bad_values_are_refused_by_name_and_with_what_would_be_good() {
        for (arguments, said) in [
            (["--spp", "0"], "a multiple of 4"),
            (["--spp", "6"], "a multiple of 4"),
            (["--spp", "-4"], "a multiple of 4"),
            (["--seed", "-1"], "invalid digit"),
            (["--size", "0x0"], "from 1 to 65535"),
            (["--size", "70000x2"], "from 1 to 65535"),
            (["--size", "64"], "as in 256x192"),
            (["--size", "65535x65535"], "at most 16777216 pixels"),
            (["--cores", "0"], "1..=1024"),
            (["--profile", "fancy"], "paper, precise"),
            (["--board", "versatilepb,z80"], "versatilepb, mps2-an385"),
            (["--sampler", "halton"], "independent, kronecker"),
            (["--choice", "roots"], "root, division, directions"),
            (["--integrator", "photons"], "path, next-event"),
            (["--epsilon", "-0.1"], "from 0 on"),
            (["--epsilon", "inf"], "from 0 on"),
            (["--epsilon", "NaN"], "from 0 on"),
            (["--epsilon", "small"], "as in 0.1"),
            (["--termination", "depth:0"], "from 1 to 255"),
            (["--termination", "never"], "roulette"),
            (["--pixels", "spiral"], "leased, sequential, stochastic"),
            (["--backend", "cloud"], "qemu, native"),
            (["--log", "loud"], "error, warn, info, debug, trace"),
            (["--code-access", "1"], "--cycles"),
            (["--port", "65536"], "0..=65535"),
            (["--patience", "0"], "1.."),
            (["--reference-spp", "7"], "a multiple of 4"),
        ] {
            let message = parse(&arguments).expect_err(arguments[1]);
            assert!(
                message.contains(said) && message.contains(arguments[0]),
                "{arguments:?}: {message}"
            );
        }
    }
}
