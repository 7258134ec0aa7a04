//! The emitters that diffuse surfaces look for, and what of each can be seen.
//!
//! Every other sphere leaves a part of an emitter's surface to be seen: a hollow one what is within it, an opaque solid one what is
//! outside. In unit vectors `n` from the emitter's centre, that is a half-space `n . axis >= cosine`. What all of them leave has its
//! corners where two of their rims cross, and the cap that is looked for is one around it.
//!
//! Some emitters are left to paths: those of which nothing can be seen, those that are behind glass from everywhere, those that are all
//! around, which any direction finds, and vast ones, whose surface a core does not know by a centre and a radius.

use std::f64::consts::PI;

use fixedmath::U0F32;
use tracer::geometry::PrimitiveId;
use tracer::geometry::sphere::SphereRecord;
use tracer::light::{BallLight, CapLight, Emitter, Magnitude};
use tracer::scene::{Capabilities, Capability};

use super::fixed::{q0_32, q16};
use super::reach::Extent;
use super::scale::LONGEST;
use super::vector::{cross, dot, length, scaled, sub};
use super::{Material, Sphere};

/// The emitters of a scene that are looked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Emitters {
    pub(super) caps: Vec<CapLight>,
    pub(super) balls: Vec<BallLight>,
}

/// One that can be seen.
struct Found<'r> {
    index: usize,
    record: &'r SphereRecord,
    radius: f64,
    is_hollow: bool,
    seen: Seen,
    /// What it may give.
    weight: f64,
}

impl Emitters {
    /// Those among `spheres`, in a core's unit, of which the first have these records: all that are not vast. Their records take no more
    /// than `room` bytes: of more emitters the weakest are left to paths. So are all balls, unless they are `with_balls`.
    pub(super) fn of(
        spheres: &[&Sphere],
        known: &[SphereRecord],
        extent: &Extent<'_>,
        room: usize,
        with_balls: bool,
    ) -> Self {
        if !spheres.iter().any(|sphere| is_looking(sphere)) {
            return Self::default();
        }
        let found = spheres
            .iter()
            .zip(known)
            .enumerate()
            .filter_map(|(index, (sphere, record))| {
                let brightness: f64 = sphere.emission.iter().sum();
                let fits = extent.farthest_start(sphere.centre) + 1.5 * sphere.radius < LONGEST;
                if brightness == 0.0 || !fits || is_in_glass(sphere, spheres) {
                    return None;
                }
                let seen = Seen::of(index, spheres)?;
                (seen.cap.is_some() || with_balls).then(|| Found {
                    index,
                    record,
                    radius: sphere.radius,
                    is_hollow: sphere.hollow,
                    weight: brightness * seen.most_at_once(sphere.radius),
                    seen,
                })
            });
        let mut found = strongest(found.collect(), room);
        // Caps first, and each kind in the order of primitives.
        found.sort_by_key(|found| (found.seen.cap.is_none(), found.index));
        let mut emitters = Self::default();
        for (found, chance) in found.iter().zip(chances(&found)) {
            match found.seen.cap {
                Some(cap) => emitters.caps.extend(found.cap(cap, &chance)),
                None => emitters.balls.extend(found.ball(&chance)),
            }
        }
        emitters
    }

    /// How many of each kind there are.
    pub(super) fn counts(&self) -> [u16; 2] {
        [self.caps.len(), self.balls.len()].map(|count| count as u16)
    }

    fn are_clipped(&self) -> bool {
        let caps = self.caps.iter().map(|cap| &cap.emitter);
        let balls = self.balls.iter().map(|ball| &ball.emitter);
        caps.chain(balls).any(Emitter::is_clipped)
    }

    /// What an image must be capable of to look for them.
    pub(super) fn needs(&self) -> Capabilities {
        let count = self.caps.len() + self.balls.len();
        Capabilities::NONE
            .with_if(count > 0, Capability::Lights)
            .with_if(count > 1, Capability::ManyLights)
            .with_if(!self.balls.is_empty(), Capability::BallLights)
            .with_if(self.are_clipped(), Capability::ClippedLights)
    }
}

/// Whether it looks for light.
fn is_looking(sphere: &Sphere) -> bool {
    matches!(sphere.material, Material::Diffuse(colour) if colour.iter().any(|&c| c > 0.0))
}

/// The strongest of them that there is room for.
fn strongest(mut found: Vec<Found<'_>>, room: usize) -> Vec<Found<'_>> {
    found.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let mut taken = 0;
    let fits = found.iter().take_while(|found| {
        taken += if found.seen.cap.is_some() {
            size_of::<CapLight>()
        } else {
            size_of::<BallLight>()
        };
        taken <= room
    });
    let count = fits.count();
    found.truncate(count);
    found
}

/// How likely an emitter is to be chosen.
struct Chance {
    /// So many of 2^32 fractions choose it.
    fractions: u64,
    /// The last of them.
    threshold: U0F32,
}

/// The chances of these, in proportion to what they may give; one that is next to nothing beside the others has none.
fn chances(found: &[Found<'_>]) -> Vec<Chance> {
    let total: f64 = found.iter().map(|found| found.weight).sum();
    let mut sum = 0.0;
    let mut ends: Vec<u64> = found
        .iter()
        .map(|found| {
            sum += found.weight;
            (sum / total * 2f64.powi(32)).round() as u64
        })
        .collect();
    if let Some(last) = ends.last_mut() {
        *last = 1 << 32;
    }
    let starts = std::iter::once(0).chain(ends.iter().copied());
    ends.iter()
        .zip(starts)
        .map(|(&end, start)| Chance {
            fractions: end - start,
            threshold: U0F32::from_bits(end.saturating_sub(1) as u32),
        })
        .collect()
}

impl Chance {
    /// None for an emitter that is never chosen.
    fn probability(&self) -> Option<f64> {
        (self.fractions > 0).then(|| self.fractions as f64 / 2f64.powi(32))
    }
}

impl Found<'_> {
    fn emitter(&self, chance: &Chance) -> Emitter {
        let flag = |is_set: bool, flag: u16| if is_set { flag } else { 0 };
        Emitter {
            threshold: chance.threshold,
            primitive: PrimitiveId::new(self.index),
            material: self.record.material,
            flags: flag(self.is_hollow, Emitter::HOLLOW) | flag(self.seen.is_clipped, Emitter::CLIPPED),
        }
    }

    fn cap(&self, cap: Cap, chance: &Chance) -> Option<CapLight> {
        let radius = self.radius;
        let centre = self.record.centre.map(|c| c.to_num::<f64>());
        let pole = [0, 1, 2].map(|i| centre[i] + radius * cap.axis[i]);
        let reach = radius * (2.0 * cap.height).sqrt();
        let sideways = any_across(cap.axis);
        let across = [sideways, cross(cap.axis, sideways)].map(|v| v.map(|c| q16(c * reach)));
        // A cap of a few ulp is another one for a core, and that one's area is what counts.
        let [one, other] = across.map(|v| v.map(|c| c.to_num::<f64>()));
        let area = length(cross(one, other));
        if area == 0.0 {
            return None;
        }
        Some(CapLight {
            centre: self.record.centre,
            pole: pole.map(q16),
            across,
            down: cap.axis.map(|c| q16(c * radius * cap.height)),
            height: q0_32(cap.height),
            reach: magnitude(area / radius / chance.probability()?),
            emitter: self.emitter(chance),
            reserved: 0,
        })
    }

    fn ball(&self, chance: &Chance) -> Option<BallLight> {
        Some(BallLight {
            centre: self.record.centre,
            radius: self.record.radius,
            reach: magnitude(2.0 / chance.probability()?),
            emitter: self.emitter(chance),
            reserved: 0,
        })
    }
}

/// A number above 0.
pub(super) fn magnitude(value: f64) -> Magnitude {
    let exponent = value.log2().floor() as i32 - 52;
    Magnitude::new((value * 2f64.powi(-exponent)).round() as u64, exponent)
}

/// Whether a ball of glass is all around it: then no connection from outside of that leads there.
fn is_in_glass(sphere: &Sphere, spheres: &[&Sphere]) -> bool {
    spheres.iter().any(|other| {
        matches!(other.material, Material::Glass { .. })
            && !std::ptr::eq(*other, sphere)
            && length(sub(other.centre, sphere.centre)) + sphere.radius <= other.radius
    })
}

/// A cap of the unit sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cap {
    /// To its middle.
    axis: [f64; 3],
    /// One minus the cosine of its half angle.
    height: f64,
}

/// What of an emitter can be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    /// None for a whole ball.
    cap: Option<Cap>,
    /// Hollow spheres hide more than the cap says.
    is_clipped: bool,
}

/// What another sphere leaves to be seen: `n . axis >= cosine`.
#[derive(Clone, Copy, Debug)]
struct HalfSpace {
    axis: [f64; 3],
    /// One minus the cosine.
    height: f64,
    /// By a hollow sphere.
    is_hollow: bool,
    /// It is known well enough to rely on.
    is_sharp: bool,
}

/// From this radius on, in a core's unit, double precision does not tell sharply where a sphere cuts another one.
const BLUNT: f64 = 67_108_864.0;
/// A cap that is less high has no area for a core.
const LEAST_HEIGHT: f64 = 1e-14;
/// Of cosines and unit vectors.
const ROUNDING: f64 = 1e-12;

impl Seen {
    /// None where nothing can be seen, or where a hollow emitter is all around.
    fn of(index: usize, spheres: &[&Sphere]) -> Option<Self> {
        let emitter = spheres[index];
        let mut cuts = Vec::new();
        for (other, sphere) in spheres.iter().enumerate() {
            if other != index && !matches!(sphere.material, Material::Glass { .. }) {
                cuts.extend(HalfSpace::left_by(sphere, emitter)?);
            }
        }
        let is_clipped = |cap: Option<Cap>| {
            let hides = |cut: &HalfSpace| cut.is_hollow && !cap.is_some_and(|cap| cut.holds_cap(cap));
            cuts.iter().any(hides)
        };
        let cap = match cap_around(&cuts)? {
            Some(cap) if cap.height < LEAST_HEIGHT => return None,
            // Of more than half of a ball its whole cone is looked for, from wherever it is seen.
            Some(cap) if cap.height <= 1.0 => Some(cap),
            _ if emitter.hollow => return None,
            _ => None,
        };
        Some(Self {
            cap,
            is_clipped: is_clipped(cap),
        })
    }

    /// The area of what can be seen of it at once, at most.
    fn most_at_once(&self, radius: f64) -> f64 {
        let height = self.cap.map_or(1.0, |cap| cap.height);
        PI * radius * radius * height * (2.0 - height)
    }
}

impl HalfSpace {
    /// What `other` leaves of `emitter`: none where that is all, and `None` where it is nothing.
    #[expect(clippy::option_option, reason = "all, nothing, and a part")]
    fn left_by(other: &Sphere, emitter: &Sphere) -> Option<Option<Self>> {
        let between = sub(other.centre, emitter.centre);
        let distance = length(between);
        let (ours, theirs) = (emitter.radius, other.radius);
        if distance == 0.0 {
            return if other.hollow == (ours < theirs) {
                Some(None)
            } else {
                None
            };
        }
        // The surfaces meet in a circle around the line of centres. By the law of cosines, one minus the cosine of its angle at this
        // centre is (R^2 - (d - r)^2) / 2 r d on the other centre's side.
        let less = distance - ours;
        let towards = (theirs - less) * (theirs + less) / (2.0 * ours * distance);
        let left = if other.hollow { towards } else { 2.0 - towards };
        if left <= 0.0 {
            return None;
        }
        let sign = if other.hollow { 1.0 } else { -1.0 };
        Some((left < 2.0).then(|| Self {
            axis: scaled(between, sign / distance),
            height: left,
            is_hollow: other.hollow,
            is_sharp: theirs < BLUNT,
        }))
    }

    fn cosine(&self) -> f64 {
        1.0 - self.height
    }

    fn holds(&self, n: [f64; 3]) -> bool {
        dot(self.axis, n) >= self.cosine() - ROUNDING
    }

    /// Whether all of a cap is in it.
    fn holds_cap(&self, cap: Cap) -> bool {
        let angle = |height: f64| 2.0 * (height / 2.0).clamp(0.0, 1.0).sqrt().asin();
        let between = length(cross(self.axis, cap.axis)).atan2(dot(self.axis, cap.axis));
        self.is_sharp && between + angle(cap.height) <= angle(self.height) * (1.0 + 1e-9)
    }

    /// The point of its rim that is farthest from `axis`.
    fn farthest_of_rim(&self, axis: [f64; 3]) -> [f64; 3] {
        let aside = sub(axis, scaled(self.axis, dot(axis, self.axis)));
        // Of next to nothing, the direction is rounding; and then all of the rim is as far.
        let aside = match length(aside) {
            ..1e-7 => any_across(self.axis),
            long => scaled(aside, 1.0 / long),
        };
        let sine = (self.height * (2.0 - self.height)).sqrt();
        sub(scaled(self.axis, self.cosine()), scaled(aside, sine))
    }

    /// Where two rims cross.
    fn crossings(&self, other: &Self) -> Option<[[f64; 3]; 2]> {
        let common = dot(self.axis, other.axis);
        let across = cross(self.axis, other.axis);
        let sine_squared = dot(across, across);
        if sine_squared < ROUNDING {
            return None;
        }
        let (ours, theirs) = (self.cosine(), other.cosine());
        let first = (ours - theirs * common) / sine_squared;
        let second = (theirs - ours * common) / sine_squared;
        let middle = [0, 1, 2].map(|i| first * self.axis[i] + second * other.axis[i]);
        let left = 1.0 - dot(middle, middle);
        (left >= 0.0).then(|| {
            let offset = scaled(across, (left / sine_squared).sqrt());
            [sub(middle, offset), sub(middle, scaled(offset, -1.0))]
        })
    }
}

/// A cap around what all half-spaces have in common of the unit sphere. None for the whole sphere; `None` where they have nothing in common.
#[expect(clippy::option_option, reason = "all, nothing, and a part")]
fn cap_around(cuts: &[HalfSpace]) -> Option<Option<Cap>> {
    if cuts.is_empty() {
        return Some(None);
    }
    let is_seen = |n: &[f64; 3]| cuts.iter().all(|cut| cut.holds(*n));
    let pairs = cuts
        .iter()
        .enumerate()
        .flat_map(|(place, cut)| cuts[..place].iter().filter_map(|other| cut.crossings(other)));
    let corners: Vec<[f64; 3]> = pairs.flatten().filter(is_seen).collect();
    // Of a rim that no other crosses, either all is seen or nothing.
    let rims = cuts.iter().map(|cut| cut.farthest_of_rim(any_across(cut.axis)));
    let rims: Vec<usize> = (0..cuts.len())
        .zip(rims)
        .filter(|(_, n)| is_seen(n))
        .map(|(place, _)| place)
        .collect();
    let middle = if corners.is_empty() {
        let &rim = rims.first()?;
        cuts[rim].axis
    } else {
        corners
            .iter()
            .fold([0.0; 3], |sum, corner| [0, 1, 2].map(|i| sum[i] + corner[i]))
    };
    let long = length(middle);
    if long < 1e-6 {
        return Some(None);
    }
    let axis = scaled(middle, 1.0 / long);
    if is_seen(&scaled(axis, -1.0)) {
        return Some(None);
    }
    let ends = cuts.iter().map(|cut| cut.farthest_of_rim(axis)).filter(is_seen);
    let height = corners.iter().copied().chain(ends).map(|n| {
        // From the chord: exact where the cap is next to nothing.
        let chord = sub(n, axis);
        dot(chord, chord) / 2.0
    });
    Some(Some(Cap {
        axis,
        height: height.fold(0.0, f64::max),
    }))
}

/// A unit vector across another one.
fn any_across(axis: [f64; 3]) -> [f64; 3] {
    let other = if axis[0].abs() < 0.5 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let across = cross(axis, other);
    scaled(across, 1.0 / length(across))
}
