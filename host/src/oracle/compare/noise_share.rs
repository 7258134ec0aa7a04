//! Whose noise it is that stands between a picture and its reference.

use super::SIDE;
use crate::image::picture::Estimate;

/// The reference's standard errors over the picture's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseShare {
    /// Of the whole picture's mean. Infinite where the reference alone has noise.
    pub mean: f64,
    /// Of the mean of a tile: the median over the tiles in which the picture has noise, 0 if there is none.
    pub tile: f64,
}

impl NoiseShare {
    /// What `reference`'s noise is beside that of `picture`, both of one size; `None` unless both sides' variance is known.
    pub fn of(reference: &Estimate, picture: &Estimate) -> Option<Self> {
        let (width, _) = picture.picture.size();
        let [reference, picture] = [reference, picture].map(|estimate| estimate.variance.as_deref());
        let (reference, picture) = (reference?, picture?);
        let tiles = |variance| tile_errors(variance, usize::from(width));
        let mut shares: Vec<f64> = tiles(reference)
            .into_iter()
            .zip(tiles(picture))
            .filter(|&(_, error)| error > 0.0)
            .map(|(reference, picture)| reference / picture)
            .collect();
        shares.sort_by(f64::total_cmp);
        let error = error_of_sum(reference.iter().copied());
        Some(Self {
            mean: if error > 0.0 {
                error / error_of_sum(picture.iter().copied())
            } else {
                0.0
            },
            tile: shares.get(shares.len() / 2).copied().unwrap_or(0.0),
        })
    }

    /// The larger of the two.
    pub fn largest(&self) -> f64 {
        self.mean.max(self.tile)
    }
}

/// The most that the standard error of a sum over pixels and channels can be: as if the channels' noise were one and the same.
pub(super) fn error_of_sum(variances: impl Iterator<Item = [f64; 3]>) -> f64 {
    let sums = variances.fold([0.0; 3], |sums, variance| {
        [0, 1, 2].map(|c| sums[c] + variance[c])
    });
    sums.iter().map(|sum: &f64| sum.sqrt()).sum()
}

/// [`error_of_sum`] of every tile.
fn tile_errors(variance: &[[f64; 3]], width: usize) -> Vec<f64> {
    let side = usize::from(SIDE);
    let mut tiles = Vec::new();
    for rows in variance.chunks(width * side) {
        for x in (0..width).step_by(side) {
            let row = |row: &'_ [[f64; 3]]| row[x..(x + side).min(width)].to_vec();
            tiles.push(error_of_sum(rows.chunks(width).flat_map(row)));
        }
    }
    tiles
}
