//! Where a ray meets a vast sphere, in double precision: lengths of up to 2^31 ulp within 2^-20 of one.

use tracer::geometry::sphere::VastSphere;

use super::draw::{combine, dot, ulps};
use super::exact::Line;

/// A line above a vast sphere, or below. What the words mean is said where the tracer has them: `tracer::geometry::sphere::VastSphere`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    /// In ulp.
    pub(super) height: f64,
    pub(super) slope: f64,
    /// One over the radius in ulp, positive where it is hollow.
    curvature: f64,
    /// The gradient of the height: at the surface, the unit normal to the side that rays are on.
    upward: [f64; 3],
    direction: [f64; 3],
}

fn scaled_to_one(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

impl Bent {
    pub(super) fn of(vast: &VastSphere, line: &Line) -> Self {
        let normal = scaled_to_one(vast.normal.map(f64::from));
        let pole = ulps(vast.pole);
        let above = [0, 1, 2].map(|i| (line.start[i] - pole[i]) as f64);
        let direction = scaled_to_one(line.direction.map(|c| c as f64));
        let curvature = f64::from(vast.bend.curvature) * 2f64.powi(-44 - 16);
        let upward = combine(1.0, normal, -curvature, above);
        Self {
            height: dot(normal, above) - curvature / 2.0 * dot(above, above),
            slope: dot(direction, upward),
            curvature,
            upward,
            direction,
        }
    }

    /// The slope's square where the line crosses the surface; below 0 where it does not.
    fn steepness(&self) -> f64 {
        self.slope * self.slope + 2.0 * self.curvature * self.height
    }

    /// How far along a line that starts above goes under, in ulp.
    pub(super) fn goes_under(&self) -> Option<f64> {
        let square = self.steepness();
        if square < 0.0 || self.slope > 0.0 && self.curvature < 0.0 {
            return None;
        }
        Some(if self.slope > 0.0 {
            (self.slope + square.sqrt()) / self.curvature
        } else {
            2.0 * self.height / (square.sqrt() - self.slope)
        })
    }

    /// How deep under the surface the line leads, in ulp.
    pub(super) fn depth(&self) -> f64 {
        self.steepness() / (2.0 * self.curvature.abs())
    }

    /// The other end of the chord of a line that starts on the surface, in ulp.
    pub(super) fn chord(&self) -> f64 {
        2.0 * self.slope / self.curvature
    }

    /// In ulp.
    pub(super) fn radius(&self) -> f64 {
        self.curvature.recip().abs()
    }

    /// The point of the line so far along, in ulp.
    pub(super) fn point_at(&self, line: &Line, distance: f64) -> [f64; 3] {
        combine(1.0, line.start.map(|c| c as f64), distance, self.direction)
    }

    /// The unit normal on the rays' side, so far along.
    pub(super) fn normal_at(&self, distance: f64) -> [f64; 3] {
        scaled_to_one(combine(
            1.0,
            self.upward,
            -self.curvature * distance,
            self.direction,
        ))
    }
}
