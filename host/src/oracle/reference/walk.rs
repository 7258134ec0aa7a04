//! One path on its way, and what it is worth.

use super::ball::Ray;
use super::lights::Place;
use super::vector::Vector;

const DARK: Vector = Vector::of([0.0; 3]);

/// What a path is worth.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Radiance that the camera sees of emitters, as they are and in mirrors and glass.
    pub(super) seen: Vector,
    /// Radiance that surfaces reflect.
    pub(super) reflected: Vector,
    /// An estimate of the mean square of what a *plain* path brings: Kajiya's walk, that only meets light and is as long.
    pub(super) plain_square: Vector,
    /// The same of a path that looks for light at diffuse surfaces, and sets out for neither images nor caustics.
    pub(super) looking_square: Vector,
}

impl Sample {
    pub(super) const NOTHING: Self = Self {
        seen: DARK,
        reflected: DARK,
        plain_square: DARK,
        looking_square: DARK,
    };
}

/// A path, backwards from the camera, up to a surface that it is about to meet.
///
/// It goes where a plain path may go, and carries what that would: but it goes there more often or less, by `chance`. So what it finds has
/// the expected value of what a plain path finds, and so have the squares. A plain path's grows by `v (v + 2 s)` where it
/// meets light `v` after `s`; and that of a path that looks for light, with its own shares of light for `v` and `s`.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    pub(super) ray: Ray,
    /// What is left of light from here on, on a plain path.
    pub(super) throughput: Vector,
    /// How often a plain path goes this way, of how often this one does.
    pub(super) chance: f64,
    /// Surfaces so far.
    pub(super) met: u32,
    pub(super) start: Start,
    /// The first specular ball since the start.
    pub(super) by: Option<usize>,
    /// What a plain path has met so far.
    plain: Vector,
    /// What a path that looks for light has found so far.
    looking: Vector,
}

/// Where a path has last been free to choose.
#[derive(Clone, Copy)]
pub(super) enum Start {
    Camera,
    /// From the camera for nothing but the emitters that are seen.
    Glimpse,
    /// At a diffuse surface.
    Diffuse(Departure),
    /// There, for the image of an emitter in this ball; and what light that is found so counts.
    Image(Departure, usize, f64),
}

/// How a path has left a diffuse surface.
#[derive(Clone, Copy)]
pub(super) struct Departure {
    pub(super) place: Place,
    /// Whether it is the first from the camera.
    pub(super) is_first: bool,
    pub(super) direction: Vector,
    /// Of the direction, by solid angle.
    pub(super) density: f64,
}

/// What found light counts.
#[derive(Clone, Copy)]
pub(super) struct Weight {
    /// Of radiance, and of what a plain path meets.
    pub(super) here: f64,
    /// What a path that looks for light counts of it, in one of both ways.
    pub(super) looking: f64,
    /// And with what weight that is known.
    pub(super) known: f64,
}

impl Weight {
    /// All of it.
    pub(super) const WHOLE: Self = Self::path(1.0);

    /// Of light that is found by one path or another, which is nothing that looking for light knows of.
    pub(super) const fn path(weight: f64) -> Self {
        Self {
            here: weight,
            looking: 1.0,
            known: weight,
        }
    }
}

impl Walk {
    pub(super) fn new(ray: Ray, start: Start) -> Self {
        Self {
            ray,
            throughput: Vector::of([1.0; 3]),
            chance: 1.0,
            met: 0,
            start,
            by: None,
            plain: DARK,
            looking: DARK,
        }
    }

    /// Light by a connection.
    pub(super) fn see(&mut self, emission: Vector, weight: Weight, found: &mut Sample) {
        found.reflected = found.reflected + self.count(emission, weight, found);
    }

    /// Light by the path itself.
    pub(super) fn meet(&mut self, emission: Vector, weight: Weight, found: &mut Sample) {
        let radiance = self.count(emission, weight, found);
        match self.start {
            Start::Camera | Start::Glimpse => found.seen = found.seen + radiance,
            Start::Diffuse(_) | Start::Image(..) => found.reflected = found.reflected + radiance,
        }
        self.plain = self.plain + self.throughput.times(emission);
    }

    /// Radiance; the squares are counted.
    fn count(&mut self, emission: Vector, weight: Weight, found: &mut Sample) -> Vector {
        let light = self.throughput.times(emission);
        let counted = light * weight.looking;
        let here = weight.here * self.chance;
        let plain = light.times(light + self.plain * 2.0) * here;
        let looking = counted.times(counted + self.looking * 2.0) * (weight.known * self.chance);
        found.plain_square = found.plain_square + plain;
        found.looking_square = found.looking_square + looking;
        self.looking = self.looking + counted;
        light * here
    }
}
