//! Where a ray meets the nearest sphere.

use core::ptr;

use crate::numbers::Numbers;
use crate::scene::{Scene, Sphere};
use crate::vector;

/// A half-line, and the surface it starts from.
#[derive(Clone, Copy, Debug)]
pub struct Ray<'s, N: Numbers> {
    /// Where it starts.
    pub origin: [N::Length; 3],
    /// Where it goes: a unit vector.
    pub direction: [N::Unit; 3],
    /// The sphere it starts on.
    pub leaves: Option<&'s Sphere<N>>,
}

/// A point on a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Hit<'s, N: Numbers> {
    /// The sphere.
    pub sphere: &'s Sphere<N>,
    /// The point.
    pub point: [N::Length; 3],
    /// The unit normal there, away from the centre.
    pub outward: [N::Unit; 3],
}

/// A way to find the nearest hit.
pub trait Intersection {
    /// The nearest hit of `ray`; hits nearer than `epsilon` may be the surface it leaves.
    fn nearest<'s, N: Numbers>(
        scene: &'s Scene<N>,
        ray: &Ray<'s, N>,
        epsilon: N::Length,
    ) -> Option<Hit<'s, N>>;
}

/// smallpt's: `t = b - sqrt(b^2 - |c - o|^2 + r^2)`, else the other root, whichever first exceeds epsilon.
#[derive(Clone, Copy, Debug)]
pub enum Textbook {}

impl Intersection for Textbook {
    fn nearest<'s, N: Numbers>(
        scene: &'s Scene<N>,
        ray: &Ray<'s, N>,
        epsilon: N::Length,
    ) -> Option<Hit<'s, N>> {
        let mut best = (N::FAR, None);
        for sphere in scene.spheres() {
            let to_centre = vector::sub(sphere.centre, ray.origin);
            let b = N::project(to_centre, ray.direction);
            let discriminant = N::squared(b) - N::dot(to_centre, to_centre) + sphere.square;
            if discriminant < N::NO_SQUARE {
                continue;
            }
            let (b, root) = (N::rounded(b), N::root(discriminant));
            let (near, far) = (b - root, b + root);
            let t = if near > epsilon { near } else { far };
            if t > epsilon && t < best.0 {
                best = (t, Some(sphere));
            }
        }
        let (t, sphere) = (best.0, best.1?);
        let point = [0, 1, 2].map(|i| ray.origin[i] + N::scale(t, ray.direction[i]));
        let outward = N::normal(vector::sub(point, sphere.centre), sphere.reciprocal);
        Some(Hit {
            sphere,
            point,
            outward,
        })
    }
}

/// Ours: by the power of a point, which says without a root whether a hit can be nearer than the best so far.
///
/// With `b = (c - o) . d` and the power of the origin turned round, `p = r^2 - |c - o|^2` (positive inside), the point at
/// distance `t` lies outside a sphere exactly when `t^2 - 2 b t > p`. A hollow sphere, seen from inside, is therefore
/// nearer than `t` exactly when that holds; only then is its root `b + sqrt(b^2 + p)` taken. A solid one has its near
/// root only where `p < 0 < b`. From the sphere that a ray leaves, one root is the start itself, which is left out by
/// identity and not by distance; the other is `2 b`, exactly. The hit point is put back on its sphere.
#[derive(Clone, Copy, Debug)]
pub enum Power {}

impl Power {
    /// The nearest distance on a solid sphere, met at a projection of `b`.
    fn solid<N: Numbers>(
        sphere: &Sphere<N>,
        power: N::Square,
        b: N::Projection,
        epsilon: N::Length,
    ) -> Option<N::Length> {
        let length = N::rounded(b);
        let inside = power >= N::NO_SQUARE;
        if inside && !sphere.surface.transmits() || !inside && length <= N::NOTHING {
            return None;
        }
        let discriminant = N::squared(b) + power;
        if discriminant < N::NO_SQUARE {
            return None;
        }
        let root = N::root(discriminant);
        let t = if inside { length + root } else { length - root };
        (t > epsilon).then_some(t)
    }
}

impl Intersection for Power {
    #[inline]
    fn nearest<'s, N: Numbers>(
        scene: &'s Scene<N>,
        ray: &Ray<'s, N>,
        epsilon: N::Length,
    ) -> Option<Hit<'s, N>> {
        let mut best = None;
        let mut nearest = N::FAR;
        let mut nearest_square = N::product(nearest, nearest);
        let left = |sphere: &Sphere<N>| ray.leaves.is_some_and(|leaves| ptr::eq(leaves, sphere));

        for sphere in scene.hollow() {
            let to_centre = vector::sub(sphere.centre, ray.origin);
            let b = N::rounded(N::project(to_centre, ray.direction));
            let t = if left(sphere) {
                let chord = b + b;
                if chord <= epsilon || chord >= nearest {
                    continue;
                }
                chord
            } else {
                let power = sphere.square - N::dot(to_centre, to_centre);
                let half = N::product(b, nearest);
                if nearest_square - power <= half + half {
                    continue;
                }
                // Rounding may have put the start an ulp outside: then the hit is at once, and not behind.
                let t = b + N::root(N::product(b, b) + power);
                if t < N::NOTHING { N::NOTHING } else { t }
            };
            best = Some(sphere);
            nearest = t;
            nearest_square = N::product(t, t);
        }

        for sphere in scene.solid() {
            let to_centre = vector::sub(sphere.centre, ray.origin);
            let b = N::project(to_centre, ray.direction);
            let t = if left(sphere) {
                let b = N::rounded(b);
                let chord = b + b;
                if !sphere.surface.transmits() || chord <= epsilon {
                    continue;
                }
                chord
            } else {
                let power = sphere.square - N::dot(to_centre, to_centre);
                match Self::solid(sphere, power, b, epsilon) {
                    Some(t) => t,
                    None => continue,
                }
            };
            if t < nearest {
                best = Some(sphere);
                nearest = t;
            }
        }

        let sphere = best?;
        let from_centre =
            [0, 1, 2].map(|i| ray.origin[i] - sphere.centre[i] + N::scale(nearest, ray.direction[i]));
        let outward = N::normal(from_centre, sphere.reciprocal);
        let point = [0, 1, 2].map(|i| sphere.centre[i] + N::scale(sphere.radius, outward[i]));
        Some(Hit {
            sphere,
            point,
            outward,
        })
    }
}
