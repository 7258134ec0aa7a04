//! The camera: where a sample's first ray starts.

use crate::numbers::Numbers;
use crate::random::Random;
use crate::ray::Ray;

/// One direction across the film.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Sub-pixels from edge to edge: twice the pixels.
    pub subpixels: u32,
    /// 2^45 / `subpixels`.
    pub reciprocal: u64,
}

/// A pinhole camera whose rays start some way along their direction.
#[derive(Clone, Copy, Debug)]
pub struct Camera<N: Numbers> {
    /// The pinhole.
    pub position: [N::Length; 3],
    /// To the film's centre. This and the next two share a scale that keeps every sum of them below 2.
    pub forward: [N::Unit; 3],
    /// From the film's left edge to its right.
    pub right: [N::Unit; 3],
    /// From the film's lower edge to its upper.
    pub up: [N::Unit; 3],
    /// How far along its unit direction a ray starts.
    pub near: N::Length,
    /// Across the film.
    pub columns: Axis,
    /// Up the film.
    pub rows: Axis,
}

impl<N: Numbers> Camera<N> {
    /// A ray through the sub-pixel in `column` from the left and `row` from below, spread by the tent filter.
    pub fn ray<R: Random>(&self, column: u32, row: u32, random: &mut R) -> Ray<'static, N> {
        let (x, y) = (N::tent(random.fraction()), N::tent(random.fraction()));
        let x = N::across(column, x, self.columns.subpixels, self.columns.reciprocal);
        let y = N::across(row, y, self.rows.subpixels, self.rows.reciprocal);
        let direction = N::normalised(N::combine(self.forward, x, self.right, y, self.up), self.forward);
        let origin = [0, 1, 2].map(|i| self.position[i] + N::scale(self.near, direction[i]));
        Ray {
            origin,
            direction,
            leaves: None,
            outward: [N::ZERO; 3],
        }
    }
}
