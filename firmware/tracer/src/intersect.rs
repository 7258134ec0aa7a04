//! Where a ray meets the nearest sphere.

use crate::material::mirrored;
use crate::numbers::Numbers;
use crate::ray::Ray;
use crate::scene::{Needs, Scene};
use crate::sphere::Sphere;
use crate::vector;

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
    /// The nearest hit of `ray`; hits nearer than `epsilon` may be the surface it leaves. `F` is what the scene needs.
    fn nearest<'s, N: Numbers, F: Needs>(
        scene: &'s Scene<N>,
        ray: &Ray<'s, N>,
        epsilon: N::Length,
    ) -> Option<Hit<'s, N>>;
}

/// smallpt's: `t = b - sqrt(b^2 - |c - o|^2 + r^2)`, else the other root, whichever first exceeds epsilon.
#[derive(Clone, Copy, Debug)]
pub enum Textbook {}

impl Intersection for Textbook {
    fn nearest<'s, N: Numbers, F: Needs>(
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
            let (b, root) = (N::length_of(b), N::root(discriminant));
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
/// With `b = (c - o) . d` and the power of the origin turned round, `p = r^2 - |c - o|^2` (positive inside), the roots are
/// `b - sqrt(b^2 + p)` and `b + sqrt(b^2 + p)`. A hollow sphere is seen from inside and has only the second; that one is
/// nearer than `t` exactly when `t > b` and `(t - b)^2 > b^2 + p`, and only then is the root taken. A solid one has only
/// the first, and only where `p < 0 < b`, unless it has an inside: it lets light through, or rays start in it. From the
/// sphere that a ray leaves, one root is the start itself, which is left out by identity and not by distance; the other is
/// `2 b`, exactly. The hit point is put back on its sphere.
///
/// Within a solid, a ray's normal where it arrives is the normal where it left, mirrored in the plane across the ray: that
/// is taken from directions alone, and so the angle with the surface is the same at both ends to 2^-29, however coarse the
/// positions are beside the radius. Were it taken from positions, light that grazed a small glass ball could find itself
/// past the critical angle within, and stay there. For the same reason a ray misses such a solid where half its chord is no
/// longer than the hit point's rounding: its normal could lie on either side.
#[derive(Clone, Copy, Debug)]
pub enum Power {}

/// The best hit so far.
struct Nearest<'s, N: Numbers> {
    t: N::Length,
    sphere: Option<&'s Sphere<N>>,
}

impl<'s, N: Numbers> Nearest<'s, N> {
    #[inline]
    fn hollow(&mut self, sphere: &'s Sphere<N>, ray: &Ray<'s, N>, epsilon: N::Length) {
        let to_centre = vector::sub(sphere.centre, ray.origin);
        let b = N::length_of(N::project(to_centre, ray.direction));
        if ray.leaves(sphere) {
            return self.chord(sphere, b, epsilon);
        }
        let beyond = self.t - b;
        if beyond <= N::NOTHING {
            return;
        }
        let discriminant = N::product(b, b) + (sphere.square - N::dot(to_centre, to_centre));
        if N::product(beyond, beyond) <= discriminant {
            return;
        }
        // Rounding may have put the start an ulp outside: then the hit is at once, and not behind.
        let t = b + N::root(discriminant);
        self.t = if t < N::NOTHING { N::NOTHING } else { t };
        self.sphere = Some(sphere);
    }

    #[inline]
    fn solid<F: Needs>(&mut self, sphere: &'s Sphere<N>, ray: &Ray<'s, N>, epsilon: N::Length) {
        let to_centre = vector::sub(sphere.centre, ray.origin);
        let projection = N::project(to_centre, ray.direction);
        let b = N::length_of(projection);
        let has_inside = sphere.has_inside::<F>();
        if b <= N::NOTHING && !has_inside {
            return;
        }
        if ray.leaves(sphere) {
            if has_inside {
                self.chord(sphere, b, epsilon);
            }
            return;
        }
        let power = sphere.square - N::dot(to_centre, to_centre);
        let discriminant = N::squared(projection) + power;
        let inside = power >= N::NO_SQUARE;
        let hidden = if inside { !has_inside } else { b <= N::NOTHING };
        if hidden || discriminant < N::NO_SQUARE {
            return;
        }
        let root = N::root(discriminant);
        if has_inside && root <= N::GRAZING {
            return;
        }
        let t = if inside { b + root } else { b - root };
        if t > epsilon && t < self.t {
            (self.t, self.sphere) = (t, Some(sphere));
        }
    }

    /// The far end of the chord that starts where the ray leaves `sphere`.
    #[inline]
    fn chord(&mut self, sphere: &'s Sphere<N>, b: N::Length, epsilon: N::Length) {
        let t = b + b;
        if t > epsilon && t < self.t {
            (self.t, self.sphere) = (t, Some(sphere));
        }
    }
}

impl Intersection for Power {
    #[inline]
    fn nearest<'s, N: Numbers, F: Needs>(
        scene: &'s Scene<N>,
        ray: &Ray<'s, N>,
        epsilon: N::Length,
    ) -> Option<Hit<'s, N>> {
        let mut nearest = Nearest {
            t: N::FAR,
            sphere: None,
        };
        for sphere in scene.hollow() {
            nearest.hollow(sphere, ray, epsilon);
        }
        for sphere in scene.solid() {
            nearest.solid::<F>(sphere, ray, epsilon);
        }
        let sphere = nearest.sphere?;
        let outward = if sphere.has_inside::<F>() && ray.leaves(sphere) {
            mirrored::<N>(ray.outward, ray.direction)
        } else {
            let from_centre =
                [0, 1, 2].map(|i| ray.origin[i] - sphere.centre[i] + N::scale(nearest.t, ray.direction[i]));
            N::normal(from_centre, sphere.reciprocal)
        };
        let point = [0, 1, 2].map(|i| sphere.centre[i] + N::scale(sphere.radius, outward[i]));
        Some(Hit {
            sphere,
            point,
            outward,
        })
    }
}
