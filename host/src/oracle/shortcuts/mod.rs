//! The plain loop as an oracle: whatever a core leaves out, it must meet the surface that it would have met.
//!
//! Rays of real paths, and between them the hard ones: flat along their surface, along the axes, and from starts that are a
//! little beyond their surface. A ray's two surfaces are the same primitive's, at the same place and with the same normal but for
//! rounding; or those of two primitives that lie in one place.

mod scenes;

use std::fmt;

use fixedmath::{I2F30, I16F16};
use rayon::prelude::*;
use tracer::aggregate::Aggregate;
use tracer::arithmetic::vector::neg;
use tracer::arithmetic::{Directions, Mixed};
use tracer::camera::Camera;
use tracer::geometry::sphere::HollowSphere;
use tracer::geometry::{Interaction, PrimitiveId, Ray};
use tracer::material::{HemisphereSampling, Kind, RejectedDisc};
use tracer::profile::{Precise, Profile};
use tracer::random::{FullState, Random};
use tracer::scene::{All, Scene};

use crate::scene::CompiledScene;

pub use scenes::random_scenes;

/// Units of the last place of 16:16 between two points that are one: what rounding moves a hit along its ray, by either way.
const POINT: i32 = 4;
/// Units of 2^-30 between the components of two normals that are one: 5 for a flat wall's length, 4 for rounding.
const NORMAL: i32 = 9;
/// Rays of one path.
const BOUNCES: u32 = 12;
/// Rays that a thread follows at a time.
const SHARE: u64 = 1 << 16;

/// A ray that meets one surface by the short way, and another when all primitives are asked.
#[derive(Clone, Debug)]
pub struct Disagreement {
    ray: Ray<Mixed>,
    short: Option<Interaction<Mixed>>,
    plain: Option<Interaction<Mixed>>,
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the ray {:?} meets {:?} when all primitives are asked, and {:?} by the short way",
            self.ray, self.plain, self.short
        )
    }
}

impl std::error::Error for Disagreement {}

/// Compares at least so many rays of a scene, and says how many it were.
pub fn compare(scene: &CompiledScene, rays: u64, seed: u64) -> Result<u64, Box<Disagreement>> {
    let shares = rays.div_ceil(SHARE) as u32;
    let compared = (0..shares)
        .into_par_iter()
        .map(|share| follow(scene, rays.min(SHARE), &mut FullState::for_unit(seed, share)));
    compared.sum()
}

/// Follows paths until so many rays are compared.
fn follow(scene: &CompiledScene, rays: u64, random: &mut FullState) -> Result<u64, Box<Disagreement>> {
    let view = scene.view();
    let camera = Camera::<Mixed>::new(&scene.camera);
    let [columns, rows] = scene.camera.subpixels;
    let mut compared = 0;
    while compared < rays {
        let mut ray = camera.ray(below(random, columns), below(random, rows), random);
        for _ in 0..BOUNCES {
            // A ray too flat for the epsilon leaves the room through the wall it starts on: both ways are wrong then.
            if !starts_within(&view, &ray) {
                break;
            }
            compared += 1;
            let plain = view
                .aggregate
                .intersect_plainly::<Precise, All>(&ray, Precise::EPSILON);
            let short = view.aggregate.intersect::<Precise, All>(&ray, Precise::EPSILON);
            if !agree(plain.as_ref(), short.as_ref()) {
                return Err(Box::new(Disagreement { ray, short, plain }));
            }
            let Some(surface) = short else {
                break;
            };
            let Some(material) = view.materials.get(surface.material.index()) else {
                break;
            };
            let direction = match material.kind() {
                Some(Kind::Dielectric) => material.sample::<Precise, All>(ray.direction, &surface, random),
                _ => Some(hard_direction(surface.facing(), random)),
            };
            let Some(direction) = direction else {
                break;
            };
            ray = Ray {
                origin: surface.point,
                direction,
                departed: surface.primitive,
                normal: surface.normal,
            };
            if below(random, 8) == 0 {
                ray = beside_its_surface(&ray, random);
            }
        }
    }
    Ok(compared)
}

/// Whether a ray starts within all hollow spheres, but for rounding.
fn starts_within(scene: &Scene<'_>, ray: &Ray<Mixed>) -> bool {
    scene
        .aggregate
        .primitives
        .hollow_spheres
        .iter()
        .all(|HollowSphere(sphere)| {
            let from_centre = [0, 1, 2].map(|i| i64::from((ray.origin[i] - sphere.centre[i]).to_bits()));
            let farthest = i64::from(sphere.radius.to_bits() + POINT);
            from_centre.iter().map(|c| c * c).sum::<i64>() <= farthest * farthest
        })
}

/// A ray that starts up to 3 ulp away along each axis, which is further than rounding puts it, does not know its surface, and may
/// go right into it: as one that starts where two surfaces touch.
fn beside_its_surface(ray: &Ray<Mixed>, random: &mut FullState) -> Ray<Mixed> {
    let aside = |random: &mut FullState| I16F16::from_bits(below(random, 7) as i32 - 3);
    Ray {
        origin: ray.origin.map(|coordinate| coordinate + aside(random)),
        direction: if below(random, 2) == 0 {
            neg(ray.direction)
        } else {
            ray.direction
        },
        departed: PrimitiveId::NONE,
        ..*ray
    }
}

/// A whole number below `end`.
fn below(random: &mut FullState, end: u32) -> u32 {
    ((u64::from(random.fraction().to_bits()) * u64::from(end)) >> 32) as u32
}

/// A direction on the side of a normal: by its cosine; down to 2^-24 flat; along one axis or across one.
fn hard_direction(normal: [I2F30; 3], random: &mut FullState) -> [I2F30; 3] {
    let aside = RejectedDisc::direction::<Mixed, _>(normal, random);
    let axis = below(random, 3) as usize;
    let direction = match below(random, 8) {
        0 => {
            // Most of what rises from the surface taken away.
            let rise = Mixed::cosine(aside, normal);
            let left = I2F30::from_bits(rise.to_bits() >> below(random, 24));
            [0, 1, 2].map(|i| aside[i] - Mixed::times(normal[i], rise - left))
        }
        1 => {
            let mut along = [I2F30::ZERO; 3];
            along[axis] = if normal[axis] < I2F30::ZERO {
                I2F30::NEG_ONE
            } else {
                I2F30::ONE
            };
            along
        }
        2 => {
            let mut across = aside;
            across[axis] = I2F30::ZERO;
            across
        }
        _ => return aside,
    };
    let direction = Mixed::normalised(direction, aside);
    if Mixed::cosine(direction, normal) > I2F30::ZERO {
        direction
    } else {
        aside
    }
}

fn agree(plain: Option<&Interaction<Mixed>>, short: Option<&Interaction<Mixed>>) -> bool {
    let (Some(plain), Some(short)) = (plain, short) else {
        return plain.is_none() && short.is_none();
    };
    let apart = |a: I16F16, b: I16F16| (a.to_bits() - b.to_bits()).abs();
    let in_one_place = (0..3).all(|i| apart(plain.point[i], short.point[i]) <= POINT);
    let turned = |a: I2F30, b: I2F30| (a.to_bits() - b.to_bits()).abs();
    let is_same = plain.primitive == short.primitive
        && plain.material == short.material
        && plain.from_inside == short.from_inside
        && (0..3).all(|i| turned(plain.normal[i], short.normal[i]) <= NORMAL);
    in_one_place && (is_same || plain.primitive != short.primitive)
}

#[cfg(test)]
mod tests;
