//! A shape as the tracer has it, and where rays truly meet it.

use fixedmath::I16F16;
use tracer::arithmetic::Formats;
use tracer::geometry::sphere::{CoarseSphere, HollowSphere, SolidSphere, VastSphere};
use tracer::geometry::{Grid, Hit, Interaction, MaterialId, PrimitiveId, Ray, Shape, Standing};
use tracer::profile::Profile;
use tracer::scene::{Capabilities, Capability, Needs};

use crate::scene::{self, Material, sphere_record, vast_record};
use crate::stability::draw::ulps;
use crate::stability::exact::{Line, Meeting, Sphere};
use crate::stability::vast::Bent;

/// Formats whose numbers double precision holds.
pub(in crate::stability) trait Told:
    Formats<Length: Into<f64>, Unit: Into<f64>>
{
}

impl<N: Formats<Length: Into<f64>, Unit: Into<f64>>> Told for N {}

/// All that a tracer can do but for the rough look, which only ever spares the closer one.
enum Close {}

impl Needs for Close {
    const NEEDS: Capabilities = Capabilities::ALL.without(Capability::Coarse);
}

/// A grid that any scene fits.
const COARSEST: Grid = Grid::new(16);

/// One shape.
#[derive(Clone, Debug)]
pub(in crate::stability) enum Body {
    Wall(HollowSphere),
    /// A ball; `two_sided` where rays start within although nothing goes through its surface.
    Ball {
        sphere: SolidSphere,
        two_sided: bool,
    },
    Vast(VastSphere),
}

/// A sphere of the scene's text.
pub(super) fn sphere(centre: [f64; 3], radius: f64, hollow: bool, material: Material) -> scene::Sphere {
    scene::Sphere {
        name: String::new(),
        centre,
        radius,
        hollow,
        emission: [0.0; 3],
        material,
    }
}

impl Body {
    /// A sphere as the scene's compiler has it, where it is not vast.
    pub(super) fn usual(sphere: &scene::Sphere, two_sided: bool) -> Self {
        let record = sphere_record(sphere, MaterialId::new(0));
        if sphere.hollow {
            return Self::Wall(HollowSphere(record));
        }
        let coarse = CoarseSphere::new(COARSEST, record.centre, record.square, I16F16::ZERO);
        Self::Ball {
            sphere: SolidSphere {
                coarse,
                sphere: record,
            },
            two_sided,
        }
    }

    /// A vast one, in a scene around `middle`.
    pub(super) fn vast(sphere: &scene::Sphere, middle: [f64; 3]) -> Self {
        let origin = [I16F16::ZERO; 3];
        Self::Vast(vast_record(sphere, middle, origin, MaterialId::new(0)))
    }

    /// The vast sphere, if it is one.
    pub(in crate::stability) fn bent(&self) -> Option<&VastSphere> {
        match self {
            Self::Vast(vast) => Some(vast),
            _ => None,
        }
    }

    /// Centre and radius in units; none of a vast one.
    pub(super) fn sphere(&self) -> Option<([f64; 3], f64)> {
        let Sphere { centre, radius } = self.exact()?;
        Some((centre.map(|c| c as f64 / 65_536.0), radius as f64 / 65_536.0))
    }

    /// What the tracer says that a ray meets nearer than `t_max`.
    pub(in crate::stability) fn closest<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
        departs: bool,
        epsilon: I16F16,
    ) -> Option<<P::Numbers as Formats>::Length> {
        let (standing, epsilon) = (self.standing(departs), P::Numbers::length(epsilon));
        let far = P::Numbers::FAR;
        match self {
            Self::Wall(wall) => wall.closest::<P, Close>(ray, &(), standing, epsilon, far),
            Self::Vast(vast) => vast.closest::<P, Close>(ray, &(), standing, epsilon, far),
            Self::Ball { sphere, .. } => {
                let prepared = SolidSphere::prepare::<P, Close>(ray, COARSEST);
                sphere.closest::<P, Close>(ray, &prepared, standing, epsilon, far)
            }
        }
    }

    /// What the tracer makes of a hit.
    pub(in crate::stability) fn interaction<P: Profile>(
        &self,
        ray: &Ray<P::Numbers>,
        departs: bool,
        t: <P::Numbers as Formats>::Length,
    ) -> Interaction<P::Numbers> {
        let standing = self.standing(departs);
        let hit = Hit {
            t,
            primitive: PrimitiveId::new(0),
        };
        match self {
            Self::Wall(wall) => wall.interaction::<P, Close>(ray, standing, hit),
            Self::Vast(vast) => vast.interaction::<P, Close>(ray, standing, hit),
            Self::Ball { sphere, .. } => sphere.interaction::<P, Close>(ray, standing, hit),
        }
    }

    fn standing(&self, departs: bool) -> Standing {
        let two_sided = matches!(self, Self::Ball { two_sided: true, .. });
        Standing { departs, two_sided }
    }

    /// The sphere in ulp; none of what is vast.
    fn exact(&self) -> Option<Sphere> {
        let record = match self {
            Self::Wall(wall) => wall.0,
            Self::Ball { sphere, .. } => sphere.sphere,
            Self::Vast(_) => return None,
        };
        Some(Sphere {
            centre: ulps(record.centre),
            radius: record.radius.to_bits().into(),
        })
    }

    /// Whether a line starts within a sphere that is not vast.
    pub(super) fn is_within(&self, line: &Line) -> bool {
        self.exact()
            .is_some_and(|sphere| Meeting::of(line, &sphere).power > 0)
    }

    /// The other end of the chord that a line starts at one end of, in ulp: not above 0 where the line leads out of the sphere.
    pub(super) fn chord(&self, line: &Line) -> f64 {
        match (self, self.exact()) {
            (Self::Vast(vast), _) => Bent::of(vast, line).chord(),
            (_, Some(sphere)) => Meeting::of(line, &sphere).chord(),
            (_, None) => f64::NAN,
        }
    }

    /// Where a line that starts on the side of a wall or ball that rays are on first meets it.
    pub(super) fn first(&self, line: &Line) -> Start {
        if let Self::Vast(vast) = self {
            let bent = Bent::of(vast, line);
            return if bent.height <= 0.0 {
                Start::Beyond
            } else {
                bent.goes_under().map_or(Start::Misses, |distance| {
                    Start::Meets(Crossing {
                        distance,
                        other: f64::INFINITY,
                        depth: bent.depth(),
                    })
                })
            };
        }
        let Some(sphere) = self.exact() else {
            return Start::Misses;
        };
        let meeting = Meeting::of(line, &sphere);
        let is_wall = matches!(self, Self::Wall(_));
        if (meeting.power > 0) != is_wall || meeting.power == 0 {
            return Start::Beyond;
        }
        if !meeting.is_met() || !is_wall && !meeting.is_ahead() {
            return Start::Misses;
        }
        let half = (meeting.far().distance() - meeting.near().distance()) / 2.0;
        let radius = sphere.radius as f64;
        let (distance, other) = if is_wall {
            (meeting.far().distance(), f64::INFINITY)
        } else {
            (meeting.near().distance(), meeting.far().distance())
        };
        Start::Meets(Crossing {
            distance,
            other,
            depth: half * half / (radius + (radius * radius - half * half).max(0.0).sqrt()),
        })
    }
}

/// How a line stands to a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// It starts on the surface or on its other side.
    Beyond,
    /// It never meets it.
    Misses,
    /// It meets it.
    Meets(Crossing),
}

/// Where a line meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// How far along, in ulp.
    pub(super) distance: f64,
    /// Where it comes out again, in ulp; nowhere of a wall or of what is vast.
    pub(super) other: f64,
    /// How deep under it the line leads, in ulp.
    pub(super) depth: f64,
}

/// A ray in ulp and 2^-30, exactly.
pub(in crate::stability) fn line_of<N: Told>(ray: &Ray<N>) -> Line {
    Line {
        start: ray.origin.map(|c| (c.into() * 65_536.0) as i64),
        direction: ray.direction.map(|c| (c.into() * f64::from(1 << 30)) as i64),
    }
}
