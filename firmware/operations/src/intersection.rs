//! Ways to meet a sphere: the tracer's by profile, and others that it does not keep; and the rays by which they are priced.

use fixedmath::random::Lcg64;
use fixedmath::{I1F31, I2F30, I16F16, I32F32, root, unit};
use tracer::arithmetic::{Formats, Mixed};
use tracer::geometry::sphere::{
    Bend, CoarseSphere, HollowSphere, SolidSphere, SphereNumbers, SphereRecord, VastSphere,
};
use tracer::geometry::{Grid, MaterialId, PrimitiveId, Ray, Shape, Standing};
use tracer::material::RejectedDisc;
use tracer::profile::{Paper, Precise, Profile, Quadratic};
use tracer::random::FullState;
use tracer::scene::{Capabilities, Capability, Needs};

use crate::number::{Direction, Number};
use crate::price::{Bench, CASES, Price, price_of};

type Vector = [I16F16; 3];

/// The textbook's formula on our formats: what the formula alone is to blame for.
#[derive(Clone, Copy, Debug)]
pub enum Textbook {}

impl Profile for Textbook {
    const NAME: &'static str = "textbook";
    const STRATIFIED_NAME: &'static str = "textbook";
    const EPSILON: I16F16 = Precise::EPSILON;
    const QUADRATIC: Quadratic = Quadratic::Textbook;
    type Numbers = Mixed;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

/// Haines et al., "Precision Improvements for Ray/Sphere Intersection" (Ray Tracing Gems, 2019), on our formats: the discriminant is
/// `r^2 - |v - b d|^2`, the root of larger magnitude `q` is a sum, and the other one `c / q`. `to_centre` is `v`.
#[inline]
pub fn haines(
    to_centre: [I16F16; 3],
    direction: [I2F30; 3],
    square: I32F32,
    epsilon: I16F16,
) -> Option<I16F16> {
    let projection = Mixed::project(to_centre, direction);
    let b = Mixed::length_of(projection);
    // From the centre to the nearest point of the ray.
    let across = [0, 1, 2].map(|i| to_centre[i] - Mixed::scale(b, direction[i]));
    let discriminant = square - Mixed::dot(across, across);
    if discriminant < I32F32::ZERO {
        return None;
    }
    let root = root::of_square(discriminant);
    let power = square - Mixed::dot(to_centre, to_centre);
    let q = if b < I16F16::ZERO { b - root } else { b + root };
    let other = match q.to_bits() {
        0 => I16F16::ZERO,
        // A quotient that does not fit is no root that is looked for.
        q => I16F16::from_bits(power.to_bits().wrapping_neg().wrapping_div(i64::from(q)) as i32),
    };
    let (near, far) = if q < other { (q, other) } else { (other, q) };
    let t = if near > epsilon { near } else { far };
    (t > epsilon).then_some(t)
}

/// Opaque spheres, and no rough look.
enum Opaque {}

impl Needs for Opaque {
    const NEEDS: Capabilities = Capabilities::of(&[Capability::Hollow, Capability::Solid, Capability::Vast]);
}

/// A ray's start and direction, and what a formula reads of a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Case<S> {
    ray: (Vector, Direction),
    shape: S,
}

impl<S: Number> Number for Case<S> {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        Self {
            ray: self.ray.through(word),
            shape: self.shape.through(word),
        }
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        self.ray.reals(see);
        self.shape.reals(see);
    }
}

/// Centre, and radius squared.
type Round = (Vector, I32F32);
/// Pole, normal, and curvature, radius and shift.
type Curved = (Vector, [I2F30; 3], [u32; 3]);

impl<S> Case<S> {
    fn ray<N: Formats>(&self) -> Ray<N> {
        let (start, Direction(direction)) = self.ray;
        Ray {
            origin: start.map(N::length),
            direction: direction.map(N::unit),
            departed: PrimitiveId::NONE,
            normal: [N::ZERO; 3],
        }
    }
}

impl Case<Round> {
    fn record(&self) -> SphereRecord {
        let (centre, square) = self.shape;
        SphereRecord {
            centre,
            radius: I16F16::ZERO,
            square,
            reciprocal: I1F31::ZERO,
            shift: 0,
            has_inside: 0,
            material: MaterialId::new(0),
        }
    }

    fn wall<P: Profile>(self) -> Option<<P::Numbers as Formats>::Length> {
        met::<P, _>(&HollowSphere(self.record()), &self.ray(), &())
    }

    fn ball<P: Profile>(self) -> Option<<P::Numbers as Formats>::Length> {
        let ball = SolidSphere {
            // Nobody looks at it.
            coarse: CoarseSphere::new(Grid::new(16), self.shape.0, self.shape.1, I16F16::ZERO),
            sphere: self.record(),
        };
        let ray = self.ray();
        met::<P, _>(
            &ball,
            &ray,
            &SolidSphere::prepare::<P, Opaque>(&ray, Grid::new(16)),
        )
    }

    fn by_haines(self) -> Option<I16F16> {
        let (centre, square) = self.shape;
        let (start, Direction(direction)) = self.ray;
        haines(
            [0, 1, 2].map(|i| centre[i] - start[i]),
            direction,
            square,
            I16F16::ZERO,
        )
    }
}

impl Case<Curved> {
    fn vast<P: Profile>(self) -> Option<<P::Numbers as Formats>::Length> {
        let (pole, normal, [curvature, radius, shift]) = self.shape;
        let vast = VastSphere {
            pole,
            normal,
            bend: Bend {
                curvature: curvature as i32,
                radius: radius as i32,
                shift,
            },
            has_inside: 0,
            reserved: 0,
            material: MaterialId::new(0),
        };
        met::<P, _>(&vast, &self.ray(), &())
    }
}

#[inline]
fn met<P: Profile, S: Shape>(
    shape: &S,
    ray: &Ray<P::Numbers>,
    prepared: &S::Prepared<P::Numbers>,
) -> Option<<P::Numbers as Formats>::Length> {
    let standing = Standing {
        departs: false,
        two_sided: false,
    };
    let epsilon = P::Numbers::length(P::EPSILON);
    shape.closest::<P, Opaque>(ray, prepared, standing, epsilon, P::Numbers::FAR)
}

/// What each price is of, in the order in which they are shown.
pub const PRICED: [&str; 8] = [
    "ball: `precise`",
    "ball: textbook, 2:30 and 32:32",
    "ball: Haines",
    "ball: `paper`",
    "wall: `precise`",
    "wall: `paper`",
    "vast wall: `precise`",
    "vast wall: `paper`",
];

/// Shows the price of each formula, of rays that meet the surface.
pub fn show(bench: &mut impl Bench, mut see: impl FnMut(Price)) {
    let balls = cases(|random| {
        let centre = [(); 3].map(|()| within(random, 50));
        let target = centre.map(|c| c + within(random, 5));
        (target, (centre, I32F32::from_bits(100 << 32)))
    });
    see(price_of_formula(bench, &balls, Case::ball::<Precise>));
    see(price_of_formula(bench, &balls, Case::ball::<Textbook>));
    see(price_of_formula(bench, &balls, Case::by_haines));
    see(price_of_formula(bench, &balls, Case::ball::<Paper>));
    let walls = cases(|random| {
        let centre = [I16F16::ZERO, I16F16::from_bits(-9_900 << 16), I16F16::ZERO];
        (
            [(); 3].map(|()| within(random, 50)),
            (centre, I32F32::from_bits(100_000_000 << 32)),
        )
    });
    see(price_of_formula(bench, &walls, Case::wall::<Precise>));
    see(price_of_formula(bench, &walls, Case::wall::<Paper>));
    let vast = cases(|random| {
        let pole = [I16F16::ZERO, I16F16::from_bits(100 << 16), I16F16::ZERO];
        let target = [
            within(random, 50),
            I16F16::from_bits(90 << 16),
            within(random, 50),
        ];
        let curvature = (1u64 << 44) / 100_000;
        let bend = [curvature as u32, 100_000 << 14, 2];
        (target, (pole, [I2F30::ZERO, -I2F30::ONE, I2F30::ZERO], bend))
    });
    see(price_of_formula(bench, &vast, Case::vast::<Precise>));
    see(price_of_formula(bench, &vast, Case::vast::<Paper>));
}

fn price_of_formula<S: Number>(
    bench: &mut impl Bench,
    cases: &[Case<S>; CASES],
    meet: impl Fn(Case<S>) -> Option<I16F16> + Copy,
) -> Price {
    let found = move |case| meet(case).unwrap_or(I16F16::ZERO);
    price_of(bench, cases, found, |case| apart(case, found))
}

/// A formula as a function that is never compiled in line.
#[inline(never)]
fn apart<S>(case: Case<S>, meet: impl Fn(Case<S>) -> I16F16) -> I16F16 {
    meet(case)
}

/// Rays from anywhere within 50 units of the middle along each axis, to a target next to a shape.
#[inline(never)]
fn cases<S>(shape: impl Fn(&mut Lcg64) -> (Vector, S)) -> [Case<S>; CASES] {
    let mut random = Lcg64::new(1);
    [(); CASES].map(|()| {
        let start = [(); 3].map(|()| within(&mut random, 50));
        let (target, shape) = shape(&mut random);
        let along = [0, 1, 2].map(|i| I2F30::from_bits((target[i] - start[i]).to_bits() << 6));
        let direction = unit::checked_normalised(along).unwrap_or([I2F30::ONE, I2F30::ZERO, I2F30::ZERO]);
        Case {
            ray: (start, Direction(direction)),
            shape,
        }
    })
}

/// A length of up to so many units, either way.
fn within(random: &mut Lcg64, units: i32) -> I16F16 {
    I16F16::from_bits(((i64::from(random.next_fraction() as i32) * i64::from(units)) >> 15) as i32)
}
