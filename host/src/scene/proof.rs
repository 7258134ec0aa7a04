//! What is proved of a scene, so that a core may leave it out: where it has its origin, which walls make a room, and which solids
//! a look in 16 bits tells from a ray. Where nothing can be proved the scene is as right, and slower.

use fixedmath::I16F16;
use tracer::aggregate::Room;
use tracer::geometry::Grid;
use tracer::geometry::sphere::{CoarseSphere, SolidSphere, SphereRecord};
use tracer::scene::{Capabilities, Capability};

use super::fixed::q16;
use super::reach::{Extent, REACH};
use super::room::RoomProof;
use super::scale::LONGEST;

/// The spheres of a scene as they lie around its origin, and what has been proved of them.
#[derive(Clone, Debug)]
pub(super) struct Proved {
    /// The tracer's origin, in the scene's coordinates.
    pub(super) origin: [I16F16; 3],
    pub(super) hollow_spheres: Vec<SphereRecord>,
    pub(super) solid_spheres: Vec<SolidSphere>,
    pub(super) room: Option<Room>,
    pub(super) grid: Grid,
    /// Whether it pays to look at solids roughly first.
    coarse: bool,
}

impl Proved {
    /// Of ordinary spheres whose records lie in the scene's coordinates. The origin of a scene with vast ones is its `middle`.
    pub(super) fn of(
        extent: &Extent<'_>,
        middle: Option<[I16F16; 3]>,
        mut hollow: Vec<SphereRecord>,
        mut solid: Vec<SphereRecord>,
    ) -> Self {
        let fits = |origin: [I16F16; 3]| {
            let all =
                |sphere: &SphereRecord| (0..3).all(|i| sphere.centre[i].checked_sub(origin[i]).is_some());
            hollow.iter().chain(&solid).all(all)
        };
        let proof = RoomProof::of(&hollow).filter(|proof| middle.is_none() && fits(proof.origin));
        // Else the centre of the smallest room is next to where rays start.
        let smallest = hollow.iter().min_by_key(|sphere| sphere.radius);
        let origin = proof
            .map(|proof| proof.origin)
            .or(middle)
            .or(smallest
                .map(|sphere| sphere.centre)
                .filter(|&centre| fits(centre)))
            .unwrap_or_default();
        let reaches: Vec<I16F16> = solid.iter().map(|sphere| reach(extent, sphere.centre)).collect();
        let start = reach(extent, origin);
        for sphere in hollow.iter_mut().chain(&mut solid) {
            sphere.centre = [0, 1, 2].map(|i| sphere.centre[i] - origin[i]);
        }
        let grid = grid(&reaches, start, &solid);
        let telling = solid
            .iter()
            .zip(&reaches)
            .filter(|(sphere, reach)| is_telling(grid, sphere, **reach, extent.is_enclosed()));
        let coarse = 2 * telling.count() > solid.len();
        let with_coarse = |(sphere, reach): (SphereRecord, I16F16)| SolidSphere {
            coarse: CoarseSphere::new(grid, sphere.centre, sphere.square, reach),
            sphere,
        };
        Self {
            origin,
            hollow_spheres: hollow,
            solid_spheres: solid.into_iter().zip(reaches).map(with_coarse).collect(),
            room: proof.map(|proof| proof.room),
            grid,
            coarse,
        }
    }

    /// The records of all these spheres, hollow ones first.
    pub(super) fn records(&self) -> Vec<SphereRecord> {
        let solid = self.solid_spheres.iter().map(|solid| solid.sphere);
        self.hollow_spheres.iter().copied().chain(solid).collect()
    }

    /// What an image must have code for to make use of it.
    pub(super) fn needs(&self) -> Capabilities {
        let room = self
            .room
            .map_or(Capabilities::NONE, |_| Capabilities::of(&[Capability::Room]));
        if self.coarse {
            room.with(Capability::Coarse)
        } else {
            room
        }
    }
}

/// Whether a rough look tells most rays that miss a solid, and most rays miss it. Where rays start next to it, a large one is
/// often met, and then the look was for nothing. Under the sky nobody knows where they start: as near as a few radii, it may be.
fn is_telling(grid: Grid, sphere: &SphereRecord, reach: I16F16, in_room: bool) -> bool {
    /// From where a sphere takes half as much again for a hit as it should.
    const NEAR: i32 = 5;
    let coarse = CoarseSphere::new(grid, sphere.centre, sphere.square, reach);
    let reach = if in_room {
        reach
    } else {
        reach.min(sphere.radius.saturating_mul_int(NEAR))
    };
    coarse.is_telling(grid, reach)
}

/// A bound on how far from a point rays start, wherever the camera is.
fn reach(extent: &Extent<'_>, point: [I16F16; 3]) -> I16F16 {
    /// In a room, what the tent filter may put outside of it.
    const MARGIN: f64 = 1.1;
    let farthest = if extent.is_enclosed() {
        MARGIN * extent.farthest_start(point.map(I16F16::to_num)) + 1.0
    } else {
        2.0 * REACH
    };
    q16(farthest.min(LONGEST))
}

/// The grid for solids that rays start no further than `reaches` from, and no further than `start` from the origin.
fn grid(reaches: &[I16F16], start: I16F16, solids: &[SphereRecord]) -> Grid {
    let farthest = reaches.iter().copied().max().unwrap_or_default();
    let coordinates = solids.iter().flat_map(|sphere| sphere.centre);
    let centre = coordinates.map(I16F16::saturating_abs).max().unwrap_or_default();
    // Without a room a camera may be anywhere that 16:16 holds.
    let start = if start >= q16(2.0 * REACH) {
        I16F16::MAX
    } else {
        start
    };
    Grid::finest(farthest, start.max(centre))
}
