//! What numbers in a scene may be, and what to say about those that may not.

use std::ops::RangeInclusive;

use super::{MAX_EMISSION, MAX_INDEX, MAX_LENGTH, MAX_REFLECTANCE, MIN_RADIUS};

/// What a number may be, and what to say when it is not.
pub(super) struct Limits {
    range: RangeInclusive<f64>,
    /// Why it may not be below the range.
    below: &'static str,
    /// Why it may not be above.
    above: &'static str,
    /// For the message about a missing key.
    pub(super) example: &'static str,
}

impl Limits {
    /// Why `number` will not do.
    pub(super) fn cause(&self, number: f64) -> Option<String> {
        let (min, max) = (self.range.start(), self.range.end());
        if number.is_nan() {
            Some("is not a number; write a finite one".to_owned())
        } else if number < *min {
            Some(format!("{number} is below {min}; {}", self.below))
        } else if number > *max {
            Some(format!("{number} exceeds {max}; {}", self.above))
        } else {
            None
        }
    }
}

pub(super) const COORDINATE: Limits = Limits {
    range: -MAX_LENGTH..=MAX_LENGTH,
    below: "no scene is that large: use a longer unit of length",
    above: "no scene is that large: use a longer unit of length",
    example: "three numbers",
};
pub(super) const RADIUS: Limits = Limits {
    range: MIN_RADIUS..=MAX_LENGTH,
    below: "a radius is positive, and no ball is that small: use a shorter unit of length",
    above: "no scene is that large: use a longer unit of length",
    example: "e.g. `radius = 16.5`",
};
pub(super) const EMISSION: Limits = Limits {
    range: 0.0..=MAX_EMISSION,
    below: "light cannot be negative: use 0 for none",
    above: "a work unit's sums would overflow: dim every light alike",
    example: "e.g. `emission = [12, 12, 12]`",
};
pub(super) const REFLECTANCE: Limits = Limits {
    range: 0.0..=MAX_REFLECTANCE,
    below: "a surface cannot reflect less than nothing: use 0",
    above: "a surface must absorb a little, or paths never end: use at most 0.999",
    example: "three reflectances",
};
pub(super) const INDEX: Limits = Limits {
    range: MIN_INDEX..=MAX_INDEX,
    below: "glass is denser than air: use e.g. 1.5",
    above: "no clear material is that dense: use e.g. 1.5",
    example: "e.g. `index = 1.5`",
};
pub(super) const PLANE_HEIGHT: Limits = Limits {
    range: 1.0 / 256.0..=16.0,
    below: "the view would be narrower than 16:16 resolves",
    above: "the view would be wider than 165 degrees: use e.g. 0.5135",
    example: "e.g. `plane_height = 0.5135` (the image plane's height at distance 1)",
};
pub(super) const PLANE_WIDTH: Limits = Limits {
    range: 1.0 / 256.0..=16.0,
    below: "the view would be narrower than 16:16 resolves",
    above: "the view would be wider than 165 degrees: use e.g. 0.72, or leave it out",
    example: "e.g. `plane_width = 0.72` (the most that the image plane is wide at distance 1)",
};
pub(super) const NEAR: Limits = Limits {
    range: 0.0..=MAX_LENGTH,
    below: "rays cannot start behind the camera: use 0",
    above: "no scene is that large: move the camera instead",
    example: "e.g. `near = 140`",
};
/// An index of exactly 1 bends nothing and would only cost time.
const MIN_INDEX: f64 = 1.0 + 1.0 / 1024.0;
