//! The plain list: every primitive is tried.

use core::marker::PhantomData;

use super::Aggregate;
use crate::arithmetic::Formats;
use crate::capability::{Capability, Needs};
use crate::geometry::{
    Bounds, Hit, Interaction, OnShape, PrimitiveId, PrimitiveSet, Primitives, Ray, Shape, Standing, Visitor,
};
use crate::profile::Profile;

/// All primitives of a scene, tried one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Linear<'s> {
    /// The primitives.
    pub primitives: Primitives<'s>,
    /// The opaque solids that rays start within.
    pub opened: &'s PrimitiveSet,
}

type Length<P> = <<P as Profile>::Numbers as Formats>::Length;

impl Linear<'_> {
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
        // A primitive is known by how many are left with it: the one number that the loop has to count anyway.
        let left_at = |index: usize| shapes.len().wrapping_sub(index.wrapping_sub(first));
        let index_at = |left: usize| first + shapes.len() - left;
        let departed = left_at(self.ray.departed.index());
        let (mut nearest, mut left) = (0, shapes);
        while let [shape, rest @ ..] = left {
            let standing = Standing {
                departs: left.len() == departed,
                two_sided: self
                    .list
                    .is_two_sided::<F>(PrimitiveId::new(index_at(left.len()))),
            };
            if let Some(t) = shape.closest::<P, F>(self.ray, standing, self.epsilon, self.t_max) {
                (self.t_max, nearest) = (t, left.len());
            }
            left = rest;
        }
        if nearest != 0 {
            self.nearest = PrimitiveId::new(index_at(nearest));
        }
    }
}

/// Whether there is a hit.
struct Any<'a, P: Profile, F> {
    list: &'a Linear<'a>,
    ray: &'a Ray<P::Numbers>,
    epsilon: Length<P>,
    t_max: Length<P>,
    found: bool,
    needs: PhantomData<F>,
}

impl<P: Profile, F: Needs> Visitor for Any<'_, P, F> {
    fn visit<S: Shape>(&mut self, first: usize, shapes: &[S]) {
        self.found = self.found
            || F::NEEDS.has(S::CAPABILITY)
                && (first..).zip(shapes).any(|(index, shape)| {
                    let standing = self.list.standing::<P, F>(self.ray, PrimitiveId::new(index));
                    shape.any::<P, F>(self.ray, standing, self.epsilon, self.t_max)
                });
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
    fn call<S: Shape>(self, shape: &S) -> Interaction<P::Numbers> {
        shape.interaction::<P, F>(self.ray, self.standing, self.hit)
    }
}

impl Aggregate for Linear<'_> {
    #[inline]
    fn closest<P: Profile, F: Needs>(
        &self,
        ray: &Ray<P::Numbers>,
        epsilon: Length<P>,
    ) -> Option<Hit<P::Numbers>> {
        let mut closest = Closest::<P, F> {
            list: self,
            ray,
            epsilon,
            t_max: P::Numbers::FAR,
            nearest: PrimitiveId::NONE,
            needs: PhantomData,
        };
        self.primitives.visit(&mut closest);
        (closest.nearest != PrimitiveId::NONE).then_some(Hit {
            t: closest.t_max,
            primitive: closest.nearest,
        })
    }

    fn any<P: Profile, F: Needs>(&self, ray: &Ray<P::Numbers>, epsilon: Length<P>, t_max: Length<P>) -> bool {
        let mut any = Any::<P, F> {
            list: self,
            ray,
            epsilon,
            t_max,
            found: false,
            needs: PhantomData,
        };
        self.primitives.visit(&mut any);
        any.found
    }

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
