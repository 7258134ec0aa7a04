//! A room: six walls, all of them parts of hollow spheres, that rays can only leave through.
//!
//! The space that hollow spheres have in common is convex, so the wall that a ray meets first is the one that it leaves this
//! space through. That is guessed as if walls were planes, without a root or a division, and worked out for one wall alone.
//! Whether the guess was right, the hit says: where it lies within all the other spheres, the ray has left none of them before.
//! Which points do the scene compiler has proved ([`Wall::low`], [`Wall::extent`]); of others, next to the room's edges, nothing is
//! known, and all spheres are asked.
//!
//! The scene's origin is where it makes this cheap: every wall's centre lies on an axis, so one product gives its projection
//! on a ray, and one the power of the ray's start.

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I16F16, I32F32, product};

use crate::arithmetic::{Formats, Mixed, Published};
use crate::geometry::sphere::SphereNumbers;
use crate::geometry::{MaterialId, PrimitiveId};

/// A wall: a hollow sphere whose centre lies on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Wall {
    /// Its centre.
    pub centre: [I16F16; 3],
    /// Where that is on the axis.
    pub place: I16F16,
    /// The sphere.
    pub primitive: PrimitiveId,
    /// Twice the place, times -1.
    pub twice_back: I16F16,
    /// Its radius squared, less its centre's square.
    pub power: I32F32,
    /// The corner of least coordinates of a box in which every point of this wall is well within all the other spheres.
    pub low: [I16F16; 3],
    /// The box's edges; a point at their far end is not in it.
    pub extent: [I16F16; 3],
    /// 1 / r in 0:44 where the wall is flat: so large that a hit's rounding is nothing beside its radius. Else 0.
    pub reciprocal: i32,
    /// Zero.
    pub unused: u16,
    /// What it is made of.
    pub material: MaterialId,
}

/// From this radius on a wall is flat: a point that is 2.5 ulp off its surface gives a normal within 5 ulp of 2^-30 of unit length.
pub const FLAT: I16F16 = I16F16::from_bits(8192 << 16);

/// What has been proved of a scene's hollow spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Room {
    /// Where walls cross their axes: each axis' wall in positive direction, then the one in negative direction.
    pub planes: [[I16F16; 2]; 3],
    /// The walls in the same order.
    pub walls: [[Wall; 2]; 3],
}

impl Room {
    /// Whether all walls are among so many hollow spheres.
    pub(crate) fn is_sound(&self, hollow_spheres: usize) -> bool {
        let mut walls = self.walls.as_flattened().iter();
        walls.all(|wall| wall.primitive.index() < hollow_spheres)
    }
}

/// Where a ray meets the first of a room's walls.
#[derive(Clone, Copy, Debug)]
pub struct Exit<'r, N: Formats> {
    /// The wall.
    pub wall: &'r Wall,
    /// How far along the ray.
    pub t: N::Length,
    /// The point, on the ray.
    pub point: [N::Length; 3],
}

/// The arithmetic of rooms.
pub trait RoomNumbers: Formats {
    /// Where a ray that starts within the room meets a wall, unless it is one that nothing is known of.
    #[inline]
    fn exit<'r>(
        _room: &'r Room,
        _origin: [Self::Length; 3],
        _direction: [Self::Unit; 3],
    ) -> Option<Exit<'r, Self>> {
        None
    }

    /// The outward normal of a flat wall at a point on it.
    fn normal_of_wall(wall: &Wall, point: [Self::Length; 3]) -> [Self::Unit; 3];
}

/// 16:16 everywhere is not fine enough for a proof.
impl RoomNumbers for Published {
    fn normal_of_wall(wall: &Wall, point: [I16F16; 3]) -> [I16F16; 3] {
        Mixed::normal_of_wall(wall, point).map(Self::unit)
    }
}

impl RoomNumbers for Mixed {
    #[inline]
    fn exit<'r>(room: &'r Room, origin: [I16F16; 3], direction: [I2F30; 3]) -> Option<Exit<'r, Self>> {
        exit_by(room, origin, direction, Self::near_root)
    }

    #[inline]
    fn normal_of_wall(wall: &Wall, point: [I16F16; 3]) -> [I2F30; 3] {
        let reciprocal = I2F30::from_bits(wall.reciprocal);
        [0, 1, 2].map(|i| {
            let from_centre = point[i] - wall.centre[i];
            I2F30::from_bits(product::wrapping_scaled(from_centre, reciprocal).to_bits())
        })
    }
}

/// Where a ray meets a wall, in the formats of [`Mixed`], with the root that `root` gives.
#[inline(always)]
pub fn exit_by<'r, N: Formats<Length = I16F16>>(
    room: &'r Room,
    origin: [I16F16; 3],
    direction: [I2F30; 3],
    root: impl FnOnce(I32F32) -> I16F16,
) -> Option<Exit<'r, N>> {
    let (o, d) = (origin.map(I16F16::to_bits), direction.map(I2F30::to_bits));
    let guess = |axis: usize| {
        let side = (d[axis] as u32 >> 31) as usize;
        Guess {
            distance: room.planes[axis][side].to_bits() - o[axis],
            speed: d[axis],
            start: o[axis],
            walls: &room.walls[axis],
        }
    };
    let nearest = guess(0).or_nearer(guess(1)).or_nearer(guess(2));
    let wall = &nearest.walls[(nearest.speed as u32 >> 31) as usize];
    let times = |a: i32, b: i32| i64::from(a) * i64::from(b);
    let along = times(o[0], d[0]) + times(o[1], d[1]) + times(o[2], d[2]);
    let centre = wall.place.to_bits();
    let b = ((times(centre, nearest.speed) - along) >> 30) as i32;
    let square = times(o[0], o[0]) + times(o[1], o[1]) + times(o[2], o[2]);
    let power = wall.power.to_bits() - (square + times(wall.twice_back.to_bits(), nearest.start));
    let t = I16F16::from_bits(b) + root(I32F32::from_bits(power + times(b, b)));
    let point = [0, 1, 2].map(|i| origin[i] + Mixed::scale(t, direction[i]));
    let within = |i: usize| {
        let above = point[i].to_bits().wrapping_sub(wall.low[i].to_bits());
        (above as u32) < wall.extent[i].to_bits() as u32
    };
    // A start that rounding has put beyond the wall meets it behind itself.
    (t >= I16F16::ZERO && within(0) && within(1) && within(2)).then_some(Exit { wall, t, point })
}

/// A wall that may be the first, as if it were a plane.
#[derive(Clone, Copy)]
struct Guess<'r> {
    /// How far away it is along its axis.
    distance: i32,
    /// The ray's direction along that axis.
    speed: i32,
    /// Where the ray starts along it.
    start: i32,
    /// The axis' walls.
    walls: &'r [Wall; 2],
}

impl Guess<'_> {
    /// This one, or another where distance / speed is less there. Both have one sign, unless rounding has put the ray outside.
    #[inline]
    fn or_nearer(self, other: Self) -> Self {
        if upper(other.distance, self.speed).abs() < upper(self.distance, other.speed).abs() {
            other
        } else {
            self
        }
    }
}

/// The upper word of a product.
#[inline]
fn upper(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 32) as i32
}
