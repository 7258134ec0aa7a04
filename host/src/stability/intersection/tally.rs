//! How wrong a formula is over many cases.

use super::cases::Truth;
use super::formulas::Answer;
use crate::stability::draw::dot;
use crate::stability::table::{figure, share};

/// What columns are called.
pub(super) const HEAD: [&str; 10] = [
    "formula",
    "false hits",
    "false misses",
    "wrong root",
    "distance, mean",
    "worst",
    "point, mean",
    "worst",
    "normal, mean",
    "worst",
];

/// Roots that are no further apart, in ulp, are not told apart.
const SAME: f64 = 2.0;
/// Octaves of the radius that are told apart, from the smallest there is: 2^-7 units.
pub(super) const OCTAVES: usize = 24;

/// Mean and worst of an error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    count: u64,
    sum: f64,
    worst: f64,
}

/// Counts of one formula over one class.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Cases without a hit, and how many of them the formula takes for one.
    misses: u64,
    pub(super) false_hits: u64,
    /// Cases with one, and how many of them the formula misses, or takes the other root for.
    hits: u64,
    pub(super) false_misses: u64,
    pub(super) wrong_roots: u64,
    /// Of the other cases with one: errors of distance and point in ulp, of the normal in 2^-30.
    pub(super) distance: Spread,
    point: Spread,
    normal: Spread,
    /// Errors of distance by the octave of the radius.
    pub(super) by_radius: [Spread; OCTAVES],
}

impl Spread {
    fn add(&mut self, error: f64) {
        self.count += 1;
        self.sum += error;
        self.worst = self.worst.max(error);
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.worst = self.worst.max(other.worst);
    }

    /// The mean; none of nothing.
    pub(super) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

impl Tally {
    /// Counts one answer to a case of a sphere of this radius in ulp.
    pub(super) fn add(&mut self, radius: i64, truth: Option<Truth>, answer: Option<Answer>) {
        let Some(truth) = truth else {
            self.misses += 1;
            self.false_hits += u64::from(answer.is_some());
            return;
        };
        self.hits += 1;
        let Some(answer) = answer else {
            self.false_misses += 1;
            return;
        };
        let error = (answer.distance - truth.distance).abs();
        if error > SAME && error > (answer.distance - truth.other).abs() {
            self.wrong_roots += 1;
            return;
        }
        let off = [0, 1, 2].map(|i| answer.point[i] - truth.point[i]);
        let turned = [0, 1, 2].map(|i| answer.normal[i] - truth.normal[i]);
        self.distance.add(error);
        self.point.add(dot(off, off).sqrt());
        self.normal.add(dot(turned, turned).sqrt() * f64::from(1 << 30));
        self.by_radius[octave(radius)].add(error);
    }

    /// Adds another's counts.
    pub(super) fn merge(&mut self, other: &Self) {
        self.misses += other.misses;
        self.false_hits += other.false_hits;
        self.hits += other.hits;
        self.false_misses += other.false_misses;
        self.wrong_roots += other.wrong_roots;
        self.distance.merge(&other.distance);
        self.point.merge(&other.point);
        self.normal.merge(&other.normal);
        for (octave, other) in self.by_radius.iter_mut().zip(&other.by_radius) {
            octave.merge(other);
        }
    }

    /// The row of a formula.
    pub(super) fn row(&self, formula: &str) -> Vec<String> {
        let mean = |spread: &Spread| spread.mean().map_or("-".to_owned(), figure);
        let worst = |spread: &Spread| spread.mean().map_or("-".to_owned(), |_| figure(spread.worst));
        vec![
            formula.to_owned(),
            share(self.false_hits, self.misses),
            share(self.false_misses, self.hits),
            share(self.wrong_roots, self.hits),
            mean(&self.distance),
            worst(&self.distance),
            mean(&self.point),
            worst(&self.point),
            mean(&self.normal),
            worst(&self.normal),
        ]
    }
}

/// Which octave a radius in ulp lies in.
fn octave(radius: i64) -> usize {
    (radius.max(1).ilog2() as usize)
        .saturating_sub(9)
        .min(OCTAVES - 1)
}

/// The middle of an octave of the radius, in units.
pub(super) fn middle(octave: usize) -> f64 {
    2f64.powf(octave as f64 + 9.5 - 16.0)
}
