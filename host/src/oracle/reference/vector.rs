//! Vectors of three numbers.

use std::ops::{Add, Mul, Sub};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

impl Vector {
    pub(super) const fn of([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }

    pub(super) fn components(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    pub(super) fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The product component by component.
    pub(super) fn times(self, other: Self) -> Self {
        Self {
            x: self.x * other.x,
            y: self.y * other.y,
            z: self.z * other.z,
        }
    }

    pub(super) fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub(super) fn normalised(self) -> Self {
        self * (1.0 / self.length())
    }

    /// Two unit vectors that are perpendicular to this one, itself a unit vector, and to each other.
    pub(super) fn tangents(self) -> [Self; 2] {
        // Duff and others, "Building an Orthonormal Basis, Revisited", 2017.
        let sign = 1.0f64.copysign(self.z);
        let a = -1.0 / (sign + self.z);
        let b = self.x * self.y * a;
        [
            Self::of([1.0 + sign * self.x * self.x * a, sign * b, -sign * self.x]),
            Self::of([b, sign + self.y * self.y * a, -self.y]),
        ]
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

impl Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}
