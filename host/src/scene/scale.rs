//! How long a scene's unit of length is for a core.
//!
//! A core's lengths are 16:16, a scene's are in whatever unit its author likes. So the compiler multiplies all of them by a power of
//! two: the largest that leaves everything within the tracer's reach. A power of two changes no digit of a number, and the
//! choice itself goes by ratios of lengths, so a scene times 2^k is the same bytes for a core.
//!
//! A few spheres may be in the way of that: walls, grounds and skies of a radius a thousand times as long as what stands on them.
//! Where they would leave the smallest sphere less than [`FINE`], the largest are taken for *vast*
//! ([`tracer::geometry::sphere::VastSphere`]): what counts of them is where rays meet them, not where their centres are.

use super::reach::{Extent, REACH, reach};
use super::vector::{length, sub};
use super::{Camera, MIN_CORE_RADIUS, Scene, Sphere};

/// A smallest radius for a core that is not worth a vast sphere, which costs more than an ordinary one. The Cornell box at an eighth,
/// with a smallest radius of 2.06, has a lockstep bias of -0.008 % +- 0.019 %, at a 32nd one of -0.045 % +- 0.026 %.
const FINE: f64 = 2.0;
/// Radii from which on spheres are tried as vast, the longest first: walls, grounds and skies are few, and what each try costs goes
/// with the square of how many spheres there are.
const MOST_CUTS: usize = 16;
/// The longest ordinary radius: the largest whole number of 16:16.
pub(super) const LONGEST: f64 = 32_767.0;

/// The smallest radius of the Cornell box, rounded down to a power of two.
const PUBLISHED: f64 = 16.0;

/// How a core's lengths come from a scene's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// They are the scene's times 2^exponent.
    pub exponent: i32,
    /// The smallest sphere is 2^magnification times as large for a core as that of the Cornell box, or up to twice that.
    pub magnification: i32,
    /// Spheres of this radius and longer ones are vast, in the scene's unit.
    vast_from: f64,
}

/// A scene of which no scale is right: beside `large`, `small` is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooWide {
    pub(super) large: Option<usize>,
    pub(super) small: usize,
    /// The least radius that would not be.
    pub(super) least: f64,
}

impl Scale {
    /// The scale for a scene of these spheres, in their order, seen from this camera first.
    pub(super) fn of(spheres: &[&Sphere], camera: &Camera) -> Result<Self, TooWide> {
        let smallest = (0..spheres.len()).min_by(|&a, &b| spheres[a].radius.total_cmp(&spheres[b].radius));
        let smallest = smallest.unwrap_or_default();
        let smallest_radius = spheres.get(smallest).map_or(1.0, |sphere| sphere.radius);
        let mut cuts: Vec<f64> = spheres.iter().map(|sphere| sphere.radius).collect();
        cuts.sort_by(|a, b| b.total_cmp(a));
        cuts.dedup();
        let mut best: Option<(Limit, f64)> = None;
        for vast_from in std::iter::once(f64::INFINITY).chain(cuts.into_iter().take(MOST_CUTS)) {
            let Some(limit) = limit(spheres, camera, vast_from) else {
                continue;
            };
            if best.is_none_or(|(best, _)| limit.exponent > best.exponent) {
                best = Some((limit, vast_from));
            }
            if smallest_radius * power(limit.exponent) >= FINE {
                break;
            }
        }
        let (limit, vast_from) = best.expect("ordinary spheres always have a limit");
        if smallest_radius * power(limit.exponent) < MIN_CORE_RADIUS {
            return Err(TooWide {
                large: limit.by,
                small: smallest,
                least: MIN_CORE_RADIUS * power(-limit.exponent),
            });
        }
        let core_radius = smallest_radius * power(limit.exponent);
        Ok(Self {
            exponent: limit.exponent,
            magnification: (core_radius / PUBLISHED).log2().floor() as i32,
            vast_from,
        })
    }

    /// The scene in a core's unit.
    pub(super) fn applied(self, scene: &Scene) -> Scene {
        let factor = power(self.exponent);
        scene.with_lengths(|v| v.map(|c| c * factor), factor)
    }

    /// Where rays start in a scene in a core's unit.
    pub(super) fn extent<'s>(self, spheres: &'s [&'s Sphere], camera: &'s Camera) -> Extent<'s> {
        Extent::of(spheres, camera, self.core_length(self.vast_from))
    }

    /// A length of the scene in a core's unit.
    pub(super) fn core_length(self, length: f64) -> f64 {
        length * power(self.exponent)
    }

    /// Whether a sphere of this radius in a core's unit is vast.
    pub(super) fn is_vast(self, core_radius: f64) -> bool {
        core_radius >= self.vast_from * power(self.exponent)
    }
}

/// The largest exponent, and the sphere that allows no larger one; none if the camera does not.
#[derive(Clone, Copy, Debug)]
struct Limit {
    exponent: i32,
    by: Option<usize>,
}

/// The limit where spheres from a radius of `vast_from` on are vast; none where one of them would not be vast enough.
fn limit(spheres: &[&Sphere], camera: &Camera, vast_from: f64) -> Option<Limit> {
    let mut limit = Limit {
        exponent: exponent_below(LONGEST, camera.near),
        by: None,
    };
    let mut at_most = |exponent: i32, by: Option<usize>| {
        if exponent < limit.exponent {
            limit = Limit { exponent, by };
        }
    };
    let extent = Extent::of(spheres, camera, vast_from);
    let is_vast = |sphere: &Sphere| sphere.radius >= vast_from;
    if spheres.iter().any(|sphere| is_vast(sphere)) {
        at_most(exponent_below(REACH, extent.radius), extent.widest);
    }
    for (index, sphere) in spheres.iter().enumerate() {
        let exponent = if is_vast(sphere) {
            let away = (length(sub(extent.middle, sphere.centre)) - sphere.radius).abs();
            let horizon = extent.horizon(index);
            exponent_below(REACH, away).min(exponent_below(2.0 * REACH, horizon))
        } else {
            let farthest = extent.farthest_start(sphere.centre);
            let longest = if sphere.is_crossed() { REACH } else { LONGEST };
            exponent_below(reach(sphere), farthest).min(exponent_below(longest, sphere.radius))
        };
        at_most(exponent, Some(index));
    }
    let vast_enough = |sphere: &&Sphere| sphere.radius * power(limit.exponent) >= 2.0 * REACH;
    let mut vast = spheres.iter().filter(|sphere| is_vast(sphere));
    vast.all(vast_enough).then_some(limit)
}

/// 2^exponent.
pub(super) fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

/// The largest exponent for which `value` times its power is less than `limit`; no more than lengths of a scene need.
fn exponent_below(limit: f64, value: f64) -> i32 {
    /// 2^60 units: longer than any room for a value is.
    const MOST: i32 = 60;
    let mut exponent = ((limit / value).log2().floor().min(f64::from(MOST))) as i32;
    while value * power(exponent) >= limit {
        exponent -= 1;
    }
    while exponent < MOST && value * power(exponent + 1) < limit {
        exponent += 1;
    }
    exponent
}

impl Scene {
    /// The scene moved by so much.
    pub(super) fn moved(&self, by: [f64; 3]) -> Self {
        self.with_lengths(|point| [0, 1, 2].map(|i| point[i] + by[i]), 1.0)
    }

    /// The scene with its points where `at` says, and its other lengths times `factor`.
    fn with_lengths(&self, at: impl Fn([f64; 3]) -> [f64; 3], factor: f64) -> Self {
        let spheres = self.spheres.iter().map(|sphere| Sphere {
            centre: at(sphere.centre),
            radius: sphere.radius * factor,
            ..sphere.clone()
        });
        Self {
            name: self.name.clone(),
            camera: Camera {
                position: at(self.camera.position),
                near: self.camera.near * factor,
                ..self.camera
            },
            spheres: spheres.collect(),
        }
    }
}
