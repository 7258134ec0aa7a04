//! Ways to meet a sphere: the tracer's by profile, and others that it does not keep.

use fixedmath::{I2F30, I16F16};
use operations::intersection::{Textbook, haines};
use tracer::arithmetic::{Directions, Formats, Mixed};
use tracer::geometry::sphere::{CoarseSphere, HollowSphere, Reciprocal, SolidSphere, SphereNumbers};
use tracer::geometry::{Grid, Hit, PrimitiveId, Ray, Shape, Standing};
use tracer::profile::{Paper, Precise, Profile};
use tracer::scene::{All, Capabilities, Capability, Needs};

use super::cases::{Case, Surface};
use crate::oracle::lockstep::Lockstep;
use crate::stability::draw::ulps;
use crate::stability::exact::Line;

/// What a formula says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    /// How far along the ray, in ulp.
    pub(super) distance: f64,
    /// The hit point, in ulp.
    pub(super) point: [f64; 3],
    /// The normal there.
    pub(super) normal: [f64; 3],
}

/// A way to meet a sphere.
pub(super) struct Formula {
    /// What rows are called.
    pub(super) name: &'static str,
    /// What the ray meets.
    pub(super) meet: fn(&Case) -> Option<Answer>,
    /// The ray as the formula has it, where it is not the case's own.
    pub(super) line: fn(&Case) -> Line,
    /// Whether it answers for this surface.
    pub(super) answers: fn(Surface) -> bool,
}

/// All that are compared.
pub(super) const FORMULAS: &[Formula] = &[
    Formula {
        name: "`precise`",
        meet: tracers::<Precise, Close>,
        line: Case::line,
        answers: |_| true,
    },
    Formula {
        name: "`precise`, rough look first",
        meet: tracers::<Precise, All>,
        line: Case::line,
        answers: |surface| surface != Surface::Wall,
    },
    Formula {
        name: "textbook, 2:30 and 32:32",
        meet: tracers::<Textbook, Close>,
        line: Case::line,
        answers: |_| true,
    },
    Formula {
        name: "Haines: distance of centre and ray, c/q",
        meet: by_haines,
        line: Case::line,
        answers: |_| true,
    },
    Formula {
        name: "`paper`",
        meet: tracers::<Paper, Close>,
        line: coarsely,
        answers: |_| true,
    },
    Formula {
        name: "`precise` in double precision",
        meet: double,
        line: Case::line,
        answers: |_| true,
    },
];

/// All that a tracer can do but for the rough look.
enum Close {}

impl Needs for Close {
    const NEEDS: Capabilities = Capabilities::ALL.without(Capability::Coarse);
}

/// The ray with its direction cut to 16:16, as [`Published`](tracer::arithmetic::Published) has it.
fn coarsely(case: &Case) -> Line {
    Line {
        direction: case.ray.direction.map(|c| (c.to_bits() >> 14 << 14).into()),
        ..case.line()
    }
}

/// A ray in a profile's formats.
pub(in crate::stability) fn ray_of<P: Profile>(ray: &Ray<Mixed>) -> Ray<P::Numbers> {
    Ray {
        origin: ray.origin.map(P::Numbers::length),
        direction: ray.direction.map(P::Numbers::unit),
        departed: ray.departed,
        normal: ray.normal.map(P::Numbers::unit),
    }
}

/// What the tracer says by profile `P`: with no epsilon, but for starts on the surface, where it is the profile's own.
fn tracers<P, F: Needs>(case: &Case) -> Option<Answer>
where
    P: Profile<Numbers: Formats<Length: Into<f64>, Unit: Into<f64>>>,
{
    meeting::<P, F>(case, &ray_of::<P>(&case.ray))
}

/// The same in double precision, whose directions are of unit length to the last place of its own.
fn double(case: &Case) -> Option<Answer> {
    let mut ray = ray_of::<Lockstep<Precise>>(&case.ray);
    ray.direction = <Lockstep<Precise> as Profile>::Numbers::renormalised(ray.direction);
    meeting::<Lockstep<Precise>, Close>(case, &ray)
}

fn meeting<P, F: Needs>(case: &Case, ray: &Ray<P::Numbers>) -> Option<Answer>
where
    P: Profile<Numbers: Formats<Length: Into<f64>, Unit: Into<f64>>>,
{
    match case.surface {
        Surface::Wall => shapes::<P, F, _>(&HollowSphere(case.record), case, ray, Grid::new(0)),
        Surface::Solid | Surface::Glass => {
            let (grid, coarse) = rough_look(case);
            let sphere = case.record;
            shapes::<P, F, _>(&SolidSphere { coarse, sphere }, case, ray, grid)
        }
    }
}

/// The finest grid that a scene of this one ray could have.
fn rough_look(case: &Case) -> (Grid, CoarseSphere) {
    let (centre, start) = (ulps(case.record.centre), ulps(case.ray.origin));
    let square: f64 = (0..3).map(|i| (centre[i] - start[i]) as f64).map(|c| c * c).sum();
    let farthest = I16F16::from_bits(square.sqrt().ceil() as i32 + 1);
    let coordinate = centre.iter().chain(&start).map(|c| c.unsigned_abs()).max();
    let coordinate = I16F16::from_bits(coordinate.unwrap_or_default() as i32);
    let grid = Grid::finest(farthest, coordinate);
    (
        grid,
        CoarseSphere::new(grid, case.record.centre, case.record.square, farthest),
    )
}

fn shapes<P, F: Needs, S: Shape>(shape: &S, case: &Case, ray: &Ray<P::Numbers>, grid: Grid) -> Option<Answer>
where
    P: Profile<Numbers: Formats<Length: Into<f64>, Unit: Into<f64>>>,
{
    let standing = Standing {
        departs: case.departs,
        two_sided: false,
    };
    let epsilon = if case.departs { P::EPSILON } else { I16F16::ZERO };
    let prepared = S::prepare::<P, F>(ray, grid);
    let epsilon = P::Numbers::length(epsilon);
    let t = shape.closest::<P, F>(ray, &prepared, standing, epsilon, P::Numbers::FAR)?;
    let hit = Hit {
        t,
        primitive: PrimitiveId::new(0),
    };
    let surface = shape.interaction::<P, F>(ray, standing, hit);
    Some(Answer {
        distance: t.into() * 65_536.0,
        point: surface.point.map(|c| c.into() * 65_536.0),
        normal: surface.normal.map(Into::into),
    })
}

/// By Haines' formula, the hit put back on its sphere.
fn by_haines(case: &Case) -> Option<Answer> {
    let to_centre = [0, 1, 2].map(|i| case.record.centre[i] - case.ray.origin[i]);
    let t = haines(to_centre, case.ray.direction, case.record.square, I16F16::ZERO)?;
    Some(put_back(case, t))
}

/// The hit at `t` as `precise` has it: put back on its sphere.
fn put_back(case: &Case, t: I16F16) -> Answer {
    let on_ray = case.ray.at(t);
    let from_centre = [0, 1, 2].map(|i| on_ray[i] - case.record.centre[i]);
    let reciprocal = Reciprocal {
        mantissa: case.record.reciprocal,
        shift: case.record.shift,
    };
    let normal: [I2F30; 3] = Mixed::normal(from_centre, case.record.radius, reciprocal);
    let point = [0, 1, 2].map(|i| case.record.centre[i] + Mixed::scale(case.record.radius, normal[i]));
    Answer {
        distance: t.to_bits().into(),
        point: point.map(|c| c.to_bits().into()),
        normal: normal.map(f64::from),
    }
}
