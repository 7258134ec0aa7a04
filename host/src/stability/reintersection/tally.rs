//! Counts of rays that leave surfaces.

use super::neighbours::KINDS;

/// Distances of neighbours that are told apart, by their upper ends in ulp; the last has none. Epsilons of 16 ulp, of 0.001 and of 0.1
/// lie between two of them.
pub(super) const BINS: [(f64, &str); 9] = [
    (1.0, "to 1"),
    (2.0, "2"),
    (3.0, "3"),
    (4.0, "4"),
    (16.0, "16"),
    (66.0, "66"),
    (656.0, "656"),
    (6554.0, "6554"),
    (f64::INFINITY, "more"),
];

/// From this one on, a neighbour is certain: further away than 4 ulp.
pub(super) const CLEAR: usize = 4;

/// How many of how many.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count {
    pub(super) all: u64,
    pub(super) failed: u64,
}

impl Count {
    pub(super) fn add(&mut self, failed: bool) {
        self.all += 1;
        self.failed += u64::from(failed);
    }

    /// Adds another's.
    pub(super) fn merge(&mut self, other: Self) {
        self.all += other.all;
        self.failed += other.failed;
    }
}

/// What became of rays that leave one way, by one epsilon.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SelfHits {
    /// Rays, and how many of them met the surface again where it is not.
    pub(super) wrong: Count,
    /// How far along the furthest of them did, in ulp.
    pub(super) furthest: f64,
    /// Rays that had to meet it again, and how many did not.
    pub(super) lost: Count,
    /// The longest way across to where they should have, in ulp.
    pub(super) longest: f64,
}

impl SelfHits {
    fn merge(&mut self, other: &Self) {
        self.wrong.merge(other.wrong);
        self.furthest = self.furthest.max(other.furthest);
        self.lost.merge(other.lost);
        self.longest = self.longest.max(other.longest);
    }
}

/// Neighbours met by one epsilon: how many there were at which distance, and how many of them were passed through.
pub(super) type Neighbours = [[Count; BINS.len()]; KINDS.len()];

/// Counts of one class by one epsilon.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    /// By whether a ray came from within, and whether it leaves to the inside.
    pub(super) ways: [[SelfHits; 2]; 2],
    pub(super) neighbours: Neighbours,
}

impl Tally {
    /// Adds another's counts.
    pub(super) fn merge(&mut self, other: &Self) {
        for (way, other) in self.ways.iter_mut().flatten().zip(other.ways.iter().flatten()) {
            way.merge(other);
        }
        for (count, &other) in self
            .neighbours
            .iter_mut()
            .flatten()
            .zip(other.neighbours.iter().flatten())
        {
            count.merge(other);
        }
    }
}

/// Which of the distances one in ulp is among.
pub(super) fn bin(distance: f64) -> usize {
    BINS.iter()
        .position(|&(end, _)| distance <= end)
        .unwrap_or(BINS.len() - 1)
}
