//! Rays that leave a surface: whether they meet it again where it is not, and what stands next to it.
//!
//! Every ray is made as the tracer makes it: one that meets a shape, the interaction there, and the direction that a material samples.
//! What it should meet is decided from that very ray: exactly of spheres, in double precision of vast ones.

mod body;
mod classes;
mod neighbours;
mod tables;
mod tally;

use fixedmath::I16F16;
use rayon::prelude::*;
use tracer::arithmetic::{Directions, Formats};
use tracer::geometry::{PrimitiveId, Ray};
use tracer::material::{Kind, MaterialRecord};
use tracer::profile::{Paper, Precise, Profile};
use tracer::random::Random;
use tracer::scene::All;

pub(super) use self::body::{Body, Told, line_of};
use self::body::{Start, sphere};
use self::classes::{CLASSES, Class};
pub(super) use self::classes::{DIFFUSE, Drawn, vast_ball, vast_wall};
use self::neighbours::{KINDS, Place, neighbour};
use self::tables::{faults, neighbours_passed, self_hits};
use self::tally::{SelfHits, Tally, bin};
use super::draw::Draw;
use super::exact::Line;
use super::intersection::ray_of;
use super::{Effort, Error, Findings, Part};
use crate::scene::material_record;

/// The part.
pub(super) const PART: Part = Part {
    name: "reintersection",
    about: "whether rays meet the surface they leave, and what stands next to it",
    measure,
};

/// Rays of each class.
const RAYS: u64 = 10_000_000;
/// Rays that a thread draws at a time.
const SHARE: u64 = 1 << 14;
/// What a hit may be off, in ulp, before it is another one: both the start and the hit are points of 16:16.
const ROUNDING: f64 = 4.0;

/// The epsilons of a profile that are compared, its own first.
trait Compared: Profile<Numbers: Told> {
    const EPSILONS: &'static [(&'static str, I16F16)];
}

impl Compared for Precise {
    const EPSILONS: &'static [(&'static str, I16F16)] =
        &[("0", Self::EPSILON), ("16 ulp", I16F16::from_bits(16))];
}

impl Compared for Paper {
    const EPSILONS: &'static [(&'static str, I16F16)] = &[
        ("0.1", Self::EPSILON),
        ("0.001", I16F16::from_bits(66)),
        ("0", I16F16::ZERO),
    ];
}

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let rays = effort.of(RAYS);
    effort.expect(2 * rays.div_ceil(SHARE) * CLASSES.len() as u64);
    let columns = [columns::<Precise>(effort, rays), columns::<Paper>(effort, rays)].concat();
    Ok(Findings {
        tables: vec![self_hits(&columns), neighbours_passed(&columns)],
        faults: faults(&columns[0]),
        ..Findings::default()
    })
}

/// What a profile does by one epsilon.
#[derive(Clone, Debug)]
struct Column {
    name: String,
    /// By class.
    tallies: Vec<Tally>,
}

fn columns<P: Compared>(effort: &Effort, rays: u64) -> Vec<Column> {
    let mut columns: Vec<Column> = P::EPSILONS
        .iter()
        .map(|(epsilon, _)| Column {
            name: format!("`{}`, {epsilon}", P::NAME),
            tallies: Vec::new(),
        })
        .collect();
    for (class, number) in CLASSES.iter().zip(1..) {
        let tallies = tallies::<P>(class, rays, number, &|| effort.done(1));
        for (column, tally) in columns.iter_mut().zip(tallies) {
            column.tallies.push(tally);
        }
    }
    columns
}

/// A ray that leaves a surface.
struct Departure<N: Formats> {
    ray: Ray<N>,
    /// Whether it came from within the solid.
    from_within: bool,
    /// Whether it goes there.
    inwards: bool,
    /// The outward normal.
    normal: [f64; 3],
}

/// Lets a ray meet a body and go on as the material says; none where it does not meet it.
fn leave<P: Profile<Numbers: Told>>(
    body: &Body,
    ray: &Ray<P::Numbers>,
    material: &MaterialRecord,
    random: &mut P::Random,
) -> Option<Departure<P::Numbers>> {
    let t = body.closest::<P>(ray, false, I16F16::ZERO)?;
    let surface = body.interaction::<P>(ray, false, t);
    let direction = material.sample::<P, All>(ray.direction, &surface, random)?;
    let along = |direction| P::Numbers::cosine(direction, surface.normal);
    let is_glass = material.kind() == Some(Kind::Dielectric);
    let from_within = surface.from_inside || is_glass && along(ray.direction) > P::Numbers::ZERO;
    let inwards = if is_glass {
        along(direction) < P::Numbers::ZERO
    } else {
        from_within
    };
    Some(Departure {
        ray: Ray {
            origin: surface.point,
            direction,
            departed: surface.primitive,
            normal: surface.normal,
        },
        from_within,
        inwards,
        normal: surface.normal.map(Into::into),
    })
}

/// What all epsilons of a profile make of a class.
fn tallies<P: Compared>(class: &Class, rays: u64, seed: u64, done: &(impl Fn() + Sync)) -> Vec<Tally> {
    let material = material_record(&sphere([0.0; 3], 1.0, false, class.material), 0);
    let one_share = |share: u32| {
        let mut draw = Draw::new(seed, share);
        let mut random = P::Random::for_unit(seed, share);
        let mut tallies = vec![Tally::default(); P::EPSILONS.len()];
        let mut left = SHARE.min(rays);
        while left > 0 {
            let (body, ray) = (class.draw)(&mut draw, &class.material);
            let ray = ray_of::<P>(&ray);
            if let Some(departure) = leave::<P>(&body, &ray, &material, &mut random) {
                look_back::<P>(&body, &departure, &mut tallies);
                look_ahead::<P>(&mut draw, &body, &departure, &mut tallies);
                left -= 1;
            }
        }
        done();
        tallies
    };
    (0..rays.div_ceil(SHARE) as u32)
        .into_par_iter()
        .map(one_share)
        .reduce(
            || vec![Tally::default(); P::EPSILONS.len()],
            |mut all, share| {
                all.iter_mut()
                    .zip(&share)
                    .for_each(|(all, share)| all.merge(share));
                all
            },
        )
}

/// Whether a ray meets the surface it leaves, and where.
fn look_back<P: Compared>(body: &Body, departure: &Departure<P::Numbers>, tallies: &mut [Tally]) {
    let chord = departure
        .inwards
        .then(|| body.chord(&line_of(&departure.ray)).max(0.0));
    let far = P::Numbers::FAR.into() * 65_536.0;
    for (tally, (_, epsilon)) in tallies.iter_mut().zip(P::EPSILONS) {
        let answer = body.closest::<P>(&departure.ray, true, *epsilon);
        let met = answer.map(|t| t.into() * 65_536.0);
        let hits = &mut tally.ways[usize::from(departure.from_within)][usize::from(departure.inwards)];
        hits.count(chord.filter(|&chord| chord < far), met);
    }
}

impl SelfHits {
    /// Counts a ray whose chord is so long, if there is one, and what the tracer says that it meets.
    fn count(&mut self, chord: Option<f64>, met: Option<f64>) {
        let is_wrong = |t: f64| chord.is_none_or(|chord| (t - chord).abs() > ROUNDING + chord / 2.0);
        let wrong = met.filter(|&t| is_wrong(t));
        self.wrong.add(wrong.is_some());
        self.furthest = self.furthest.max(wrong.unwrap_or(0.0));
        if let Some(chord) = chord {
            self.lost.add(met.is_none());
            if met.is_none() {
                self.longest = self.longest.max(chord);
            }
        }
    }
}

/// Whether a ray meets what stands next to the surface it leaves. What it dips into by less than an ulp, it may pass by.
fn look_ahead<P: Compared>(
    draw: &mut Draw,
    body: &Body,
    departure: &Departure<P::Numbers>,
    tallies: &mut [Tally],
) {
    let sign = if departure.inwards { -1.0 } else { 1.0 };
    let place = Place {
        point: departure.ray.origin.map(Into::into),
        normal: departure.normal.map(|c| sign * c),
        sphere: body
            .sphere()
            .map(|(centre, radius)| (centre, radius, departure.inwards)),
    };
    let kind = (draw.number(0.0, KINDS.len() as f64) as usize).min(KINDS.len() - 1);
    let Some(neighbour) = neighbour(draw, &place, kind) else {
        return;
    };
    let line: Line = line_of(&departure.ray);
    let Start::Meets(crossing) = neighbour.first(&line) else {
        return;
    };
    let far = P::Numbers::FAR.into() * 65_536.0;
    if crossing.depth < 1.0 || crossing.distance >= far {
        return;
    }
    let ray = Ray {
        departed: PrimitiveId::new(1),
        ..departure.ray
    };
    for (tally, (_, epsilon)) in tallies.iter_mut().zip(P::EPSILONS) {
        let met = neighbour.closest::<P>(&ray, false, *epsilon);
        let passed = met.is_none_or(|t| t.into() * 65_536.0 > (crossing.distance + crossing.other) / 2.0);
        tally.neighbours[kind][bin(crossing.distance)].add(passed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Proof that faults are found: an epsilon of 16 ulp, and all of the published ones.
    #[test]
    fn what_goes_wrong_is_counted() {
        let effort = Effort::new(1, indicatif::ProgressBar::hidden());
        let columns = [
            columns::<Precise>(&effort, 20_000),
            columns::<Paper>(&effort, 20_000),
        ]
        .concat();
        for column in &columns[1..] {
            assert!(faults(column).len() > 10, "{}", column.name);
        }
    }
}
