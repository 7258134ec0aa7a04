//! Caustics: small bright places where a glass ball gathers an emitter's light.
//!
//! What other surfaces receive from them is rare and bright: a path there finds the emitter through the ball more often than not. So a few of the
//! paths that leave a diffuse surface set out for a caustic, and the directions of all count by the density of both ways together: by one
//! minus [`AIMED`] in the others at least, so that no weight is large.

use super::ball::{Balls, Ray};
use super::images::Image;
use super::lights::Place;
use super::sampling::{cosine_density, cosine_weighted, height_of_cone, within_cone};
use super::vector::Vector;

/// How many paths set out for a caustic where one can be seen.
const AIMED: f64 = 0.04;
/// How large it is taken to be, of the ball's radius.
const SIZE: f64 = 0.6;

/// A ball around a caustic.
pub(super) struct Caustic {
    middle: Vector,
    radius: f64,
}

impl Caustic {
    /// Where a ray that leaves a ball of this radius falls on a surface, if it does.
    pub(super) fn behind(ray: &Ray, radius: f64, balls: &Balls) -> Option<Self> {
        let (_, distance) = balls.nearest(ray)?;
        Some(Self {
            middle: ray.origin + ray.direction * distance,
            radius: SIZE * radius,
        })
    }

    /// Whether a point is in it.
    pub(super) fn holds(&self, point: Vector) -> bool {
        let aside = point - self.middle;
        aside.dot(aside) < self.radius * self.radius
    }

    /// The cone that it fills, seen from outside and above the horizon.
    fn cone(&self, place: &Place) -> Option<Cone> {
        let to_middle = self.middle - place.point;
        let square = to_middle.dot(to_middle);
        let sine_square = self.radius * self.radius / square;
        (sine_square < 1.0 && to_middle.dot(place.normal) > 0.0).then(|| Cone {
            axis: to_middle * (1.0 / square.sqrt()),
            height: height_of_cone(sine_square),
        })
    }
}

struct Cone {
    axis: Vector,
    height: f64,
}

/// Where a path may go on from a diffuse surface.
pub(super) struct Onward {
    normal: Vector,
    /// What some of the paths set out for.
    caustic: Option<Cone>,
}

impl Onward {
    /// The first of the caustics that can be seen is aimed at.
    pub(super) fn new(place: &Place, images: &[Image]) -> Self {
        Self {
            normal: place.normal,
            caustic: images
                .iter()
                .find_map(|image| image.caustic.as_ref()?.cone(place)),
        }
    }

    /// A direction, which may be below the horizon.
    pub(super) fn direction(&self, [choice, around]: [f64; 2]) -> Vector {
        match &self.caustic {
            None => cosine_weighted(self.normal, [choice, around]),
            Some(cone) if choice < AIMED => within_cone(cone.axis, cone.height, [choice / AIMED, around]),
            Some(_) => cosine_weighted(self.normal, [(choice - AIMED) / (1.0 - AIMED), around]),
        }
    }

    /// Density of [`Onward::direction`] by solid angle, at this cosine to the normal.
    pub(super) fn density(&self, direction: Vector, cosine: f64) -> f64 {
        let plain = cosine_density(cosine);
        let Some(cone) = &self.caustic else {
            return plain;
        };
        // By the distance to its middle, which stays exact in a cone that is next to nothing.
        let aside = direction - cone.axis;
        let is_within = aside.dot(aside) <= 2.0 * cone.height;
        let aimed = if is_within {
            1.0 / (std::f64::consts::TAU * cone.height)
        } else {
            0.0
        };
        (1.0 - AIMED) * plain + AIMED * aimed
    }
}
