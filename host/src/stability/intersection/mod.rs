//! Where rays meet spheres, by every formula, against integers.
//!
//! All formulas see the same centre, radius, start and direction, in the formats of cores. What they should have said is decided exactly.

mod cases;
mod formulas;
mod order;
mod tally;
mod vast;

pub(super) use self::formulas::ray_of;

use rayon::prelude::*;

use self::cases::{CLASSES, Class, Surface};
use self::formulas::{FORMULAS, Formula};
use self::order::{Order, PAIRS};
use self::tally::{HEAD, OCTAVES, Tally, middle};
use super::draw::Draw;
use super::table::{figure, share};
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

const ORDER_UNITS: &str = "The share of rays that are told the wrong one of two surfaces, and how far apart the two were at most, in ulp along the ray.";

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let rays = effort.of(RAYS);
    let classes = CLASSES.len() + vast::CLASSES.len() + PAIRS.len();
    effort.expect(rays.div_ceil(SHARE) * classes as u64);
    let done = || effort.done(1);
    let mut findings = Findings::default();
    for (class, seed) in CLASSES.iter().zip(1..) {
        let formulas: Vec<&Formula> = FORMULAS
            .iter()
            .filter(|formula| (formula.answers)(class.surface))
            .collect();
        let judge = |draw: &mut Draw, tallies: &mut [Tally]| judge(class, &formulas, draw, tallies);
        let tallies = shares(formulas.len(), rays, seed, &done, judge, Tally::merge);
        let names = formulas.iter().map(|formula| formula.name);
        let units = if findings.tables.is_empty() { UNITS } else { "" };
        findings
            .tables
            .push(table(class.name, units, names.clone().zip(&tallies)));
        if let Some(name) = class.plot {
            findings.plots.push(plot(name, class, names.zip(&tallies)));
        }
    }
    for (class, seed) in vast::CLASSES.iter().zip(101..) {
        let judge = |draw: &mut Draw, tallies: &mut [Tally]| vast::judge(class, draw, tallies);
        let tallies = shares(vast::FORMULAS.len(), rays, seed, &done, judge, Tally::merge);
        let rows = vast::FORMULAS.into_iter().zip(&tallies);
        findings.tables.push(table(class.0, "", rows));
    }
    findings.tables.push(orders(rays, &done));
    Ok(findings)
}

/// A table; what its figures are in, the first one says for all.
fn table<'t>(title: &str, units: &str, rows: impl Iterator<Item = (&'t str, &'t Tally)>) -> Table {
    let mut table = Table::new(title, units, &HEAD);
    for (name, tally) in rows {
        table.push(tally.row(name));
    }
    table
}

/// Draws a case, and counts what each formula makes of it.
fn judge(class: &Class, formulas: &[&Formula], draw: &mut Draw, tallies: &mut [Tally]) {
    let case = (class.draw)(draw);
    for (formula, tally) in formulas.iter().zip(tallies) {
        let truth = case.truth(&(formula.line)(&case));
        tally.add(case.sphere().radius, truth, (formula.meet)(&case));
    }
}

/// Which of two close surfaces comes first, by all formulas.
fn orders(rays: u64, done: &(impl Fn() + Sync)) -> Table {
    let formulas: Vec<&Formula> = FORMULAS
        .iter()
        .filter(|formula| (formula.answers)(Surface::Wall))
        .collect();
    let mut head = vec!["formula"];
    for pair in &PAIRS {
        head.extend([pair.name, "up to"]);
    }
    let mut rows: Vec<Vec<String>> = formulas
        .iter()
        .map(|formula| vec![formula.name.to_owned()])
        .collect();
    for (pair, seed) in PAIRS.iter().zip(201..) {
        let judge = |draw: &mut Draw, orders: &mut [Order]| order::judge(pair, &formulas, draw, orders);
        let orders = shares(formulas.len(), rays, seed, done, judge, Order::merge);
        for (row, order) in rows.iter_mut().zip(&orders) {
            row.extend([share(order.wrong, order.all), figure(order.furthest)]);
        }
    }
    let mut table = Table::new("Which of two surfaces comes first", ORDER_UNITS, &head);
    rows.into_iter().for_each(|row| table.push(row));
    table
}

/// Shares of the work, in parallel, each with `width` counts; added up in order, so that two runs give the same sums.
fn shares<T: Clone + Default + Send>(
    width: usize,
    rays: u64,
    seed: u64,
    done: &(impl Fn() + Sync),
    judge: impl Fn(&mut Draw, &mut [T]) + Sync,
    merge: impl Fn(&mut T, &T),
) -> Vec<T> {
    let one_share = |share: u32| {
        let mut draw = Draw::new(seed, share);
        let mut counts = vec![T::default(); width];
        for _ in 0..SHARE.min(rays) {
            judge(&mut draw, &mut counts);
        }
        done();
        counts
    };
    let shares: Vec<Vec<T>> = (0..rays.div_ceil(SHARE) as u32)
        .into_par_iter()
        .map(one_share)
        .collect();
    let mut all = vec![T::default(); width];
    for share in &shares {
        all.iter_mut()
            .zip(share)
            .for_each(|(all, count)| merge(all, count));
    }
    all
}

fn plot<'t>(name: &'static str, class: &Class, rows: impl Iterator<Item = (&'t str, &'t Tally)>) -> Plot {
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
        curves: rows
            .map(|(formula, tally)| (formula.replace('`', ""), curve(tally)))
            .collect(),
    }
}
