//! One path through a scene in plain double precision, as a textbook has it.
//!
//! Nothing here is shared with the tracer that runs on the cores. It is the second opinion: light is followed backwards from the
//! camera (Kajiya 1986), one random choice per decision, and at diffuse surfaces looked for as well ([`super::lights`]).

use super::Termination;
use super::ball::{Ball, Ray, first_hit};
use super::camera::View;
use super::lights::{Lights, Place};
use super::sampling::{Draws, cosine_weighted};
use super::vector::Vector;
use crate::scene::{Material, Scene};

/// Surfaces that a path meets before roulette begins.
const SURE_SURFACES: u32 = 5;

/// The scene as the inner loop wants it: what every ray reads side by side, the rest apart.
pub(super) struct World {
    balls: Vec<Ball>,
    surfaces: Vec<Surface>,
    lights: Lights,
}

struct Surface {
    emission: Vector,
    emits: bool,
    colour: Vector,
    /// The chance to survive roulette here.
    strongest: f64,
    kind: Kind,
}

enum Kind {
    Diffuse,
    Mirror,
    Glass { index: f64 },
}

impl World {
    pub(super) fn new(scene: &Scene) -> Self {
        Self::with(scene, Lights::new(scene))
    }

    /// Without light sampling: nothing but Kajiya's walk.
    #[cfg(test)]
    pub(super) fn plain(scene: &Scene) -> Self {
        Self::with(scene, Lights::none())
    }

    fn with(scene: &Scene, lights: Lights) -> Self {
        let balls = scene.spheres.iter().map(|sphere| Ball {
            centre: Vector::of(sphere.centre),
            radius: sphere.radius,
        });
        let surfaces = scene.spheres.iter().map(|sphere| {
            let (colour, kind) = match sphere.material {
                Material::Diffuse(colour) => (colour, Kind::Diffuse),
                Material::Mirror(colour) => (colour, Kind::Mirror),
                Material::Glass { tint, index } => (tint, Kind::Glass { index }),
            };
            let strongest = colour.into_iter().fold(0.0, f64::max);
            Surface {
                emission: Vector::of(sphere.emission),
                emits: sphere.emission != [0.0; 3],
                colour: Vector::of(colour),
                strongest,
                kind,
            }
        });
        Self {
            balls: balls.collect(),
            surfaces: surfaces.collect(),
            lights,
        }
    }

    /// One sample of a pixel.
    pub(super) fn sample(
        &self,
        view: &View,
        pixel: [u16; 2],
        sub_pixel: [u8; 2],
        termination: Termination,
        draws: &mut Draws<'_>,
    ) -> Sample {
        let mut ray = view.ray(pixel, sub_pixel, draws);
        let mut found = Found::default();
        let mut throughput = Vector::of([1.0; 3]);
        let mut met = 0;
        // The diffuse surface that the ray comes from, where its light was looked for as well.
        let mut looked_from: Option<Place> = None;
        while let Some(hit) = first_hit(&self.balls, &ray) {
            let surface = &self.surfaces[hit.ball];
            met += 1;
            if surface.emits {
                let weight = looked_from.map_or(1.0, |place| self.weight(&place, ray.direction));
                found.meet(throughput.times(surface.emission), weight);
            }
            let ends = matches!(termination, Termination::Depth(limit) if met >= u32::from(limit));
            if ends || surface.strongest == 0.0 {
                break;
            }
            throughput = throughput.times(surface.colour);
            let place = Place {
                point: hit.point,
                normal: facing(hit.outward, ray.direction),
                ball: hit.ball,
            };
            let is_diffuse = matches!(surface.kind, Kind::Diffuse);
            if is_diffuse && let Some((emission, weight)) = self.look_for_light(&place, met, draws) {
                found.see(throughput.times(emission), weight);
            }
            if termination == Termination::Roulette && met > SURE_SURFACES {
                if draws.uniform() >= surface.strongest {
                    break;
                }
                throughput = throughput * (1.0 / surface.strongest);
            }
            ray = Ray {
                origin: hit.point,
                direction: scatter(&surface.kind, ray.direction, hit.outward, met, draws),
                departed: Some(hit.ball),
            };
            looked_from = is_diffuse.then_some(place);
        }
        found.sample
    }

    /// Light from a direction in which emitters are, and how much of it counts at `place`, the surface `number` of its path.
    fn look_for_light(&self, place: &Place, number: u32, draws: &mut Draws<'_>) -> Option<(Vector, f64)> {
        let direction = self.lights.direction(place, number, draws)?;
        if direction.dot(place.normal) <= 0.0 {
            return None;
        }
        let ray = Ray {
            origin: place.point,
            direction,
            departed: Some(place.ball),
        };
        // Whichever surface it is: the weights are about directions, not about emitters.
        let surface = &self.surfaces[first_hit(&self.balls, &ray)?.ball];
        surface
            .emits
            .then(|| (surface.emission, self.weight(place, direction)))
    }

    fn weight(&self, place: &Place, direction: Vector) -> f64 {
        self.lights.weight(place, direction, direction.dot(place.normal))
    }
}

/// What a path is worth.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Radiance.
    pub(super) radiance: Vector,
    /// An estimate of the mean square of what a *plain* path brings: Kajiya's walk, that only meets light and is as long.
    pub(super) plain_square: Vector,
}

/// Light along a path.
///
/// A plain path counts all that it meets as a whole, with a chance of which `weight`, over both ways of finding light, is an estimate. Its
/// square grows by `v (v + 2 s)` where it meets `v` after `s`, and the mean of that is estimated as the mean of `v` is.
struct Found {
    sample: Sample,
    /// What a plain path has met so far.
    met: Vector,
}

impl Default for Found {
    fn default() -> Self {
        let dark = Vector::of([0.0; 3]);
        Self {
            sample: Sample {
                radiance: dark,
                plain_square: dark,
            },
            met: dark,
        }
    }
}

impl Found {
    /// Light by a connection.
    fn see(&mut self, light: Vector, weight: f64) {
        let growth = light.times(light + self.met * 2.0);
        self.sample.radiance = self.sample.radiance + light * weight;
        self.sample.plain_square = self.sample.plain_square + growth * weight;
    }

    /// Light by the path itself.
    fn meet(&mut self, light: Vector, weight: f64) {
        self.see(light, weight);
        self.met = self.met + light;
    }
}

/// The normal on the side from which a ray comes.
fn facing(outward: Vector, incoming: Vector) -> Vector {
    if outward.dot(incoming) < 0.0 {
        outward
    } else {
        outward * -1.0
    }
}

/// The direction in which light that arrives along `incoming` goes on (or came from: paths run backwards) at surface `number`.
fn scatter(kind: &Kind, incoming: Vector, outward: Vector, number: u32, draws: &mut Draws<'_>) -> Vector {
    let normal = facing(outward, incoming);
    match *kind {
        Kind::Diffuse => cosine_weighted(normal, draws.of_direction(number)),
        Kind::Mirror => reflected(incoming, normal),
        Kind::Glass { index } => {
            let entering = outward.dot(incoming) < 0.0;
            let ratio = if entering { 1.0 / index } else { index };
            let cos_in = -incoming.dot(normal);
            let cos_out_squared = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in);
            if cos_out_squared < 0.0 {
                return reflected(incoming, normal);
            }
            let cos_out = cos_out_squared.sqrt();
            // Schlick's approximation takes the angle on the thin side.
            let steep = 1.0 - if entering { cos_in } else { cos_out };
            let head_on = ((index - 1.0) / (index + 1.0)).powi(2);
            let reflectance = head_on + (1.0 - head_on) * steep.powi(5);
            if draws.of_choice(number) < reflectance {
                reflected(incoming, normal)
            } else {
                (incoming * ratio + normal * (ratio * cos_in - cos_out)).normalised()
            }
        }
    }
}

fn reflected(incoming: Vector, normal: Vector) -> Vector {
    incoming - normal * (2.0 * normal.dot(incoming))
}
