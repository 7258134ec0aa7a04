//! The specular balls that diffuse surfaces guide a part of their paths to, and how many of them.
//!
//! How often and how wide only the noise depends on, never the mean: [`tracer::light::Guide`] says why. The shares and angles here are
//! those by which the Cornell box is least noisy for its cycles; others differ little.

use std::f64::consts::PI;

use fixedmath::I16F16;
use tracer::geometry::PrimitiveId;
use tracer::geometry::sphere::SphereRecord;
use tracer::light::{Guide, MAX_GUIDES};
use tracer::material::{Kind, MaterialRecord};
use tracer::scene::{Capabilities, Capability};

use super::emitters::{Emitters, magnitude};
use super::fixed::{q0_32, q16, q30};
use super::reach::Extent;
use super::scale::LONGEST;
use super::vector::{length, sub};
use super::{Material, Sphere};

/// The share of paths that a ball of either kind is given.
const SHARE_OF_MIRROR: f64 = 0.025;
const SHARE_OF_GLASS: f64 = 0.03;
/// Of what diffuse surfaces absorb, no more than this is taken back to make up for guided paths: all paths still end.
pub(super) const MOST_OF_LOSS: f64 = 0.25;
/// Fewer paths are not worth the code.
const LEAST_SHARE: f64 = 0.002;

/// Half angle of the cap of a ball of glass: most of what can be seen of it.
const GLASS_ANGLE: f64 = 1.2;
/// The least and the most of a mirror's: it is half of what the emitter fills, seen from its surface.
const MIRROR_ANGLES: [f64; 2] = [0.03, 0.6];
/// Steps by which a mirror's point is found.
const STEPS: u16 = 2;

/// The guides of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Guides {
    pub(super) records: Vec<Guide>,
    /// The share of paths that are guided.
    share: f64,
}

/// A ball that may be worth it.
struct Candidate<'r> {
    index: usize,
    record: &'r SphereRecord,
    share: f64,
    angle: f64,
    steps: u16,
    emitter: [I16F16; 3],
    /// Of the light of its emitter, what it meets.
    weight: f64,
}

/// The middle of an emitter's part that can be seen, how far it reaches from there, and its brightness times area.
type Bright = ([f64; 3], f64, f64);

impl Guides {
    /// Those among `spheres`, in a core's unit, of which the first have these records: all that are not vast.
    pub(super) fn of(
        spheres: &[&Sphere],
        known: &[SphereRecord],
        emitters: &Emitters,
        extent: &Extent<'_>,
    ) -> Self {
        let bright = bright(spheres, emitters);
        let candidates = spheres.iter().zip(known).enumerate();
        let mut found: Vec<Candidate<'_>> = candidates
            .filter(|(_, (sphere, _))| extent.farthest_start(sphere.centre) + 1.5 * sphere.radius < LONGEST)
            .filter_map(|(index, (sphere, record))| Candidate::of(index, sphere, record, &bright))
            .collect();
        found.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        found.truncate(MAX_GUIDES);
        let wanted: f64 = found.iter().map(|candidate| candidate.share).sum();
        let share = wanted.min(MOST_OF_LOSS * (1.0 - albedo(spheres)));
        if share < LEAST_SHARE {
            return Self::default();
        }
        let mut sum = 0.0;
        let records = found.iter().map(|candidate| {
            let own = candidate.share * share / wanted;
            sum += own;
            candidate.record(own, sum, share)
        });
        Self {
            records: records.collect(),
            share,
        }
    }

    pub(super) fn needs(&self) -> Capabilities {
        Capabilities::NONE.with_if(!self.records.is_empty(), Capability::Guides)
    }

    /// Has diffuse surfaces and emitters make up for the paths that are guided.
    pub(super) fn compensate(&self, materials: &mut [MaterialRecord], emitters: &mut Emitters) {
        if self.records.is_empty() {
            return;
        }
        let left = 1.0 - self.share;
        let diffuse = materials
            .iter_mut()
            .filter(|material| material.bsdf == Kind::Diffuse as u8);
        for material in diffuse {
            let raised = |value: f64| value / left;
            material.continuation = q30(raised(material.continuation.to_num()));
            material.reflectance = material.reflectance.map(|c| q0_32(raised(c.to_num())));
        }
        let caps = emitters.caps.iter_mut().map(|cap| &mut cap.reach);
        let balls = emitters.balls.iter_mut().map(|ball| &mut ball.reach);
        for reach in caps.chain(balls) {
            *reach = reach.times(magnitude(left));
        }
    }
}

/// The largest share of light that a diffuse surface reflects.
fn albedo(spheres: &[&Sphere]) -> f64 {
    let colours = spheres.iter().filter_map(|sphere| match sphere.material {
        Material::Diffuse(colour) => Some(colour),
        Material::Mirror(_) | Material::Glass { .. } => None,
    });
    colours.flatten().fold(0.0, f64::max)
}

fn bright(spheres: &[&Sphere], emitters: &Emitters) -> Vec<Bright> {
    let lengths = |v: [I16F16; 3]| v.map(|c| c.to_num::<f64>());
    let brightness = |index: usize| spheres[index].emission.iter().sum::<f64>();
    let caps = emitters.caps.iter().map(|cap| {
        let reach = length(lengths(cap.across[0]));
        let power = brightness(cap.emitter.primitive.index()) * PI * reach * reach;
        (lengths(cap.pole), reach, power)
    });
    let balls = emitters.balls.iter().map(|ball| {
        let radius = ball.radius.to_num::<f64>();
        let power = brightness(ball.emitter.primitive.index()) * PI * radius * radius;
        (lengths(ball.centre), radius, power)
    });
    caps.chain(balls).collect()
}

impl<'r> Candidate<'r> {
    fn of(index: usize, sphere: &Sphere, record: &'r SphereRecord, bright: &[Bright]) -> Option<Self> {
        if sphere.hollow {
            return None;
        }
        let is_glass = match sphere.material {
            Material::Diffuse(_) => return None,
            Material::Mirror(_) => false,
            Material::Glass { .. } => true,
        };
        let met = |&(middle, _, power): &Bright| {
            power * (sphere.radius / length(sub(middle, sphere.centre))).powi(2)
        };
        let brightest = bright.iter().max_by(|a, b| met(a).total_cmp(&met(b)))?;
        let &(middle, size, _) = brightest;
        let distance = length(sub(middle, sphere.centre)) - sphere.radius;
        // What it does with light from within, or from its own surface, no cap is told of.
        if distance <= 0.0 {
            return None;
        }
        let [least, most] = MIRROR_ANGLES;
        Some(Self {
            index,
            record,
            share: if is_glass { SHARE_OF_GLASS } else { SHARE_OF_MIRROR },
            angle: if is_glass {
                GLASS_ANGLE
            } else {
                (size / distance / 2.0).clamp(least, most)
            },
            steps: if is_glass { 0 } else { STEPS },
            emitter: middle.map(q16),
            weight: met(brightest),
        })
    }

    /// Its record with this share of all paths, the sum of those up to it, and of all.
    fn record(&self, own: f64, sum: f64, all: f64) -> Guide {
        let height = 1.0 - self.angle.cos();
        let radius = self.record.radius.to_num::<f64>();
        Guide {
            centre: self.record.centre,
            radius: self.record.radius,
            emitter: self.emitter,
            spread: q30((2.0 * height).sqrt()),
            edge: q30(1.0 - height),
            threshold: q0_32(sum),
            reach: magnitude(2.0 * radius * height * (1.0 - all) / own),
            primitive: PrimitiveId::new(self.index),
            steps: self.steps,
            reserved: 0,
        }
    }
}
