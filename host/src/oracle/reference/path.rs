//! One path through a scene in plain double precision, as a textbook has it.
//!
//! Nothing here is shared with the tracer that runs on the cores, nor clever: discriminants from centre and radius, an
//! epsilon against hitting the surface one leaves, one random choice per decision. It is the second opinion.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use super::Termination;
use crate::scene::{Camera, Material, Scene};

/// Hits nearer than this belong to the surface that the ray leaves.
const EPSILON: f64 = 1e-4;

/// Surfaces that a path meets before roulette begins.
const SURE_SURFACES: u32 = 5;

#[derive(Clone, Copy)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

impl Vector {
    const fn of([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }

    fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    fn normalised(self) -> Self {
        self * (1.0 / self.dot(self).sqrt())
    }
}

impl std::ops::Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl std::ops::Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

impl std::ops::Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

struct Ray {
    origin: Vector,
    direction: Vector,
}

/// A uniform number in [0, 1).
fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// The camera for one picture size.
pub(super) struct View {
    position: Vector,
    direction: Vector,
    /// Across the image plane, left to right and bottom to top.
    across: Vector,
    upwards: Vector,
    near: f64,
    width: f64,
    height: f64,
}

impl View {
    pub(super) fn new(camera: &Camera, width: u16, height: u16) -> Self {
        let plane_height = camera.height_for(width, height);
        let (width, height) = (f64::from(width), f64::from(height));
        let direction = Vector::of(camera.direction);
        let across = direction.cross(Vector::of(camera.up)).normalised() * (plane_height * width / height);
        let upwards = across.cross(direction).normalised() * plane_height;
        Self {
            position: Vector::of(camera.position),
            direction,
            across,
            upwards,
            near: camera.near,
            width,
            height,
        }
    }

    /// A ray through one of the 2x2 sub-pixels of the pixel at `column` and `row`, row 0 at the top.
    fn ray(&self, column: u16, row: u16, sub_pixel: [u8; 2], random: &mut Xoshiro256PlusPlus) -> Ray {
        let [sub_x, sub_y] = sub_pixel.map(f64::from);
        let x = (f64::from(column) + (sub_x + 0.5 + tent(random)) / 2.0) / self.width - 0.5;
        let y = 0.5 - (f64::from(row) + (sub_y + 0.5 + tent(random)) / 2.0) / self.height;
        let direction = (self.direction + self.across * x + self.upwards * y).normalised();
        Ray {
            origin: self.position + direction * self.near,
            direction,
        }
    }
}

/// A sample of the tent filter over (-1, 1).
fn tent(random: &mut Xoshiro256PlusPlus) -> f64 {
    let r = 2.0 * uniform(random);
    if r < 1.0 {
        r.sqrt() - 1.0
    } else {
        1.0 - (2.0 - r).sqrt()
    }
}

/// The scene as the inner loop wants it: what every ray reads side by side, the rest apart.
pub(super) struct World {
    balls: Vec<Ball>,
    surfaces: Vec<Surface>,
}

struct Ball {
    centre: Vector,
    radius_squared: f64,
}

struct Surface {
    emission: Vector,
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
        let balls = scene.spheres.iter().map(|sphere| Ball {
            centre: Vector::of(sphere.centre),
            radius_squared: sphere.radius * sphere.radius,
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
                colour: Vector::of(colour),
                strongest,
                kind,
            }
        });
        Self {
            balls: balls.collect(),
            surfaces: surfaces.collect(),
        }
    }

    /// The nearest hit: distance and sphere.
    fn hit(&self, ray: &Ray) -> Option<(f64, usize)> {
        let mut nearest = f64::INFINITY;
        let mut which = None;
        for (index, ball) in self.balls.iter().enumerate() {
            let to_centre = ball.centre - ray.origin;
            let along = to_centre.dot(ray.direction);
            let discriminant = along * along - to_centre.dot(to_centre) + ball.radius_squared;
            if discriminant < 0.0 {
                continue;
            }
            let half_chord = discriminant.sqrt();
            let (entry, exit) = (along - half_chord, along + half_chord);
            let distance = if entry > EPSILON { entry } else { exit };
            if distance > EPSILON && distance < nearest {
                nearest = distance;
                which = Some(index);
            }
        }
        which.map(|index| (nearest, index))
    }

    /// Radiance of one sample of a pixel.
    pub(super) fn sample(
        &self,
        view: &View,
        pixel: [u16; 2],
        sub_pixel: [u8; 2],
        termination: Termination,
        random: &mut Xoshiro256PlusPlus,
    ) -> [f64; 3] {
        let mut ray = view.ray(pixel[0], pixel[1], sub_pixel, random);
        let mut radiance = [0.0; 3];
        let mut throughput = Vector::of([1.0; 3]);
        let mut surfaces_met = 0u32;
        while let Some((distance, index)) = self.hit(&ray) {
            let surface = &self.surfaces[index];
            surfaces_met += 1;
            radiance[0] += throughput.x * surface.emission.x;
            radiance[1] += throughput.y * surface.emission.y;
            radiance[2] += throughput.z * surface.emission.z;
            let mut survival = 1.0;
            match termination {
                Termination::Depth(limit) if surfaces_met >= u32::from(limit) => break,
                Termination::Roulette if surfaces_met > SURE_SURFACES => survival = surface.strongest,
                _ => {}
            }
            if surface.strongest == 0.0 || (survival < 1.0 && uniform(random) >= survival) {
                break;
            }
            throughput.x *= surface.colour.x / survival;
            throughput.y *= surface.colour.y / survival;
            throughput.z *= surface.colour.z / survival;
            let point = ray.origin + ray.direction * distance;
            let outward = (point - self.balls[index].centre).normalised();
            let direction = scatter(&surface.kind, ray.direction, outward, random);
            ray = Ray {
                origin: point,
                direction,
            };
        }
        radiance
    }
}

/// The direction in which light that arrives along `incoming` goes on (or came from: paths run backwards).
fn scatter(kind: &Kind, incoming: Vector, outward: Vector, random: &mut Xoshiro256PlusPlus) -> Vector {
    let entering = outward.dot(incoming) < 0.0;
    let normal = if entering { outward } else { outward * -1.0 };
    match *kind {
        Kind::Diffuse => cosine_weighted(normal, random),
        Kind::Mirror => reflected(incoming, normal),
        Kind::Glass { index } => {
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
            if uniform(random) < reflectance {
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

fn cosine_weighted(normal: Vector, random: &mut Xoshiro256PlusPlus) -> Vector {
    let around = std::f64::consts::TAU * uniform(random);
    let radius_squared = uniform(random);
    let radius = radius_squared.sqrt();
    let helper = if normal.x.abs() > 0.1 {
        [0.0, 1.0, 0.0]
    } else {
        [1.0, 0.0, 0.0]
    };
    let tangent = Vector::of(helper).cross(normal).normalised();
    let bitangent = normal.cross(tangent);
    let (sin, cos) = around.sin_cos();
    let disc = tangent * (cos * radius) + bitangent * (sin * radius);
    (disc + normal * (1.0 - radius_squared).sqrt()).normalised()
}
