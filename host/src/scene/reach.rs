//! Where rays start, and how far they go.

use super::vector::{dot, length, sub};
use super::{Camera, Material, Sphere};

/// How far from the centre of a hollow sphere a ray may start, in a core's unit; of any other, twice as far. It is a third of the
/// 16:16 range, so that no sum of distances and projections leaves it and no sum of squares leaves 32:32 (see
/// `tracer::geometry::sphere::SphereNumbers`). Hollow and glass spheres, which are crossed from side to side, have smaller radii.
pub(crate) const REACH: f64 = 10922.0;

/// How far from its centre a ray may start.
pub(super) fn reach(sphere: &Sphere) -> f64 {
    if sphere.hollow { REACH } else { 2.0 * REACH }
}

/// A bound on where rays start.
pub(super) struct Extent<'s> {
    spheres: &'s [&'s Sphere],
    camera: &'s Camera,
    vast_from: f64,
    /// The middle of it.
    pub(super) middle: [f64; 3],
    /// How far from there a ray may start.
    pub(super) radius: f64,
    /// How far it may if it starts on nothing vast.
    near_radius: f64,
    /// Where nothing encloses the scene: vast spheres by their places, and how far from the middle rays start on them.
    caps: Vec<(usize, f64)>,
    /// The sphere that makes it so wide, if one does.
    pub(super) widest: Option<usize>,
}

impl<'s> Extent<'s> {
    /// Of a scene whose spheres from this radius on are vast.
    pub(super) fn of(spheres: &'s [&'s Sphere], camera: &'s Camera, vast_from: f64) -> Self {
        let mut extent = Self {
            spheres,
            camera,
            vast_from,
            middle: [0.0; 3],
            radius: 0.0,
            near_radius: 0.0,
            caps: Vec::new(),
            widest: None,
        };
        if extent.is_enclosed() {
            extent.enclosed();
        } else {
            extent.open();
        }
        extent
    }

    /// Whether it is a room: within hollow spheres.
    pub(super) fn is_enclosed(&self) -> bool {
        self.spheres.iter().any(|sphere| sphere.hollow)
    }

    /// In a room, what all hollow spheres have in common: around the middle of their boxes, or the smallest one's centre.
    fn enclosed(&mut self) {
        let (low, high) = self.common_box();
        let middle = [0, 1, 2].map(|i| f64::midpoint(low[i], high[i]));
        let hollow = (0..self.spheres.len()).filter(|&index| self.spheres[index].hollow);
        self.widest = hollow.min_by(|&a, &b| self.spheres[a].radius.total_cmp(&self.spheres[b].radius));
        let centre = self
            .widest
            .map_or(middle, |smallest| self.spheres[smallest].centre);
        let around = |point| (self.farthest_start(point), point);
        let (from_middle, from_centre) = (around(middle), around(centre));
        (self.radius, self.middle) = if from_centre.0 <= from_middle.0 {
            from_centre
        } else {
            from_middle
        };
    }

    /// Elsewhere, the camera and all that scatters light; and of what is vast, as far as it can be seen.
    fn open(&mut self) {
        let small = self
            .scattering()
            .filter(|(_, sphere)| sphere.radius < self.vast_from);
        let small: Vec<(usize, &Sphere)> = small.collect();
        let (mut low, mut high) = (self.camera.position, self.camera.position);
        for (_, sphere) in &small {
            low = [0, 1, 2].map(|i| low[i].min(sphere.centre[i] - sphere.radius));
            high = [0, 1, 2].map(|i| high[i].max(sphere.centre[i] + sphere.radius));
        }
        self.middle = [0, 1, 2].map(|i| f64::midpoint(low[i], high[i]));
        self.radius = self.camera_reach(self.middle);
        for (index, sphere) in small {
            self.widen(far_side(self.middle, sphere), index);
        }
        self.near_radius = self.radius;
        // A surface that is seen is a start from which others are seen.
        for _ in 0..self.spheres.len() {
            let vast = self
                .scattering()
                .filter(|(_, sphere)| sphere.radius >= self.vast_from);
            let caps: Vec<(usize, f64)> = vast
                .map(|(index, sphere)| {
                    let seen = self
                        .starts(index)
                        .map(|(radius, height)| radius + horizon(sphere, height));
                    let seen = seen.fold(0.0, f64::max);
                    (index, seen.min(far_side(self.middle, sphere)))
                })
                .collect();
            if caps == self.caps {
                break;
            }
            for &(index, radius) in &caps {
                self.widen(radius, index);
            }
            self.caps = caps;
        }
    }

    /// Starts of rays that may see a vast sphere: how far from the middle they are, and how far above it.
    fn starts(&self, index: usize) -> impl Iterator<Item = (f64, f64)> {
        let sphere = self.spheres[index];
        let above = length(sub(self.middle, sphere.centre)) - sphere.radius;
        let caps = self.caps.iter().filter(move |(other, _)| *other != index);
        let caps = caps
            .map(move |&(other, radius)| (radius, self.highest_of_cap(self.spheres[other], radius, sphere)));
        std::iter::once((self.near_radius, above + self.near_radius)).chain(caps)
    }

    /// How far above `sphere` a point of another one's surface is at most that is no further than `radius` from the middle.
    fn highest_of_cap(&self, of: &Sphere, radius: f64, sphere: &Sphere) -> f64 {
        let to_middle = sub(self.middle, of.centre);
        let distance = length(to_middle);
        // The cosine law, for the angle at the centre between the middle and the cap's rim.
        let height = distance - of.radius;
        let half_sine = ((radius * radius - height * height) / (4.0 * of.radius * distance)).sqrt();
        // Not a number where the sphere does not come that near.
        let rim = 2.0 * half_sine.min(1.0).asin();
        let away = sub(of.centre, sphere.centre);
        let apart = length(away);
        let between = (dot(to_middle, away) / (distance * apart))
            .clamp(-1.0, 1.0)
            .acos();
        let cosine = if between > rim { (between - rim).cos() } else { 1.0 };
        let square = apart * apart + of.radius * of.radius + 2.0 * of.radius * apart * cosine;
        square.sqrt() - sphere.radius
    }

    fn widen(&mut self, radius: f64, by: usize) {
        if radius > self.radius {
            (self.radius, self.widest) = (radius, Some(by));
        }
    }

    fn scattering(&self) -> impl Iterator<Item = (usize, &'s Sphere)> {
        let spheres = self.spheres.iter().copied().enumerate();
        spheres.filter(|(_, sphere)| sphere.scatters())
    }

    fn camera_reach(&self, point: [f64; 3]) -> f64 {
        length(sub(point, self.camera.position)) + self.camera.near
    }

    /// How far from its start a ray may meet a vast sphere.
    pub(super) fn horizon(&self, index: usize) -> f64 {
        if self.is_enclosed() {
            return 2.0 * self.radius;
        }
        let seen = self
            .starts(index)
            .map(|(_, height)| horizon(self.spheres[index], height));
        seen.fold(0.0, f64::max)
    }

    /// The greatest distance from `point` to where a ray can start, or a bound on it.
    pub(super) fn farthest_start(&self, point: [f64; 3]) -> f64 {
        if !self.is_enclosed() {
            if self.vast_from < f64::INFINITY {
                return length(sub(point, self.middle)) + self.radius;
            }
            let sides = self.scattering().map(|(_, sphere)| far_side(point, sphere));
            return sides.fold(self.camera_reach(point), f64::max);
        }
        // Two bounds: each room's far side, and the corners of the box that all of them have in common.
        let hollow = self.spheres.iter().filter(|sphere| sphere.hollow);
        let nearest = hollow
            .map(|sphere| far_side(point, sphere))
            .fold(f64::INFINITY, f64::min);
        let (low, high) = self.common_box();
        let corner = [0, 1, 2].map(|i| (point[i] - low[i]).abs().max((point[i] - high[i]).abs()));
        nearest.min(length(corner))
    }

    /// The box that all hollow spheres have in common.
    fn common_box(&self) -> ([f64; 3], [f64; 3]) {
        let (mut low, mut high) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        for room in self.spheres.iter().filter(|sphere| sphere.hollow) {
            low = [0, 1, 2].map(|i| low[i].max(room.centre[i] - room.radius));
            high = [0, 1, 2].map(|i| high[i].min(room.centre[i] + room.radius));
        }
        (low, high)
    }
}

/// How far away a solid sphere's surface is seen from a height above it: the tangent's length.
fn horizon(sphere: &Sphere, height: f64) -> f64 {
    let height = height.max(0.0);
    (height * (height + 2.0 * sphere.radius)).sqrt()
}

fn far_side(point: [f64; 3], sphere: &Sphere) -> f64 {
    length(sub(point, sphere.centre)) + sphere.radius
}

impl Sphere {
    /// Whether light goes on from its surface.
    pub(super) fn scatters(&self) -> bool {
        let (Material::Diffuse(colour) | Material::Mirror(colour) | Material::Glass { tint: colour, .. }) =
            self.material;
        colour != [0.0; 3]
    }

    /// Whether rays go through it from side to side.
    pub(super) fn is_crossed(&self) -> bool {
        self.hollow || matches!(self.material, Material::Glass { .. })
    }
}
