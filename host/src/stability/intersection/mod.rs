//! Where rays meet spheres, by every formula, against integers.
//!
//! All formulas see the same centre, radius, start and direction, in the formats of cores. What they should have said is decided exactly.

mod cases;
mod formulas;
mod tally;

pub(super) use self::formulas::ray_of;

use rayon::prelude::*;

use self::cases::{CLASSES, Class};
use self::formulas::{FORMULAS, Formula};
use self::tally::{HEAD, OCTAVES, Tally, middle};
use super::draw::Draw;
use super::{Effort, Error, Findings, Part, Plot, Table};

/// The part.
pub(super) const PART: Part = Part {
    name: "intersection",
    about: "where rays meet spheres, by every formula, against integers",
    measure,
};

/// Rays of each class.
const RAYS: u64 = 10_000_000;
/// Rays that a thread draws at a time.
const SHARE: u64 = 1 << 14;

const UNITS: &str = "False hits are a share of the rays that miss; false misses, and the other root taken for the first, of those that hit. \
    Distances and points are in ulp of 2^-16, normals in 2^-30 of unit length.";

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let rays = effort.of(RAYS);
    effort.expect(rays.div_ceil(SHARE) * CLASSES.len() as u64);
    let mut findings = Findings::default();
    for (class, number) in CLASSES.iter().zip(1..) {
        let tallies = tallies(class, rays, number, &|| effort.done(1));
        let mut table = Table::new(class.name, UNITS, &HEAD);
        for (formula, tally) in &tallies {
            table.push(tally.row(formula.name));
        }
        findings.tables.push(table);
        if let Some(name) = class.plot {
            findings.plots.push(plot(name, class, &tallies));
        }
    }
    Ok(findings)
}

/// What all formulas that answer for it make of a class.
fn tallies(class: &Class, rays: u64, seed: u64, done: &(impl Fn() + Sync)) -> Vec<(&'static Formula, Tally)> {
    let one_share = |share: u32| {
        let mut draw = Draw::new(seed, share);
        let mut tallies: Vec<Tally> = FORMULAS.iter().map(|_| Tally::default()).collect();
        for _ in 0..SHARE.min(rays) {
            let case = (class.draw)(&mut draw);
            for (formula, tally) in FORMULAS.iter().zip(&mut tallies) {
                if (formula.answers)(case.surface) {
                    let line = (formula.line)(&case);
                    tally.add(&case, &line, case.truth(&line), (formula.meet)(&case));
                }
            }
        }
        done();
        tallies
    };
    let shares: Vec<Vec<Tally>> = (0..rays.div_ceil(SHARE) as u32)
        .into_par_iter()
        .map(one_share)
        .collect();
    // In order, so that two runs give the same sums.
    let mut all: Vec<(&Formula, Tally)> = FORMULAS
        .iter()
        .map(|formula| (formula, Tally::default()))
        .collect();
    for share in &shares {
        for ((_, all), tally) in all.iter_mut().zip(share) {
            all.merge(tally);
        }
    }
    all.retain(|(_, tally)| tally.has_cases());
    all
}

fn plot(name: &'static str, class: &Class, tallies: &[(&Formula, Tally)]) -> Plot {
    let curve = |tally: &Tally| {
        let points = (0..OCTAVES).zip(&tally.by_radius);
        points
            .filter_map(|(octave, errors)| Some((middle(octave), errors.mean()?)))
            .collect()
    };
    Plot {
        name,
        title: format!("Mean error of the distance: {}", class.name),
        across: "radius, units",
        upwards: "error, ulp of 2^-16",
        curves: tallies
            .iter()
            .map(|(formula, tally)| (formula.name.replace('`', ""), curve(tally)))
            .collect(),
    }
}
