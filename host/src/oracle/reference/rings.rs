//! Which paths by way of a ball lead to an emitter, in the plane of a place, the ball's centre and the emitter's middle.
//!
//! The place is as far from the centre as `1 / near` radii, and `angle` is that between the way on from the place through the centre and the one
//! from the centre to the emitter. A table has a cell for every range of both, and in each the least and the largest `b`, of the radius and
//! with a sign for the side, of all paths that lead there from one of the cell's corners.

use std::f64::consts::PI;

/// Cells by how near the place is.
const NEAR: usize = 32;
/// Cells by the angle.
const ANGLES: usize = 64;
/// Paths that are tried.
const TRIED: usize = 256;
/// A place so far away, in radii, stands for all that are further.
const FAR: f64 = 1e3;

/// What a ball does with a path.
#[derive(Clone, Copy)]
pub(super) enum Bend {
    Reflected,
    /// Into the glass and out of it again.
    Refracted {
        index: f64,
    },
}

impl Bend {
    /// By how much a path is turned that passes the centre at `b` of the radius, towards the centre's side.
    fn turned(self, b: f64) -> f64 {
        match self {
            Self::Reflected => 2.0 * b.asin() - PI.copysign(b),
            Self::Refracted { index } => 2.0 * (b.asin() - (b / index).clamp(-1.0, 1.0).asin()),
        }
    }
}

/// The table of one ball and one emitter.
pub(super) struct Rings(Vec<Option<[f64; 2]>>);

impl Rings {
    /// For an emitter that reaches `reach` around its middle and a ball of the radius `radius`, both of the distance between them.
    pub(super) fn new(bend: Bend, radius: f64, reach: f64) -> Self {
        let paths: Vec<[f64; 2]> = (0..TRIED)
            .map(|number| (2 * number + 1) as f64 / TRIED as f64 - 1.0)
            .map(|b| [b, bend.turned(b)])
            .collect();
        let corners: Vec<_> = (0..=NEAR)
            .map(|row| (row as f64 / NEAR as f64).max(1.0 / FAR))
            .map(|near| row(&paths, near, radius, reach))
            .collect();
        let cells = corners.windows(2).flat_map(|rows| {
            let columns = rows[0].windows(2).zip(rows[1].windows(2));
            columns.map(|(one, other)| one.iter().chain(other).flatten().copied().reduce(around))
        });
        Self(cells.collect())
    }

    /// Least and largest `b` that lead to the emitter, seen under an angle with this cosine and sine.
    pub(super) fn at(&self, near: f64, cosine: f64, sine: f64) -> Option<[f64; 2]> {
        let share = (1.0 - cosine / (cosine.abs() + sine)) / 2.0;
        // Casts cut off, and saturate.
        let cell = |share: f64, cells: usize| ((share * cells as f64) as usize).min(cells - 1);
        self.0[cell(near, NEAR) * ANGLES + cell(share, ANGLES)]
    }
}

/// The corners of one row of cells: of all `paths`, `b` and by how much they are turned, those that lead to the emitter.
fn row(paths: &[[f64; 2]], near: f64, radius: f64, reach: f64) -> Vec<Option<[f64; 2]>> {
    // A path stands for those around it.
    let half = 1.0 / TRIED as f64;
    let ways_out: Vec<_> = paths
        .iter()
        .map(|&[b, turned]| (b, ((b * near).asin() - turned).sin_cos()))
        .collect();
    let corner = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        let leading = ways_out.iter().filter(|(b, (out_sine, out_cosine))| {
            let is_in_front = cosine * out_cosine + sine * out_sine > 0.0;
            // How far the way out passes the emitter's middle, of its distance.
            is_in_front && (sine * out_cosine - cosine * out_sine - b * radius).abs() < reach
        });
        leading.map(|(b, _)| [b - half, b + half]).reduce(around)
    };
    let angles = (0..=ANGLES).map(|column| angle(column as f64 / ANGLES as f64));
    angles.map(corner).collect()
}

/// The angle of a share of all columns, as [`Rings::at`] has it: no arc cosine is needed for the way back.
fn angle(share: f64) -> f64 {
    // Cosine over the sum of both.
    let part = 1.0 - 2.0 * share;
    (1.0 - part.abs()).atan2(part)
}

/// The smallest range that holds both.
fn around(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    [one[0].min(other[0]), one[1].max(other[1])]
}
