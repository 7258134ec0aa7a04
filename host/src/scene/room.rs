//! What can be proved of a scene's hollow spheres: see [`tracer::aggregate::Room`].

use fixedmath::{I16F16, I32F32};
use tracer::aggregate::{FLAT, Room, Wall};
use tracer::geometry::sphere::SphereRecord;
use tracer::geometry::{MaterialId, PrimitiveId};

/// How far within the other spheres a wall's hits are: 256 ulp, where rounding moves none by more than 3.
const MARGIN: f64 = 1.0 / 256.0;
/// A room whose boxes are narrower than this part of it would seldom save anything.
const WORTH: f64 = 0.9;

/// A room, and the point that its walls' centres lie on the axes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RoomProof {
    pub(super) origin: [I16F16; 3],
    pub(super) room: Room,
}

impl RoomProof {
    /// The room that these spheres are, if they are one.
    pub(super) fn of(hollow: &[SphereRecord]) -> Option<Self> {
        let origin = [0, 1, 2].map(|axis| most_common(hollow.iter().map(|sphere| sphere.centre[axis])));
        let balls = (0..).zip(hollow).map(|(index, sphere)| {
            let centre = |i: usize| sphere.centre[i].checked_sub(origin[i]);
            Some(Ball {
                primitive: PrimitiveId::new(index),
                centre: [centre(0)?, centre(1)?, centre(2)?],
                radius: sphere.radius,
                material: sphere.material,
                has_inside: sphere.has_inside != 0,
            })
        });
        let balls: Vec<Ball> = balls.collect::<Option<_>>()?;
        let room = room(&balls)?;
        Some(Self { origin, room })
    }
}

/// A sphere as it lies around the room's origin.
#[derive(Clone, Copy, Debug)]
struct Ball {
    primitive: PrimitiveId,
    centre: [I16F16; 3],
    radius: I16F16,
    material: MaterialId,
    has_inside: bool,
}

impl Ball {
    /// Whether all of a box lies within it, and not next to its surface. A ball is convex: its corners tell.
    fn holds(&self, low: [f64; 3], high: [f64; 3]) -> bool {
        let furthest = |i: usize| {
            let centre = self.centre[i].to_num::<f64>();
            (low[i] - centre).abs().max((high[i] - centre).abs())
        };
        let square: f64 = (0..3).map(|i| furthest(i) * furthest(i)).sum();
        square.sqrt() <= self.radius.to_num::<f64>() - MARGIN
    }

    /// The axis that its centre alone lies on, and which of the axis' two walls it is.
    fn place(&self) -> Option<(usize, usize)> {
        let mut axes = (0..3).filter(|&i| self.centre[i] != I16F16::ZERO);
        let axis = axes.next()?;
        axes.next()
            .is_none()
            .then_some((axis, usize::from(self.centre[axis] > I16F16::ZERO)))
    }

    /// Where its surface crosses an axis next to the room.
    fn plane(&self, axis: usize) -> Option<I16F16> {
        let centre = self.centre[axis];
        if centre > I16F16::ZERO {
            centre.checked_sub(self.radius)
        } else {
            centre.checked_add(self.radius)
        }
    }

    /// How far its surface bends into the room, where it is no further from the axis than this.
    fn sag(&self, from_axis_squared: f64) -> f64 {
        let radius = self.radius.to_num::<f64>();
        radius - (radius * radius - from_axis_squared).sqrt()
    }
}

fn most_common(values: impl Iterator<Item = I16F16> + Clone) -> I16F16 {
    let count = |value: I16F16| values.clone().filter(|&other| other == value).count();
    values
        .clone()
        .max_by_key(|&value| count(value))
        .unwrap_or_default()
}

/// A pair for each axis: what is in positive direction, then what is in negative direction.
type Sides<T> = [[T; 2]; 3];

/// Makes such pairs, if every one of them can be made.
fn sides<T: Copy>(mut of: impl FnMut(usize, usize) -> Option<T>) -> Option<Sides<T>> {
    let mut pair = |axis| Some([of(axis, 0)?, of(axis, 1)?]);
    Some([pair(0)?, pair(1)?, pair(2)?])
}

fn room(balls: &[Ball]) -> Option<Room> {
    let walls = sides(|axis, side| nearest(balls, axis, side))?;
    let planes = sides(|axis, side| walls[axis][side].plane(axis))?;
    let outer = planes.map(|pair| pair.map(I16F16::to_num::<f64>));
    let sags = sides(|axis, side| {
        let across = (0..3).filter(|&other| other != axis);
        let reach = across.map(|other| outer[other][0].powi(2).max(outer[other][1].powi(2)));
        Some(walls[axis][side].sag(reach.sum()))
    })?;
    // What lies within all walls, wherever it lies along them.
    let inner = [0, 1, 2].map(|axis| {
        [
            outer[axis][0] - sags[axis][0] - MARGIN,
            outer[axis][1] + sags[axis][1] + MARGIN,
        ]
    });
    let is_worth_it = |axis: usize| {
        let (width, all) = (inner[axis][0] - inner[axis][1], outer[axis][0] - outer[axis][1]);
        // Not a number where a wall does not reach across the room.
        all > 0.0 && width >= WORTH * all
    };
    if !(0..3).all(is_worth_it) {
        return None;
    }
    let walls = sides(|axis, side| {
        let (mut low, mut high) = (inner.map(|range| range[1]), inner.map(|range| range[0]));
        let (plane, sag) = (outer[axis][side], sags[axis][side] + MARGIN);
        (low[axis], high[axis]) = if side == 0 {
            (plane - sag, plane + MARGIN)
        } else {
            (plane - MARGIN, plane + sag)
        };
        let ball = &walls[axis][side];
        let mut others = balls.iter().filter(|other| other.primitive != ball.primitive);
        others
            .all(|other| other.holds(low, high))
            .then(|| wall(ball, axis, low, high))?
    })?;
    Some(Room { planes, walls })
}

/// The sphere whose surface is nearest on one side of an axis.
fn nearest(balls: &[Ball], axis: usize, side: usize) -> Option<Ball> {
    let there = balls.iter().filter(|ball| ball.place() == Some((axis, side)));
    there
        .min_by_key(|ball| ball.plane(axis).map(I16F16::abs))
        .copied()
}

fn wall(ball: &Ball, axis: usize, low: [f64; 3], high: [f64; 3]) -> Option<Wall> {
    let fits = |value: f64| I16F16::checked_from_num(value);
    let all = |v: [f64; 3]| Some([fits(v[0])?, fits(v[1])?, fits(v[2])?]);
    let square = |value: I16F16| i64::from(value.to_bits()) * i64::from(value.to_bits());
    Some(Wall {
        centre: ball.centre,
        place: ball.centre[axis],
        primitive: ball.primitive,
        twice_back: ball.centre[axis].checked_mul_int(-2)?,
        power: I32F32::from_bits(square(ball.radius) - square(ball.centre[axis])),
        low: all(low)?,
        extent: all([0, 1, 2].map(|i| high[i] - low[i]))?,
        reciprocal: if ball.radius >= FLAT && !ball.has_inside {
            ((1i64 << 60) / i64::from(ball.radius.to_bits())).min(i32::MAX.into()) as i32
        } else {
            0
        },
        unused: 0,
        material: ball.material,
    })
}
