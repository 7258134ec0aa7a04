//! Where camera rays start: a patch of the sphere of radius `near` round the pinhole, as the film's pyramid cuts it out.

use super::Camera;
use super::vector::{cross, dot, length, normalised, scaled, sub};

/// The patch for one shape of picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct StartPatch {
    pinhole: [f64; 3],
    near: f64,
    forward: [f64; 3],
    /// Half the film's width and height as vectors, at distance 1.
    half: [[f64; 3]; 2],
    /// Unit vectors to the film's corners, in order round it.
    corners: [[f64; 3]; 4],
}

impl StartPatch {
    /// The patch of a picture of `width` by `height` pixels, its film enlarged by `margin` pixels on each side.
    pub(super) fn new(camera: &Camera, width: u16, height: u16, margin: f64) -> Self {
        let half_height = camera.height_for(width, height) / 2.0;
        let (width, height) = (f64::from(width), f64::from(height));
        let right = normalised(cross(camera.direction, camera.up));
        let up = cross(right, camera.direction);
        let half_width = half_height * width / height;
        let half = [
            scaled(right, half_width * (1.0 + 2.0 * margin / width)),
            scaled(up, half_height * (1.0 + 2.0 * margin / height)),
        ];
        let corner = |x: f64, y: f64| {
            normalised([0, 1, 2].map(|i| camera.direction[i] + x * half[0][i] + y * half[1][i]))
        };
        Self {
            pinhole: camera.position,
            near: camera.near,
            forward: camera.direction,
            half,
            corners: [
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ],
        }
    }

    /// The start nearest to `point`, and the one furthest from it: the distance, and the place in the picture.
    pub(super) fn nearest_and_furthest(&self, point: [f64; 3]) -> [(f64, &'static str); 2] {
        let away = sub(self.pinhole, point);
        [scaled(away, -1.0), away].map(|towards| {
            let ray = self.most_along(towards);
            let start = [0, 1, 2].map(|i| away[i] + self.near * ray[i]);
            (length(start), self.place(ray))
        })
    }

    /// The direction within the pyramid that has the largest product with `v`.
    fn most_along(&self, v: [f64; 3]) -> [f64; 3] {
        let edges = [0, 1, 2, 3].map(|i| (self.corners[i], self.corners[(i + 1) % 4]));
        let inside = |(from, to)| {
            let normal = cross(from, to);
            dot(v, normal) * dot(self.forward, normal) >= 0.0
        };
        if length(v) > 0.0 && dot(v, self.forward) > 0.0 && edges.into_iter().all(inside) {
            return normalised(v);
        }
        let on_edges = edges.into_iter().filter_map(|(from, to)| within_arc(v, from, to));
        let better = |best: [f64; 3], ray: [f64; 3]| if dot(v, ray) > dot(v, best) { ray } else { best };
        self.corners
            .into_iter()
            .chain(on_edges)
            .fold(self.corners[0], better)
    }

    /// In words, where in the picture a ray is: by thirds of its width and height.
    fn place(&self, ray: [f64; 3]) -> &'static str {
        let depth = dot(ray, self.forward);
        let third = |half: [f64; 3]| {
            let at = dot(ray, half) / depth / dot(half, half);
            usize::from(at > -1.0 / 3.0) + usize::from(at > 1.0 / 3.0)
        };
        const PLACES: [[&str; 3]; 3] = [
            ["bottom left", "bottom", "bottom right"],
            ["left", "middle", "right"],
            ["top left", "top", "top right"],
        ];
        PLACES[third(self.half[1])][third(self.half[0])]
    }
}

/// The direction of the great circle through `from` and `to` that is nearest to `v`, if it lies between the two.
fn within_arc(v: [f64; 3], from: [f64; 3], to: [f64; 3]) -> Option<[f64; 3]> {
    let normal = normalised(cross(from, to));
    let height = dot(v, normal);
    let flat = [0, 1, 2].map(|i| v[i] - height * normal[i]);
    let between = dot(cross(from, flat), normal) > 0.0 && dot(cross(flat, to), normal) > 0.0;
    between.then(|| normalised(flat))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against a look at many rays: none starts nearer or further, and some come close.
        #[test]
        fn no_start_is_beyond_the_two(
            direction in prop::array::uniform3(-1.0..1.0f64),
            point in prop::array::uniform3(-30.0..30.0f64),
            plane_height in 0.01..16.0f64,
            near in 0.0..20.0f64,
            (width, height) in (1u16..300, 1u16..300),
        ) {
            prop_assume!(length(direction) > 0.1 && length(cross(direction, [0.0, 1.0, 0.0])) > 0.1);
            let direction = normalised(direction);
            let camera = Camera { position: [1.0, 2.0, 3.0], direction, up: [0.0, 1.0, 0.0], plane_height, plane_width: None, near };
            let patch = StartPatch::new(&camera, width, height, 0.25);
            let [(nearest, _), (furthest, _)] = patch.nearest_and_furthest(point);
            let (mut low, mut high) = (f64::INFINITY, 0.0f64);
            for step in 0..41 * 41 {
                let (x, y) = (f64::from(step % 41) / 20.0 - 1.0, f64::from(step / 41) / 20.0 - 1.0);
                let ray = normalised([0, 1, 2].map(|i| direction[i] + x * patch.half[0][i] + y * patch.half[1][i]));
                let distance = length([0, 1, 2].map(|i| camera.position[i] + near * ray[i] - point[i]));
                (low, high) = (low.min(distance), high.max(distance));
            }
            // Two neighbours of the grid are 2/20 of the film's half apart, or less on the sphere.
            let step = near * 0.1 * (length(patch.half[0]) + length(patch.half[1]));
            prop_assert!(nearest <= low + 1e-9 && low <= nearest + step, "{nearest} {low} {step}");
            prop_assert!(furthest >= high - 1e-9 && high >= furthest - step, "{furthest} {high} {step}");
        }
    }

    #[test]
    fn places_are_named_as_one_sees_them() {
        let camera = Camera {
            position: [0.0; 3],
            direction: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            plane_height: 1.0,
            plane_width: None,
            near: 10.0,
        };
        let patch = StartPatch::new(&camera, 4, 3, 0.0);
        let place = |point| patch.nearest_and_furthest(point)[0].1;
        assert_eq!(place([0.1, 0.1, -10.0]), "middle");
        assert_eq!(place([9.0, 9.0, -10.0]), "top right");
        assert_eq!(place([-9.0, 0.0, -10.0]), "left");
        assert_eq!(place([0.0, -9.0, -10.0]), "bottom");
    }
}
