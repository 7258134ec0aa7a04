//! Paths through a scene in plain double precision, as a textbook has them.
//!
//! Nothing here is shared with the tracer that runs on the cores. It is the second opinion: light is followed backwards from the
//! camera (Kajiya 1986), one random choice per decision, and at diffuse surfaces looked for as well: by [`super::lights`] where nothing is
//! between, by [`super::images`] in balls.

use super::Termination;
use super::ball::{Ball, Balls, Hit, Ray};
use super::camera::SubPixel;
use super::caustics::Onward;
use super::images::{self, Image};
use super::lights::{Lights, Place};
use super::sampling::{Draws, cosine_density};
use super::vector::Vector;
use super::walk::{Departure, Sample, Start, Walk, Weight};
use crate::scene::{Material, Scene};

/// Surfaces that a path meets before roulette begins.
const SURE_SURFACES: u32 = 5;
/// How often each image is tried at a diffuse surface.
const TRIED: f64 = 0.1;
/// And where its light is gathered: at the first such surface from the camera, and at others.
const TRIED_IN_CAUSTICS: [f64; 2] = [8.0, 1.0];
/// Surfaces from the camera on at which a path through glass takes both ways: the lamp's reflection on a glass ball is rare and bright.
const SPLIT: u32 = 2;
/// Glimpses by which emitters are seen where they have an edge: a square of so many a side.
const GLIMPSES: u32 = 4;

/// The scene as the inner loop wants it: what every ray reads side by side, the rest apart.
pub(super) struct World {
    balls: Balls,
    surfaces: Vec<Surface>,
    lights: Lights,
    images: Vec<Image>,
    /// The hollow balls, outside of which all is solid.
    walls: Vec<usize>,
    termination: Termination,
    /// Whether a sample takes more than one way from the camera.
    splits: bool,
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
    pub(super) fn new(scene: &Scene, termination: Termination) -> Self {
        let mut world = Self::looking(scene, termination);
        world.images = images::all(scene, world.lights.emitters(), &world.balls);
        world.splits = true;
        world
    }

    /// Without what finds light by way of balls, and with one path a sample.
    pub(super) fn looking(scene: &Scene, termination: Termination) -> Self {
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
        let walls = (0..).zip(&scene.spheres).filter(|(_, sphere)| sphere.hollow);
        Self {
            walls: walls.map(|(number, _)| number).collect(),
            balls: Balls::new(balls.collect()),
            surfaces: surfaces.collect(),
            lights: Lights::new(scene),
            images: Vec::new(),
            termination,
            splits: false,
        }
    }

    /// Nothing but Kajiya's walk.
    #[cfg(test)]
    pub(super) fn plain(scene: &Scene, termination: Termination) -> Self {
        Self {
            lights: Lights::none(),
            ..Self::looking(scene, termination)
        }
    }

    /// One sample of a sub-pixel.
    pub(super) fn sample(&self, sub_pixel: &SubPixel<'_>, draws: &mut Draws<'_>) -> Sample {
        let ray = sub_pixel.ray(draws.of_pixel());
        let mut found = Sample::NOTHING;
        self.follow(Walk::new(ray, Start::Camera), draws, &mut found);
        found
    }

    /// Whether more or less of emitters is seen from one place of a sub-pixel to another, as far as some glimpses tell.
    pub(super) fn shows_an_edge(&self, sub_pixel: &SubPixel<'_>, draws: &mut Draws<'_>) -> bool {
        let mut glimpses = (0..GLIMPSES * GLIMPSES).map(|number| self.glimpse(number, sub_pixel, draws));
        let first = glimpses.next();
        self.splits && glimpses.any(|glimpse| Some(glimpse) != first)
    }

    /// What is seen of emitters, as [`Sample::seen`] has it, by many glimpses.
    pub(super) fn seen(&self, sub_pixel: &SubPixel<'_>, draws: &mut Draws<'_>) -> Vector {
        let all = GLIMPSES * GLIMPSES;
        let glimpses = (0..all).map(|number| self.glimpse(number, sub_pixel, draws));
        glimpses.fold(Vector::of([0.0; 3]), |sum, glimpse| sum + glimpse) * (1.0 / f64::from(all))
    }

    fn glimpse(&self, number: u32, sub_pixel: &SubPixel<'_>, draws: &mut Draws<'_>) -> Vector {
        let [x, y] = draws.point();
        let cell = [number % GLIMPSES, number / GLIMPSES].map(f64::from);
        let side = f64::from(GLIMPSES);
        let ray = sub_pixel.ray([(cell[0] + x) / side, (cell[1] + y) / side]);
        let mut found = Sample::NOTHING;
        self.follow(Walk::new(ray, Start::Glimpse), draws, &mut found);
        found.seen
    }

    /// Follows a path to its end, and adds what it finds.
    fn follow(&self, mut walk: Walk, draws: &mut Draws<'_>, found: &mut Sample) {
        let mut seen = self.wall_around(&walk.ray);
        while let Some(hit) = seen.take().or_else(|| self.balls.first_hit(&walk.ray)) {
            if matches!(walk.start, Start::Image(_, ball, _) if walk.by.is_none() && ball != hit.ball) {
                return;
            }
            let surface = &self.surfaces[hit.ball];
            walk.met += 1;
            if surface.emits {
                let weight = self.weight(&walk);
                walk.meet(surface.emission, weight, found);
            }
            if surface.strongest == 0.0 || self.is_last(walk.met) {
                return;
            }
            walk.throughput = walk.throughput.times(surface.colour);
            let goes_on = match surface.kind {
                Kind::Diffuse => self.diffuse(&mut walk, &hit, draws, found),
                Kind::Mirror => self.mirror(&mut walk, &hit, draws),
                Kind::Glass { index } => self.glass(&mut walk, &hit, index, draws, found),
            };
            if !goes_on {
                return;
            }
            walk.ray.origin = hit.point;
            walk.ray.departed = Some(hit.ball);
        }
    }

    /// The wall that a camera ray starts in, as the filter has it at the rim of a picture of large pixels: it is seen at once.
    fn wall_around(&self, ray: &Ray) -> Option<Hit> {
        if ray.departed.is_some() {
            return None;
        }
        self.walls.iter().find_map(|&wall| self.balls.beyond(wall, ray))
    }

    fn is_last(&self, met: u32) -> bool {
        matches!(self.termination, Termination::Depth(limit) if met >= u32::from(limit))
    }

    /// Whether roulette lets a path go on from the surface that it has met.
    fn survives(&self, walk: &mut Walk, ball: usize, draws: &mut Draws<'_>) -> bool {
        if self.termination != Termination::Roulette || walk.met <= SURE_SURFACES {
            return true;
        }
        let chance = self.surfaces[ball].strongest;
        walk.throughput = walk.throughput * (1.0 / chance);
        draws.uniform() < chance
    }

    /// Looks for light, and goes on in any direction.
    fn diffuse(&self, walk: &mut Walk, hit: &Hit, draws: &mut Draws<'_>, found: &mut Sample) -> bool {
        if matches!(walk.start, Start::Image(..) | Start::Glimpse) {
            return false;
        }
        let place = Place {
            point: hit.point,
            normal: facing(hit.outward, walk.ray.direction),
            ball: hit.ball,
        };
        let onward = Onward::new(&place, &self.images);
        if let Some((emission, weight)) = self.look_for_light(&place, &onward, walk.met, draws) {
            walk.see(emission, weight, found);
        }
        if !self.survives(walk, hit.ball, draws) {
            return false;
        }
        self.try_images(walk, &place, &onward, draws, found);
        let direction = onward.direction(draws.of_direction(walk.met));
        let cosine = direction.dot(place.normal);
        if cosine <= 0.0 {
            return false;
        }
        let density = onward.density(direction, cosine);
        walk.chance *= cosine_density(cosine) / density;
        walk.ray.direction = direction;
        walk.start = Start::Diffuse(Departure {
            place,
            is_first: matches!(walk.start, Start::Camera),
            direction,
            density,
        });
        walk.by = None;
        true
    }

    /// Light from a direction in which emitters are, and how much of it counts at `place`, the surface `number` of its path.
    fn look_for_light(
        &self,
        place: &Place,
        onward: &Onward,
        number: u32,
        draws: &mut Draws<'_>,
    ) -> Option<(Vector, Weight)> {
        let direction = self.lights.direction(place, number, draws)?;
        let cosine = direction.dot(place.normal);
        if cosine <= 0.0 {
            return None;
        }
        // Whichever surface it is: the weights are about directions, not about emitters.
        let surface = &self.surfaces[self.balls.nearest(&leaving(place, direction))?.0];
        // Light `L` has the weight `looked / (looked + own)` times `L` times what is reflected, the colour times `plain`, over the density `looked`.
        surface.emits.then(|| {
            let looked = self.lights.density(place, direction);
            let plain = cosine_density(cosine);
            let weight = Weight {
                here: plain / (looked + onward.density(direction, cosine)),
                looking: plain / (looked + plain),
                known: 1.0,
            };
            (surface.emission, weight)
        })
    }

    /// Paths to images of emitters in balls: many where their light is gathered, few elsewhere.
    fn try_images(
        &self,
        walk: &Walk,
        place: &Place,
        onward: &Onward,
        draws: &mut Draws<'_>,
        found: &mut Sample,
    ) {
        let is_first = matches!(walk.start, Start::Camera);
        // One number chooses one of those that are seldom tried, or none. Casts cut off.
        let chosen = (draws.uniform() / TRIED) as usize;
        for (number, image) in self.images.iter().enumerate() {
            let tries = tries(image, place, is_first);
            let count = if tries < 1.0 {
                u32::from(number == chosen)
            } else {
                tries as u32
            };
            if count == 0 {
                continue;
            }
            let Some(piece) = image.piece(place) else {
                continue;
            };
            for number in 0..count {
                let [share, around] = draws.point();
                let share = (f64::from(number) + share) / f64::from(count);
                let direction = piece.direction([share, around]);
                let cosine = direction.dot(place.normal);
                if cosine <= 0.0 {
                    continue;
                }
                let from = Departure {
                    place: *place,
                    is_first,
                    direction,
                    density: onward.density(direction, cosine),
                };
                let images = self.image_density(place, is_first, image.ball, direction);
                let weight = cosine_density(cosine) / (from.density + images);
                let mut way = *walk;
                way.ray = leaving(place, direction);
                way.start = Start::Image(from, image.ball, weight);
                way.by = None;
                self.follow(way, draws, found);
            }
        }
    }

    /// How often the images in this ball are tried, by solid angle.
    fn image_density(&self, place: &Place, is_first: bool, ball: usize, direction: Vector) -> f64 {
        let images = self.images.iter().filter(|image| image.ball == ball);
        let densities = images.filter_map(|image| {
            let piece = image.piece(place)?;
            Some(tries(image, place, is_first) * piece.density(direction))
        });
        densities.sum()
    }

    /// What light counts that a path meets. Directions from diffuse surfaces are chosen in two ways: for light that is met at once, the
    /// path's own and that of looking for it; for light by way of a ball, its own and those to the images in it.
    fn weight(&self, walk: &Walk) -> Weight {
        match (&walk.start, walk.by) {
            (Start::Camera | Start::Glimpse, _) => Weight::WHOLE,
            (Start::Diffuse(from), None) => {
                let (looked, plain) = self.met_at_once(from);
                Weight {
                    here: from.density / (from.density + looked),
                    looking: plain / (plain + looked),
                    known: 1.0,
                }
            }
            // The ball's own light is found in those two ways, and not in this one.
            (Start::Image(from, ..), None) => {
                let (looked, plain) = self.met_at_once(from);
                Weight {
                    here: 0.0,
                    looking: plain / (plain + looked),
                    known: 0.0,
                }
            }
            (Start::Diffuse(from), Some(ball)) => {
                let images = self.image_density(&from.place, from.is_first, ball, from.direction);
                Weight::path(from.density / (from.density + images))
            }
            (Start::Image(.., weight), Some(_)) => Weight::path(*weight),
        }
    }

    /// Densities of a direction from a diffuse surface: of looking for light there, and of a plain path.
    fn met_at_once(&self, from: &Departure) -> (f64, f64) {
        let looked = self.lights.density(&from.place, from.direction);
        (looked, cosine_density(from.direction.dot(from.place.normal)))
    }

    fn mirror(&self, walk: &mut Walk, hit: &Hit, draws: &mut Draws<'_>) -> bool {
        walk.by = walk.by.or(Some(hit.ball));
        walk.ray.direction = reflected(walk.ray.direction, hit.outward);
        self.survives(walk, hit.ball, draws)
    }

    fn glass(
        &self,
        walk: &mut Walk,
        hit: &Hit,
        index: f64,
        draws: &mut Draws<'_>,
        found: &mut Sample,
    ) -> bool {
        walk.by = walk.by.or(Some(hit.ball));
        if !self.survives(walk, hit.ball, draws) {
            return false;
        }
        let back = reflected(walk.ray.direction, hit.outward);
        let Some((through, reflectance)) = refracted(walk.ray.direction, hit.outward, index) else {
            walk.ray.direction = back;
            return true;
        };
        let from_camera = matches!(walk.start, Start::Camera | Start::Glimpse);
        if self.splits && from_camera && walk.met <= SPLIT {
            let mut other = *walk;
            other.ray = Ray {
                origin: hit.point,
                direction: back,
                departed: Some(hit.ball),
            };
            other.chance *= reflectance;
            self.follow(other, draws, found);
            walk.chance *= 1.0 - reflectance;
            walk.ray.direction = through;
        } else if draws.of_choice(walk.met) < reflectance {
            walk.ray.direction = back;
        } else {
            walk.ray.direction = through;
        }
        true
    }
}

/// How often an image is tried at a diffuse surface.
fn tries(image: &Image, place: &Place, is_first: bool) -> f64 {
    match &image.caustic {
        Some(caustic) if caustic.holds(place.point) => TRIED_IN_CAUSTICS[usize::from(!is_first)],
        _ => TRIED,
    }
}

fn leaving(place: &Place, direction: Vector) -> Ray {
    Ray {
        origin: place.point,
        direction,
        departed: Some(place.ball),
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

fn reflected(incoming: Vector, normal: Vector) -> Vector {
    incoming - normal * (2.0 * normal.dot(incoming))
}

/// The direction beyond a surface of glass, and how much is reflected; `None` if all is.
fn refracted(incoming: Vector, outward: Vector, index: f64) -> Option<(Vector, f64)> {
    let normal = facing(outward, incoming);
    let entering = outward.dot(incoming) < 0.0;
    let ratio = if entering { 1.0 / index } else { index };
    let cos_in = -incoming.dot(normal);
    let cos_out_squared = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in);
    if cos_out_squared < 0.0 {
        return None;
    }
    let cos_out = cos_out_squared.sqrt();
    // Schlick's approximation takes the angle on the thin side.
    let steep = 1.0 - if entering { cos_in } else { cos_out };
    let head_on = ((index - 1.0) / (index + 1.0)).powi(2);
    let reflectance = head_on + (1.0 - head_on) * steep.powi(5);
    let direction = (incoming * ratio + normal * (ratio * cos_in - cos_out)).normalised();
    Some((direction, reflectance))
}
