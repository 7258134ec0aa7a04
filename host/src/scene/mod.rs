//! A scene as its author wrote it: spheres, materials and a camera, in double precision.
//!
//! The text format is described in `docs/scene-format.md`. [`Scene::load`] accepts nothing that the fixed-point tracer
//! could not hold: whatever it returns has lengths that fit a core together, a light, and a camera in free space. Turning
//! it into the bytes a core reads is the scene compiler's business, which also chooses a core's unit of length.

mod compile;
mod emitters;
mod fixed;
mod guides;
mod light;
mod limits;
mod parse;
mod proof;
mod reach;
mod room;
mod scale;
mod start;
mod unit_size;
mod validate;
mod vast;
mod vector;

use std::path::{Path, PathBuf};

pub use compile::{Blob, CompiledScene, compile};
pub(crate) use compile::{material as material_record, record as sphere_record};
pub(crate) use reach::REACH;
pub use scale::Scale;
pub use unit_size::samples_per_unit;
pub(crate) use vast::record as vast_record;

/// A checked scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What reports call it: the file's name without its extension.
    pub name: String,
    /// Where it is seen from.
    pub camera: Camera,
    /// Everything in it, in the file's order.
    pub spheres: Vec<Sphere>,
}

/// How the radiance along a camera ray is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// By paths that meet light, as published.
    Path,
    /// By paths that look for light as well, at each surface that is not specular.
    NextEvent,
}

impl Integrator {
    /// All there are.
    pub const ALL: [Self; 2] = [Self::Path, Self::NextEvent];

    /// The name used by `--integrator` and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::NextEvent => "next-event",
        }
    }
}

impl std::fmt::Display for Integrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// A pinhole camera whose image plane stands at distance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole.
    pub position: [f64; 3],
    /// Viewing direction, a unit vector.
    pub direction: [f64; 3],
    /// A unit vector that points up in the picture; never parallel to `direction`, not always perpendicular to it.
    pub up: [f64; 3],
    /// Height of the image plane at distance 1 from the pinhole, unless `plane_width` makes it lower.
    pub plane_height: f64,
    /// The most that the image plane is wide; any width without it.
    pub plane_width: Option<f64>,
    /// How far along its unit direction a ray starts; what lies nearer to the pinhole is not seen.
    pub near: f64,
}

impl Camera {
    /// Height of the image plane for a picture of `width` by `height` pixels; it is as wide as the picture's shape says.
    pub fn height_for(&self, width: u16, height: u16) -> f64 {
        let aspect = f64::from(width) / f64::from(height);
        let widest = self.plane_width.unwrap_or(f64::INFINITY);
        self.plane_height.min(widest / aspect)
    }
}

/// A sphere and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// A name, unique within the scene.
    pub name: String,
    /// Centre.
    pub centre: [f64; 3],
    /// Radius, at least [`MIN_RADIUS`].
    pub radius: f64,
    /// Seen from within: the solid is everything outside. Walls are hollow spheres.
    pub hollow: bool,
    /// Radiance it emits, each component from 0 to [`MAX_EMISSION`].
    pub emission: [f64; 3],
    /// How it scatters light.
    pub material: Material,
}

/// How a surface scatters light. Colours are reflectances from 0 to [`MAX_REFLECTANCE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Lambert's law.
    Diffuse([f64; 3]),
    /// A perfect mirror.
    Mirror([f64; 3]),
    /// A smooth dielectric in air.
    Glass {
        /// Share of light that survives each encounter with the surface.
        tint: [f64; 3],
        /// Index of refraction, above 1 and at most [`MAX_INDEX`].
        index: f64,
    },
}

/// The version of the text format this build reads.
pub const FORMAT: i64 = 1;
/// More spheres than this do not fit a core's data memory beside its stack.
pub const MAX_SPHERES: usize = tracer::scene::MAX_PRIMITIVES;
/// No coordinate or radius is longer, in whatever unit: what is is a slip.
pub const MAX_LENGTH: f64 = 1e12;
/// No radius is shorter, likewise.
pub const MIN_RADIUS: f64 = 1e-12;
/// Spheres that are smaller for a core leave too few of 16 fraction bits for 1/r and r².
const MIN_CORE_RADIUS: f64 = 1.0 / 256.0;
/// Brighter lights could overflow a work unit's 24:16 sums.
pub const MAX_EMISSION: f64 = 4095.0;
/// Roulette ends a path with probability one minus the reflectance, so the reflectance stays below one.
pub const MAX_REFLECTANCE: f64 = 0.999;
/// The largest index of refraction; diamond has 2.4.
pub const MAX_INDEX: f64 = 4.0;

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read.
    #[error("cannot read the scene {}: {source}; name a scene file, e.g. scenes/cornell.toml", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text has faults; each line of the message is one of them.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Invalid(Vec<Fault>),
    /// Rays of a picture of this shape would start inside a solid.
    #[error("{scene} cannot be seen at {width}x{height}: {cause}")]
    Frame {
        /// The scene's name.
        scene: String,
        /// Width in pixels.
        width: u16,
        /// Height in pixels.
        height: u16,
        /// Which ray, and what to do.
        cause: String,
    },
}

/// One thing wrong with a scene's text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {message}")]
pub struct Fault {
    /// The file's name, as given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Cause, and what to do.
    pub message: String,
}

impl Scene {
    /// Reads and checks the scene in the file at `path`.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let text = std::fs::read_to_string(path).map_err(|source| SceneError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&path.display().to_string(), &text)
    }

    /// Checks the scene in `text`; `file` is what messages call it, and its stem is the scene's name.
    pub fn parse(file: &str, text: &str) -> Result<Self, SceneError> {
        let mut source = parse::Source::new(file, text);
        let draft = source
            .read()
            .inspect(|draft| validate::validate(draft, &mut source));
        match draft {
            Some(draft) if source.is_clean() => Ok(Self {
                name: Path::new(file)
                    .file_stem()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned(),
                camera: draft.camera,
                spheres: draft.spheres.into_iter().map(|placed| placed.sphere).collect(),
            }),
            _ => Err(SceneError::Invalid(source.into_faults())),
        }
    }

    /// The scale at which cores see it.
    ///
    /// # Panics
    /// If the scene is too wide for a core, which a checked one is not.
    pub fn scale(&self) -> Scale {
        let spheres: Vec<&Sphere> = self.spheres.iter().collect();
        Scale::of(&spheres, &self.camera).expect("a checked scene fits a core")
    }

    /// Checks that every ray of a picture of this size starts in free space.
    ///
    /// [`Scene::load`] has checked it for the default shape of 4:3; a wider picture looks further to the sides.
    pub fn check_frame(&self, width: u16, height: u16) -> Result<(), SceneError> {
        let spheres: Vec<&Sphere> = self.spheres.iter().collect();
        let Some(blocked) = validate::first_blocked_ray(&self.camera, &spheres, width, height) else {
            return Ok(());
        };
        let cause = format!(
            "{} starts inside the solid of sphere \"{}\"; choose a shape nearer to 4:3, or give the camera a `plane_width`",
            blocked.rays, spheres[blocked.sphere].name
        );
        Err(SceneError::Frame {
            scene: self.name.clone(),
            width,
            height,
            cause,
        })
    }
}

#[cfg(test)]
mod emitters_tests;
#[cfg(test)]
mod fitting_tests;
#[cfg(test)]
mod guides_tests;
#[cfg(test)]
mod scale_tests;
#[cfg(test)]
mod tests;
