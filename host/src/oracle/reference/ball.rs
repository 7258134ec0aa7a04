//! Where rays meet balls, and the inside of balls.
//!
//! No distance is too small to be a hit: the surface that a ray leaves is known by its number, and of its two crossings the one
//! at the ray's start is left out. So there is no epsilon, and no unit of length: were all lengths doubled, every number here would
//! be the double or the same, to the bit.

use super::vector::Vector;

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

    /// The first crossing in front of a ray that starts elsewhere.
    fn entry_or_exit(&self, ray: &Ray) -> Option<f64> {
        let [one, other] = self.crossings(ray.origin, ray.direction)?;
        Some(if one > 0.0 { one } else { other })
    }

    /// The surface's normal at `point`, outward.
    pub(super) fn outward(&self, point: Vector) -> Vector {
        (point - self.centre).normalised()
    }
}

/// A point of a surface.
pub(super) struct Hit {
    /// Whose surface.
    pub(super) ball: usize,
    pub(super) point: Vector,
    pub(super) outward: Vector,
}

/// The first surface that `ray` meets.
pub(super) fn first_hit(balls: &[Ball], ray: &Ray) -> Option<Hit> {
    let mut nearest = f64::INFINITY;
    let mut which = None;
    for (index, ball) in balls.iter().enumerate() {
        let distance = if ray.departed == Some(index) {
            Some(ball.chord(ray))
        } else {
            ball.entry_or_exit(ray)
        };
        if let Some(distance) = distance.filter(|&distance| distance > 0.0 && distance < nearest) {
            nearest = distance;
            which = Some(index);
        }
    }
    let index = which?;
    let ball = &balls[index];
    let outward = ball.outward(ray.origin + ray.direction * nearest);
    Some(Hit {
        ball: index,
        // Nearer to the surface than where the ray has got to, after its rounding.
        point: ball.centre + outward * ball.radius,
        outward,
    })
}
