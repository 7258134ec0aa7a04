//! The list: every primitive is tried, but for those that are proved to be behind another ([`Room`]).

use core::marker::PhantomData;

use super::{Aggregate, Exit, Room, RoomNumbers, Sight};
use crate::arithmetic::Formats;
use crate::capability::{Capabilities, Capability, Needs};
use crate::geometry::{
    Bounds, Grid, Hit, Interaction, OnShape, PrimitiveId, PrimitiveSet, Primitives, Ray, Shape, Standing,
    Visitor,
};
use crate::profile::{Profile, Quadratic};

/// All primitives of a scene, tried one after the other, and what has been proved of them.
#[derive(Clone, Copy, Debug)]
pub struct Linear<'s> {
    /// The primitives.
    pub primitives: Primitives<'s>,
    /// The grid that coarse tests are on.
    pub grid: Grid,
    /// What has been proved of the hollow spheres.
    pub room: Option<&'s Room>,
    /// The opaque solids that rays start within.
    pub opened: &'s PrimitiveSet,
}

type Length<P> = <<P as Profile>::Numbers as Formats>::Length;

impl Linear<'_> {
    /// Where the ray meets the first hollow sphere, if that is known without asking all.
    #[inline]
    fn exit<P: Profile>(&self, ray: &Ray<P::Numbers>) -> Option<Exit<'_, P::Numbers>> {
        let exit = P::Numbers::exit(self.room?, ray.origin, ray.direction)?;
        // Of the surface that it leaves, the formula has both roots.
        (!ray.departs_from(exit.wall.primitive)).then_some(exit)
    }

    /// The nearest hit of the primitives of the kinds in `F` that is nearer than `other`, or else that.
    #[inline]
    fn closest_of<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
        other: Hit<P::Numbers>,
    ) -> Hit<P::Numbers> {
        let mut closest = Closest::<P, F> {
            list: self,
            ray,
            epsilon,
            t_max: other.t,
            nearest: other.primitive,
            needs: PhantomData,
        };
        self.primitives.visit(&mut closest);
        Hit {
            t: closest.t_max,
            primitive: closest.nearest,
        }
    }

    /// The nearest hit of all primitives; of none of them where there is none.
    #[inline]
    fn closest<P: Profile, F: Needs>(&self, ray: &Ray<P::Numbers>, epsilon: Length<P>) -> Hit<P::Numbers> {
        let nothing = Hit {
            t: P::Numbers::FAR,
            primitive: PrimitiveId::NONE,
        };
        self.closest_of::<P, F>(ray, epsilon, nothing)
    }

    /// The nearest hit of all hollow spheres, kept apart from what happens more often.
    #[cold]
    #[inline(never)]
    fn closest_wall<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
    ) -> Hit<P::Numbers> {
        self.closest::<P, Walls<F>>(ray, epsilon)
    }

    /// Whether a primitive of the kinds in `F` stands in a sight.
    #[inline]
    fn any<P: Profile, F: Needs>(&self, sight: &Sight<P::Numbers>, epsilon: Length<P>) -> bool {
        let mut occluder = Occluder::<P, F> {
            list: self,
            sight,
            epsilon,
            found: false,
            needs: PhantomData,
        };
        self.primitives.visit(&mut occluder);
        occluder.found
    }

    /// Whether a hollow sphere does, kept apart from what happens more often.
    #[cold]
    #[inline(never)]
    fn any_wall<P: Profile, F: Needs>(&self, sight: &Sight<P::Numbers>, epsilon: Length<P>) -> bool {
        !sight.is_within && self.any::<P, Walls<F>>(sight, epsilon)
    }

    /// The surface at a hit; none where there is no such primitive.
    #[inline]
    fn interaction<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        hit: Hit<P::Numbers>,
    ) -> Option<Interaction<P::Numbers>> {
        let surface = Surface::<P, F> {
            ray,
            standing: self.standing::<P, F>(ray, hit.primitive),
            hit,
            needs: PhantomData,
        };
        self.primitives.with(hit.primitive, surface)
    }

    /// The nearest surface, every primitive being asked: what [`Aggregate::intersect`] must find, too.
    pub fn intersect_plainly<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
    ) -> Option<Interaction<P::Numbers>> {
        self.interaction::<P, F>(ray, self.closest::<P, F>(ray, epsilon))
    }

    #[inline]
    fn is_two_sided<F: Needs>(&self, primitive: PrimitiveId) -> bool {
        F::NEEDS.has(Capability::TwoSided) && self.opened.contains(primitive)
    }

    #[inline]
    fn standing<P: Profile, F: Needs>(&self, ray: &Ray<P::Numbers>, primitive: PrimitiveId) -> Standing {
        Standing {
            departs: ray.departs_from(primitive),
            two_sided: self.is_two_sided::<F>(primitive),
        }
    }
}

/// What is within a room's walls.
struct Within<F>(PhantomData<F>);

impl<F: Needs> Needs for Within<F> {
    const NEEDS: Capabilities = F::NEEDS.without(Capability::Hollow);
}

/// The walls.
struct Walls<F>(PhantomData<F>);

impl<F: Needs> Needs for Walls<F> {
    const NEEDS: Capabilities = Capabilities::of(&[Capability::Hollow, Capability::ClippedLights]);
}

/// Primitives of a kind by how many are left with them: the one number that a loop over them has to count anyway.
#[derive(Clone, Copy)]
struct Countdown {
    /// The id after the last one.
    end: usize,
}

impl Countdown {
    #[inline]
    fn new(first: usize, count: usize) -> Self {
        Self { end: first + count }
    }

    /// How many are left at a primitive; no such number at one of another kind.
    #[inline]
    fn left_at(self, primitive: PrimitiveId) -> usize {
        self.end.wrapping_sub(primitive.index())
    }

    #[inline]
    fn primitive(self, left: usize) -> PrimitiveId {
        PrimitiveId::new(self.end - left)
    }
}

/// The nearest hit so far.
struct Closest<'a, P: Profile, F> {
    list: &'a Linear<'a>,
    ray: &'a Ray<P::Numbers>,
    epsilon: Length<P>,
    t_max: Length<P>,
    /// Whose the nearest surface is.
    nearest: PrimitiveId,
    needs: PhantomData<F>,
}

impl<P: Profile, F: Needs> Visitor for Closest<'_, P, F> {
    #[inline]
    fn visit<S: Shape>(&mut self, first: usize, shapes: &[S]) {
        if !F::NEEDS.has(S::CAPABILITY) {
            return;
        }
        let countdown = Countdown::new(first, shapes.len());
        let departed = countdown.left_at(self.ray.departed);
        let prepared = S::prepare::<P, F>(self.ray, self.list.grid);
        let (mut nearest, mut left) = (0, shapes);
        while let [shape, rest @ ..] = left {
            let standing = Standing {
                departs: left.len() == departed,
                two_sided: self.list.is_two_sided::<F>(countdown.primitive(left.len())),
            };
            if let Some(t) = shape.closest::<P, F>(self.ray, &prepared, standing, self.epsilon, self.t_max) {
                (self.t_max, nearest) = (t, left.len());
            }
            left = rest;
        }
        if nearest != 0 {
            self.nearest = countdown.primitive(nearest);
        }
    }
}

/// Whether something stands in a sight.
struct Occluder<'a, P: Profile, F> {
    list: &'a Linear<'a>,
    sight: &'a Sight<P::Numbers>,
    epsilon: Length<P>,
    found: bool,
    needs: PhantomData<F>,
}

impl<P: Profile, F: Needs> Visitor for Occluder<'_, P, F> {
    #[inline]
    fn visit<S: Shape>(&mut self, first: usize, shapes: &[S]) {
        // Without lights that walls cut, no wall stands in any sight.
        let is_never = S::CAPABILITY == Capability::Hollow && !F::NEEDS.has(Capability::ClippedLights);
        if self.found || is_never || !F::NEEDS.has(S::CAPABILITY) {
            return;
        }
        let Sight {
            ray,
            t_max,
            target,
            is_within,
        } = self.sight;
        let countdown = Countdown::new(first, shapes.len());
        let (departed, target) = (countdown.left_at(ray.departed), countdown.left_at(*target));
        let prepared = S::prepare::<P, F>(ray, self.list.grid);
        let mut left = shapes;
        while let [shape, rest @ ..] = left {
            let standing = Standing {
                departs: left.len() == departed,
                two_sided: self.list.is_two_sided::<F>(countdown.primitive(left.len())),
            };
            if left.len() != target
                && !(*is_within && shape.encloses())
                && shape.any::<P, F>(ray, &prepared, standing, self.epsilon, *t_max)
            {
                self.found = true;
                return;
            }
            left = rest;
        }
    }
}

/// The surface of one shape.
struct Surface<'a, P: Profile, F> {
    ray: &'a Ray<P::Numbers>,
    standing: Standing,
    hit: Hit<P::Numbers>,
    needs: PhantomData<F>,
}

impl<P: Profile, F: Needs> OnShape<Interaction<P::Numbers>> for Surface<'_, P, F> {
    #[inline]
    fn is_for<S: Shape>() -> bool {
        F::NEEDS.has(S::CAPABILITY)
    }

    #[inline]
    fn call<S: Shape>(self, shape: &S) -> Interaction<P::Numbers> {
        shape.interaction::<P, F>(self.ray, self.standing, self.hit)
    }
}

impl Aggregate for Linear<'_> {
    #[inline]
    fn intersect<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
    ) -> Option<Interaction<P::Numbers>> {
        if !F::NEEDS.has(Capability::Room) || matches!(P::QUADRATIC, Quadratic::Textbook) {
            return self.interaction::<P, F>(ray, self.closest::<P, F>(ray, epsilon));
        }
        let exit = self.exit::<P>(ray);
        let wall = match exit {
            Some(exit) => Hit {
                t: exit.t,
                primitive: exit.wall.primitive,
            },
            None => self.closest_wall::<P, F>(ray, epsilon),
        };
        let hit = self.closest_of::<P, Within<F>>(ray, epsilon, wall);
        match exit {
            Some(exit) if hit.primitive == exit.wall.primitive && exit.wall.reciprocal != 0 => {
                Some(Interaction {
                    point: exit.point,
                    normal: P::Numbers::normal_of_wall(exit.wall, exit.point),
                    from_inside: true,
                    primitive: exit.wall.primitive,
                    material: exit.wall.material,
                })
            }
            _ => self.interaction::<P, F>(ray, hit),
        }
    }

    #[inline]
    fn occludes<P: Profile, F: Needs>(&self, sight: &Sight<P::Numbers>, epsilon: Length<P>) -> bool {
        // Of the same needs as what looks for the nearest hit, whose code it shares.
        let within = if F::NEEDS.has(Capability::Room) {
            self.any::<P, Within<F>>(sight, epsilon)
        } else {
            self.any::<P, F>(sight, epsilon)
        };
        let walls_are_apart = F::NEEDS.has(Capability::Room) && F::NEEDS.has(Capability::ClippedLights);
        within || walls_are_apart && self.any_wall::<P, F>(sight, epsilon)
    }

    fn bounds(&self) -> Option<Bounds> {
        struct Union(Option<Bounds>);
        impl Visitor for Union {
            fn visit<S: Shape>(&mut self, _first: usize, shapes: &[S]) {
                for shape in shapes {
                    let bounds = shape.bounds();
                    self.0 = Some(self.0.map_or(bounds, |all| all.union(bounds)));
                }
            }
        }
        let mut union = Union(None);
        self.primitives.visit(&mut union);
        union.0
    }
}
