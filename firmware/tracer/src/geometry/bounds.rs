//! Axis-aligned boxes.

use fixedmath::I16F16;

/// An axis-aligned box in 16:16. What reaches beyond the format is cut to it, and with it the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// The corner of least coordinates.
    pub low: [I16F16; 3],
    /// The corner of greatest coordinates.
    pub high: [I16F16; 3],
}

impl Bounds {
    /// The box of half-width `radius` around `centre`.
    pub fn around(centre: [I16F16; 3], radius: I16F16) -> Self {
        Self {
            low: centre.map(|c| c.saturating_sub(radius)),
            high: centre.map(|c| c.saturating_add(radius)),
        }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: [0, 1, 2].map(|i| self.low[i].min(other.low[i])),
            high: [0, 1, 2].map(|i| self.high[i].max(other.high[i])),
        }
    }

    /// Whether a point lies in it or on its surface.
    pub fn contains(&self, point: [I16F16; 3]) -> bool {
        (0..3).all(|i| (self.low[i]..=self.high[i]).contains(&point[i]))
    }
}
