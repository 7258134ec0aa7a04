//! Where a ray meets a sphere, decided in integers.
//!
//! Lengths are in ulp of 16:16, directions in units of 2^-30, as cores have them. A direction is not quite of unit length; the ray is
//! the half-line along it, and distances are true ones. With `d` the direction, `v` from the start to the centre and `b = v . d`,
//! the roots are `(b -+ sqrt(b^2 - d^2 (v^2 - r^2))) / |d|`. All below the root is a whole number, so whether there is one, and on which
//! side of the start, is exact.

/// A sphere: centre and radius in ulp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sphere {
    pub(super) centre: [i64; 3],
    pub(super) radius: i64,
}

/// A half-line: start in ulp, direction in 2^-30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    pub(super) start: [i64; 3],
    pub(super) direction: [i64; 3],
}

/// A line against a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Meeting {
    /// `v . d`.
    b: i128,
    /// The radicand: the discriminant times d^2.
    radicand: i128,
    /// `r^2 - v^2`: positive where the line starts within.
    pub(super) power: i128,
    /// d^2.
    square: i128,
}

/// One of the two roots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Root {
    meeting: Meeting,
    far: bool,
}

/// Longer vectors, in ulp, are not taken: 131,072 units. Then b^2 and d^2 (v^2 - r^2) are each below 2^126, and their difference fits.
const LONGEST: i64 = 1 << 33;

fn dot(a: [i64; 3], b: [i64; 3]) -> i128 {
    (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum()
}

impl Meeting {
    /// # Panics
    /// If centre and start are 131,072 units apart or more, or the radius is that long.
    pub(super) fn of(line: &Line, sphere: &Sphere) -> Self {
        let to_centre = [0, 1, 2].map(|i| sphere.centre[i] - line.start[i]);
        let longest = i128::from(LONGEST) * i128::from(LONGEST);
        let distance = dot(to_centre, to_centre);
        assert!(
            distance < longest && sphere.radius < LONGEST,
            "beyond the reach of 128 bits"
        );
        let b = dot(to_centre, line.direction);
        let square = dot(line.direction, line.direction);
        let power = i128::from(sphere.radius) * i128::from(sphere.radius) - distance;
        Self {
            b,
            radicand: b * b + square * power,
            power,
            square,
        }
    }

    /// Whether the line through the half-line meets or touches the sphere.
    pub(super) fn is_met(&self) -> bool {
        self.radicand >= 0
    }

    /// Whether the centre lies ahead.
    pub(super) fn is_ahead(&self) -> bool {
        self.b > 0
    }

    /// The root nearer to where the line comes from.
    pub(super) fn near(self) -> Root {
        Root {
            meeting: self,
            far: false,
        }
    }

    /// The other.
    pub(super) fn far(self) -> Root {
        Root {
            meeting: self,
            far: true,
        }
    }

    /// The chord that starts here, in ulp, for a start that stands for a point of the surface.
    pub(super) fn chord(&self) -> f64 {
        2.0 * self.b as f64 / (self.square as f64).sqrt()
    }
}

impl Root {
    /// How far along the line, in ulp, within 2^-18 of an ulp. The sphere is met.
    pub(super) fn distance(&self) -> f64 {
        let Meeting {
            b, radicand, square, ..
        } = self.meeting;
        let root = (radicand as f64).sqrt();
        let sum = if self.far {
            b as f64 + root
        } else {
            b as f64 - root
        };
        sum / (square as f64).sqrt()
    }
}
