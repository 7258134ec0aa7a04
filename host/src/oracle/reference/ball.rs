//! Where rays meet balls, and the inside of balls.
//!
//! No distance is too small to be a hit: the surface that a ray leaves is known by its number, and of its two crossings the one
//! at the ray's start is left out. So there is no epsilon, and no unit of length: were all lengths doubled, every number here would
//! be the double or the same, to the bit.

use pulp::{Arch, Simd, WithSimd};

use super::vector::Vector;

/// Balls that a ray is held against side by side: what a compiler makes vector instructions of.
const LANES: usize = 4;

#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Vector,
    /// A unit vector.
    pub(super) direction: Vector,
    /// The ball whose surface it starts on.
    pub(super) departed: Option<usize>,
}

#[derive(Clone, Copy)]
pub(super) struct Ball {
    pub(super) centre: Vector,
    pub(super) radius: f64,
}

impl Ball {
    /// How far along the line it is crossed, from nearer minus to nearer plus infinity; `None` if it is missed.
    ///
    /// The discriminant is taken from the distance between centre and line, where the textbook's is the difference of two large
    /// squares; and the crossing that would be a difference of nearly equal numbers follows from the other one and the product of both (Vieta).
    pub(super) fn crossings(&self, origin: Vector, direction: Vector) -> Option<[f64; 2]> {
        let to_centre = self.centre - origin;
        let along = to_centre.dot(direction);
        let aside = to_centre - direction * along;
        let square = self.radius * self.radius - aside.dot(aside);
        if square < 0.0 {
            return None;
        }
        let half_chord = square.sqrt();
        let product = to_centre.dot(to_centre) - self.radius * self.radius;
        Some(if along > 0.0 {
            let far = along + half_chord;
            [product / far, far]
        } else {
            let far = along - half_chord;
            [far, product / far]
        })
    }

    /// How far a ray from its own surface goes inside until it meets it again.
    fn chord(&self, ray: &Ray) -> f64 {
        2.0 * (self.centre - ray.origin).dot(ray.direction)
    }
}

/// A point of a surface.
pub(super) struct Hit {
    /// Whose surface.
    pub(super) ball: usize,
    pub(super) point: Vector,
    pub(super) outward: Vector,
}

/// All balls of a scene.
pub(super) struct Balls {
    /// What vector instructions this machine has; they round as others do, so that it changes nothing but the time.
    instructions: Arch,
    balls: Vec<Ball>,
    groups: Vec<Group>,
}

/// Some balls, number by number; where there are fewer than [`LANES`], the rest has no number for a radius and is never met.
#[derive(Clone, Copy)]
struct Group {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
    radius: [f64; LANES],
}

impl Balls {
    pub(super) fn new(balls: Vec<Ball>) -> Self {
        let groups = balls.chunks(LANES).map(|chunk| {
            let lane = |number: fn(&Ball) -> f64| {
                std::array::from_fn(|lane| chunk.get(lane).map_or(f64::NAN, number))
            };
            Group {
                x: lane(|ball| ball.centre.x),
                y: lane(|ball| ball.centre.y),
                z: lane(|ball| ball.centre.z),
                radius: lane(|ball| ball.radius),
            }
        });
        Self {
            instructions: Arch::new(),
            groups: groups.collect(),
            balls,
        }
    }

    /// The number of the first ball that `ray` meets, and how far away.
    #[inline]
    pub(super) fn nearest(&self, ray: &Ray) -> Option<(usize, f64)> {
        self.instructions.dispatch(Nearest { balls: self, ray })
    }

    /// The surface of this ball, if `ray` starts outside of it and never comes in: where that is nearest.
    pub(super) fn beyond(&self, number: usize, ray: &Ray) -> Option<Hit> {
        let ball = self.balls[number];
        let from_centre = ray.origin - ball.centre;
        let is_outside = from_centre.dot(from_centre) > ball.radius * ball.radius;
        (is_outside && from_centre.dot(ray.direction) >= 0.0).then(|| {
            let outward = from_centre.normalised();
            Hit {
                ball: number,
                point: ball.centre + outward * ball.radius,
                outward,
            }
        })
    }

    /// The first surface that `ray` meets.
    #[inline]
    pub(super) fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let (number, distance) = self.nearest(ray)?;
        let ball = &self.balls[number];
        let outward = (ray.origin + ray.direction * distance - ball.centre).normalised();
        Some(Hit {
            ball: number,
            // Nearer to the surface than where the ray has got to, after its rounding.
            point: ball.centre + outward * ball.radius,
            outward,
        })
    }
}

/// [`Balls::nearest`], by what instructions there are.
struct Nearest<'a> {
    balls: &'a Balls,
    ray: &'a Ray,
}

impl WithSimd for Nearest<'_> {
    type Output = Option<(usize, f64)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _instructions: S) -> Self::Output {
        let Self { balls, ray } = self;
        let departed = ray.departed.unwrap_or(usize::MAX);
        let mut nearest = [f64::INFINITY; LANES];
        let mut which = [u64::MAX; LANES];
        for (number, group) in balls.groups.iter().enumerate() {
            let mut distances = group.distances(ray);
            if departed / LANES == number {
                distances[departed % LANES] = balls.balls[departed].chord(ray);
            }
            for lane in 0..LANES {
                let closer = distances[lane] > 0.0 && distances[lane] < nearest[lane];
                nearest[lane] = if closer { distances[lane] } else { nearest[lane] };
                which[lane] = if closer { number as u64 } else { which[lane] };
            }
        }
        let mut first = 0;
        for lane in 1..LANES {
            if nearest[lane] < nearest[first] {
                first = lane;
            }
        }
        (nearest[first] < f64::INFINITY).then(|| (which[first] as usize * LANES + first, nearest[first]))
    }
}

impl Group {
    /// How far away a ray from elsewhere first meets each: nothing above 0 if it does not. [`Ball::crossings`] says by what formulas.
    #[inline(always)]
    fn distances(&self, ray: &Ray) -> [f64; LANES] {
        let (origin, direction) = (ray.origin, ray.direction);
        std::array::from_fn(|lane| {
            let to_centre = [
                self.x[lane] - origin.x,
                self.y[lane] - origin.y,
                self.z[lane] - origin.z,
            ];
            let square = self.radius[lane] * self.radius[lane];
            let along = to_centre[0] * direction.x + to_centre[1] * direction.y + to_centre[2] * direction.z;
            let aside = [
                to_centre[0] - direction.x * along,
                to_centre[1] - direction.y * along,
                to_centre[2] - direction.z * along,
            ];
            // No number where the line misses it, and so is all that comes of it.
            let half_chord =
                (square - (aside[0] * aside[0] + aside[1] * aside[1] + aside[2] * aside[2])).sqrt();
            let far = along + half_chord.copysign(along);
            let product =
                to_centre[0] * to_centre[0] + to_centre[1] * to_centre[1] + to_centre[2] * to_centre[2]
                    - square;
            let near = product / far;
            if near > 0.0 { near } else { far }
        })
    }
}
