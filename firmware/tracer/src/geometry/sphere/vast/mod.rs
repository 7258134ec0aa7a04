//! The vast sphere: one whose radius 16:16 has no room for, as the walls and grounds of radius 1e5 that stand for planes.
//!
//! Next to the scene it is a plane that is bent a little. With a point `q` of it, its *pole*, the unit vector `n` there to the
//! side that rays are on, and the curvature `k`, 1/r where it bends to that side and -1/r where it bends away, the *height*
//! `h(x) = n.(x - q) - k/2 |x - q|^2` is positive on the rays' side and 0 on the sphere. Its gradient `n - k (x - q)` is there the
//! unit normal. Along a ray it is `h + s t - k/2 t^2`, with the slope `s = d.(n - k (o - q))`, and a slope of `root` or `-root`
//! where it is 0, with `root^2 = s^2 + 2 k h`. So a ray goes under the surface at `2 h / (root - s)` or, which is the same and
//! loses nothing where the former does, at `(root + s) / k`. Where it comes up from below, all three are turned round.
//!
//! Nothing here is squared that is as long as the radius, and the rounding of a hit does not grow with it.

mod numbers;

pub use numbers::{Bend, VastNumbers};

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I16F16};

use super::Length;
use crate::arithmetic::vector::{neg, reflected, sub};
use crate::arithmetic::{Directions, Formats};
use crate::capability::{Capability, Needs};
use crate::geometry::{Bounds, Grid, Hit, Interaction, MaterialId, Ray, Shape, ShapeNumbers, Standing};
use crate::profile::{Profile, Quadratic};

/// A sphere of a radius of at least twice the tracer's reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct VastSphere {
    /// The point of its surface that is nearest to the middle of the scene.
    pub pole: [I16F16; 3],
    /// The unit normal there, to the side that rays are on.
    pub normal: [I2F30; 3],
    /// How it bends: positive where it is hollow.
    pub bend: Bend,
    /// 1 where light goes through the surface, so that rays are below it, too; else 0.
    pub has_inside: u8,
    /// Zero.
    pub reserved: u8,
    /// What it is made of.
    pub material: MaterialId,
}

const _: () = assert!(size_of::<VastSphere>() == 40);

impl Shape for VastSphere {
    const CAPABILITY: Capability = Capability::Vast;

    fn is_sound(&self) -> bool {
        self.bend.is_sound() && self.has_inside <= 1 && self.reserved == 0
    }

    fn material(&self) -> MaterialId {
        self.material
    }

    type Prepared<N: ShapeNumbers> = ();

    #[inline]
    fn prepare<P: Profile, F: Needs>(_ray: &Ray<P::Numbers>, _grid: Grid) {}

    #[inline]
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        _prepared: &(),
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        match P::QUADRATIC {
            Quadratic::Textbook => self.textbook::<P>(ray, epsilon, t_max),
            Quadratic::Power => self.closely::<P, F>(ray, standing, epsilon, t_max),
        }
    }

    /// The point is put back on the surface along its normal.
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        hit: Hit<P::Numbers>,
    ) -> Interaction<P::Numbers> {
        let on_ray = ray.at(hit.t);
        let above = sub(on_ray, self.pole.map(P::Numbers::length));
        let upward = P::Numbers::upward(self.normal, self.bend, above);
        let (point, normal) = match P::QUADRATIC {
            Quadratic::Textbook => (on_ray, upward),
            Quadratic::Power => {
                let height = P::Numbers::height(self.normal, self.bend, above);
                let point = P::Numbers::lowered(on_ray, height, upward);
                let crosses = self.has_inside::<F>() && standing.departs;
                let upward = if crosses {
                    reflected::<P::Numbers>(ray.normal, ray.direction)
                } else {
                    upward
                };
                (point, upward)
            }
        };
        Interaction {
            point,
            normal: if self.is_hollow() { neg(normal) } else { normal },
            from_inside: self.is_hollow(),
            primitive: hit.primitive,
            material: self.material,
        }
    }

    #[inline]
    fn encloses(&self) -> bool {
        self.is_hollow()
    }

    /// All that 16:16 holds: nothing that such a sphere reaches through is smaller.
    fn bounds(&self) -> Bounds {
        Bounds {
            low: [I16F16::MIN; 3],
            high: [I16F16::MAX; 3],
        }
    }
}

impl VastSphere {
    /// Whether it is seen from within.
    #[inline]
    pub fn is_hollow(&self) -> bool {
        self.bend.is_towards()
    }

    #[inline]
    fn has_inside<F: Needs>(&self) -> bool {
        F::NEEDS.has(Capability::Inside) && self.has_inside != 0
    }

    /// Where a ray hits it, by [`Quadratic::Power`]: from above where it goes under, and from within a ball of glass where it
    /// comes up.
    fn closely<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        standing: Standing,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        let (height, slope) = if standing.departs {
            let along = P::Numbers::cosine(ray.normal, ray.direction);
            (P::Numbers::LEVEL, if self.is_hollow() { -along } else { along })
        } else {
            self.height_and_slope::<P>(ray)
        };
        let has_inside = self.has_inside::<F>();
        let below = has_inside
            && if standing.departs {
                slope < P::Numbers::ZERO
            } else {
                P::Numbers::is_below(height)
            };
        let passes = if self.is_hollow() {
            // Once under it, a ray stays there.
            !P::Numbers::is_below(P::Numbers::height_at(self.bend, height, slope, t_max))
        } else {
            !below && slope >= P::Numbers::ZERO
        };
        if passes {
            return None;
        }
        let root = P::Numbers::root_of_slope(self.bend, height, slope)?;
        if has_inside && P::Numbers::is_level(root) {
            return None;
        }
        let (bend, height, slope) = if below {
            (self.bend.turned(), -height, -slope)
        } else {
            (self.bend, height, slope)
        };
        let t = P::Numbers::goes_under(bend, height, slope, root, t_max)?;
        let is_hit = if standing.departs && !self.is_hollow() {
            t > epsilon
        } else {
            // Rounding may have put the start below, where two surfaces meet: then the hit is at once.
            t >= epsilon || self.is_hollow()
        };
        (is_hit && t < t_max).then_some(t)
    }

    /// By [`Quadratic::Textbook`]: the first of both hits that exceeds epsilon.
    fn textbook<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
        t_max: Length<P>,
    ) -> Option<Length<P>> {
        let (height, slope) = self.height_and_slope::<P>(ray);
        let root = P::Numbers::root_of_slope(self.bend, height, slope)?;
        let hits = [
            P::Numbers::goes_under(self.bend, height, slope, root, t_max),
            // It comes up where, seen from the other side, it goes under.
            P::Numbers::goes_under(self.bend.turned(), -height, -slope, root, t_max),
        ];
        let beyond = |nearest: Option<Length<P>>, t: Length<P>| match nearest {
            Some(nearest) if nearest <= t => Some(nearest),
            _ => Some(t),
        };
        hits.into_iter()
            .flatten()
            .filter(|&t| t > epsilon && t < t_max)
            .fold(None, beyond)
    }

    #[inline]
    fn height_and_slope<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
    ) -> (<P::Numbers as VastNumbers>::Height, <P::Numbers as Formats>::Unit) {
        let above = sub(ray.origin, self.pole.map(P::Numbers::length));
        (
            P::Numbers::height(self.normal, self.bend, above),
            P::Numbers::slope(self.normal, self.bend, above, ray.direction),
        )
    }
}
