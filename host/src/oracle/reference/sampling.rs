//! Random numbers, in strata, and what is made of them.
//!
//! The samples of a sub-pixel come in batches of `side` x `side`. In each of its first dimensions (the filter, and what is
//! decided at the first surfaces) a batch has one sample in every cell of a grid, and which sample has which cell is shuffled for each
//! dimension anew (jittered sampling, padded: Pharr, Jakob, Humphreys, "Physically Based Rendering", "Stratified
//! Sampler"). Batches are independent of each other, so the spread of their means says what noise is left.

use std::f64::consts::{PI, TAU};

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

use super::vector::Vector;

/// Surfaces whose decisions are stratified.
const SURFACES: usize = 3;
/// The filter; at each surface one pair for where the path goes on and one for where light is looked for.
const DIMENSIONS: usize = 1 + 2 * SURFACES;
/// The finest grid is of this many cells a side.
const FINEST: usize = 4;

/// A uniform number in [0, 1). It has 48 bits, so that a cell's number added to it does not round up into the next cell.
fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 16) as f64 * (1.0 / (1u64 << 48) as f64)
}

/// The side of the finest grid of which `samples` are at least four whole batches: fewer would not tell their noise.
pub(super) fn side(samples: u32) -> usize {
    let fits = |side: &usize| {
        let batch = (side * side) as u32;
        samples.is_multiple_of(batch) && samples / batch >= 4
    };
    [FINEST, 2].into_iter().find(fits).unwrap_or(1)
}

/// Which cell each sample of a batch has, by dimension.
pub(super) struct Batch {
    side: usize,
    cells: [[u8; FINEST * FINEST]; DIMENSIONS],
}

impl Batch {
    /// A batch of `side` squared samples; `side` is at most [`FINEST`].
    pub(super) fn new(side: usize, random: &mut Xoshiro256PlusPlus) -> Self {
        let mut cells = [std::array::from_fn(|cell| cell as u8); DIMENSIONS];
        for cells in &mut cells {
            // Fisher's and Yates's shuffle.
            for last in (1..side * side).rev() {
                let other = uniform(random) * (last + 1) as f64;
                cells.swap(last, other as usize);
            }
        }
        Self { side, cells }
    }

    pub(super) fn size(&self) -> usize {
        self.side * self.side
    }

    /// The random numbers of one of the batch's samples.
    pub(super) fn draws<'a>(&'a self, sample: usize, random: &'a mut Xoshiro256PlusPlus) -> Draws<'a> {
        Draws {
            batch: self,
            sample,
            random,
        }
    }
}

/// The random numbers of one sample.
pub(super) struct Draws<'a> {
    batch: &'a Batch,
    sample: usize,
    random: &'a mut Xoshiro256PlusPlus,
}

impl Draws<'_> {
    /// A uniform number in [0, 1), of no stratum.
    pub(super) fn uniform(&mut self) -> f64 {
        uniform(self.random)
    }

    /// A point in the unit square for the filter.
    pub(super) fn of_pixel(&mut self) -> [f64; 2] {
        self.pair(0)
    }

    /// A point in the unit square for where a path goes on from its surface `number`, counted from 1.
    pub(super) fn of_direction(&mut self, number: u32) -> [f64; 2] {
        self.pair(2 * number as usize - 1)
    }

    /// A number in [0, 1) for which way a path takes at its surface `number`.
    pub(super) fn of_choice(&mut self, number: u32) -> f64 {
        let uniform = self.uniform();
        match self.cell(2 * number as usize - 1) {
            Some(cell) => (cell as f64 + uniform) / self.batch.size() as f64,
            None => uniform,
        }
    }

    /// A point in the unit square for where light is looked for from surface `number`.
    pub(super) fn of_light(&mut self, number: u32) -> [f64; 2] {
        self.pair(2 * number as usize)
    }

    fn cell(&self, dimension: usize) -> Option<usize> {
        let cells = self.batch.cells.get(dimension)?;
        Some(usize::from(cells[self.sample]))
    }

    fn pair(&mut self, dimension: usize) -> [f64; 2] {
        let pair = [self.uniform(), self.uniform()];
        match self.cell(dimension) {
            Some(cell) => {
                let side = self.batch.side;
                let [x, y] = [cell % side, cell / side].map(|cell| cell as f64);
                [(x + pair[0]) / side as f64, (y + pair[1]) / side as f64]
            }
            None => pair,
        }
    }
}

/// A place of the tent filter over (-1, 1).
pub(super) fn tent(uniform: f64) -> f64 {
    let r = 2.0 * uniform;
    if r < 1.0 {
        r.sqrt() - 1.0
    } else {
        1.0 - (2.0 - r).sqrt()
    }
}

/// A direction around `normal` with the density of [`cosine_density`].
pub(super) fn cosine_weighted(normal: Vector, [square, around]: [f64; 2]) -> Vector {
    direction(normal, (1.0 - square).sqrt(), square.sqrt(), around)
}

/// Density of [`cosine_weighted`] by solid angle, at this cosine to the normal.
pub(super) fn cosine_density(cosine: f64) -> f64 {
    cosine / PI
}

/// A direction no further from `axis` than where one minus the cosine is `height`, uniform by solid angle (Shirley and Wang,
/// "Monte Carlo techniques for direct lighting calculations", 1996, for the cone in which a sphere is seen).
pub(super) fn within_cone(axis: Vector, height: f64, [share, around]: [f64; 2]) -> Vector {
    let below = height * share;
    // The sine from the height itself: a cosine near 1 has lost it.
    direction(axis, 1.0 - below, (below * (2.0 - below)).sqrt(), around)
}

/// The unit vector at an angle to `axis` of this cosine and sine, `turn` of a full turn around it.
fn direction(axis: Vector, cosine: f64, sine: f64, turn: f64) -> Vector {
    let [tangent, bitangent] = axis.tangents();
    let (across, up) = (TAU * turn).sin_cos();
    (tangent * (up * sine) + bitangent * (across * sine) + axis * cosine).normalised()
}
