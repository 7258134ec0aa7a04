//! Classes of cases: a sphere, and a ray that is hard for it in one way.

use fixedmath::{I2F30, I16F16};
use tracer::arithmetic::Mixed;
use tracer::geometry::sphere::SphereRecord;
use tracer::geometry::{MaterialId, PrimitiveId, Ray};

use crate::scene::{self, Material, REACH, sphere_record};
use crate::stability::draw::{Draw, combine, dot, length, ulps, unit};
use crate::stability::exact::{Line, Meeting, Root, Sphere};

/// How a sphere's surface is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    /// From within only: the far root.
    Wall,
    /// From without only: the near root.
    Solid,
    /// From both sides.
    Glass,
}

/// A ray and a sphere.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) surface: Surface,
    pub(super) record: SphereRecord,
    pub(super) ray: Ray<Mixed>,
    /// The ray starts on the sphere, and knows it.
    pub(super) departs: bool,
}

/// A class of cases.
pub(super) struct Class {
    /// What a row is called.
    pub(super) name: &'static str,
    pub(super) surface: Surface,
    /// The name of a plot of errors by radius, where radii of all magnitudes are drawn alike.
    pub(super) plot: Option<&'static str>,
    /// Draws one.
    pub(super) draw: fn(&mut Draw) -> Case,
}

/// The smallest radius that is looked at, in units.
const SMALL: f64 = 1.0 / 256.0;
/// Radii and distances stay below what the format holds by this factor, so that a corner of the box around does, too.
const MARGIN: f64 = 0.99;
/// The largest radius of walls and glass, in units.
const WALL: f64 = REACH * MARGIN;
/// How far from the centre of a solid a ray may start, in units.
const FAR: f64 = 2.0 * REACH * MARGIN;
/// An ulp of a length, in units.
const ULP: f64 = 1.0 / 65_536.0;

/// All classes, the usual ones first.
pub(super) const CLASSES: &[Class] = &[
    Class {
        name: "wall, start within",
        surface: Surface::Wall,
        plot: Some("distance-wall"),
        draw: |draw| within(draw, Surface::Wall, SMALL, WALL),
    },
    Class {
        name: "wall of 5000 and more, start near it",
        surface: Surface::Wall,
        plot: None,
        draw: near_a_flat_wall,
    },
    Class {
        name: "ball, start without",
        surface: Surface::Solid,
        plot: Some("distance-ball"),
        draw: |draw| {
            let radius = draw.magnitude(SMALL, FAR / 2.0);
            let distance = radius + draw.magnitude(ULP, FAR - radius);
            aimed(draw, Surface::Solid, radius, distance, |draw| {
                draw.number(0.0, 1.0).sqrt()
            })
        },
    },
    Class {
        name: "ball up to 1, from 5000 to 21,600 away",
        surface: Surface::Solid,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, 1.0);
            let distance = draw.number(5000.0, FAR);
            aimed(draw, Surface::Solid, radius, distance, |draw| {
                draw.number(0.0, 1.2).sqrt()
            })
        },
    },
    Class {
        name: "ball, within 4 ulp of tangent",
        surface: Surface::Solid,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, FAR / 2.0);
            let distance = radius + draw.magnitude(ULP, FAR - radius);
            aimed(draw, Surface::Solid, radius, distance, move |draw| {
                1.0 + draw.number(-4.0, 4.0) * ULP / radius
            })
        },
    },
    Class {
        name: "ball, start 1 to 16 ulp above it",
        surface: Surface::Solid,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, FAR / 2.0);
            above(draw, Surface::Solid, radius)
        },
    },
    Class {
        name: "glass, start within",
        surface: Surface::Glass,
        plot: None,
        draw: |draw| within(draw, Surface::Glass, SMALL, WALL),
    },
    Class {
        name: "glass, start without",
        surface: Surface::Glass,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, WALL / 2.0);
            let distance = radius + draw.magnitude(ULP, WALL - radius);
            aimed(draw, Surface::Glass, radius, distance, |draw| {
                draw.number(0.0, 1.0).sqrt()
            })
        },
    },
    Class {
        name: "glass, start on it, inwards",
        surface: Surface::Glass,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, WALL);
            on(draw, Surface::Glass, radius, -1.0)
        },
    },
    Class {
        name: "wall, start on it, inwards",
        surface: Surface::Wall,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, WALL);
            on(draw, Surface::Wall, radius, -1.0)
        },
    },
    Class {
        name: "ball, start on it, outwards",
        surface: Surface::Solid,
        plot: None,
        draw: |draw| {
            let radius = draw.magnitude(SMALL, FAR / 2.0);
            on(draw, Surface::Solid, radius, 1.0)
        },
    },
];

impl Case {
    /// A sphere of this radius around a point near the scene's origin, and a ray whose start lies `start` from its centre.
    fn new(draw: &mut Draw, surface: Surface, radius: f64, start: [f64; 3], direction: [f64; 3]) -> Self {
        let centre = [(); 3].map(|()| length(draw.number(-500.0, 500.0)));
        let record = record(surface, centre, length(radius));
        Self {
            surface,
            ray: Ray {
                origin: [0, 1, 2].map(|i| centre[i] + length(start[i])),
                direction: unit(direction),
                departed: PrimitiveId::NONE,
                normal: [I2F30::ZERO; 3],
            },
            record,
            departs: false,
        }
    }

    /// The sphere in ulp.
    pub(super) fn sphere(&self) -> Sphere {
        Sphere {
            centre: ulps(self.record.centre),
            radius: self.record.radius.to_bits().into(),
        }
    }

    /// The ray in ulp.
    pub(super) fn line(&self) -> Line {
        Line {
            start: ulps(self.ray.origin),
            direction: self.ray.direction.map(|c| c.to_bits().into()),
        }
    }

    /// What a ray meets along `line`, which is its own or what a formula makes of it: the root that is a surface, in the class's sense.
    pub(super) fn truth(&self, line: &Line) -> Option<Truth> {
        let meeting = Meeting::of(line, &self.sphere());
        let within = meeting.power >= 0;
        if self.departs {
            // A start that rounding has put off its surface stands for a point of it, and beyond a wall is solid.
            return match self.surface {
                Surface::Solid => None,
                Surface::Wall => Some(self.surface_at(line, meeting.chord().max(0.0), 0.0)),
                Surface::Glass => meeting
                    .is_ahead()
                    .then(|| self.surface_at(line, meeting.chord(), 0.0)),
            };
        }
        if !meeting.is_met() {
            return None;
        }
        let met = match self.surface {
            Surface::Wall => Some(meeting.far()),
            Surface::Glass if within => Some(meeting.far()),
            Surface::Glass | Surface::Solid => (!within && meeting.is_ahead()).then(|| meeting.near()),
        };
        met.map(|root: Root| {
            let other = if root == meeting.far() {
                meeting.near()
            } else {
                meeting.far()
            };
            self.surface_at(line, root.distance(), other.distance())
        })
    }

    fn surface_at(&self, line: &Line, distance: f64, other: f64) -> Truth {
        let sphere = self.sphere();
        let direction = line.direction.map(|c| c as f64);
        let along = distance / dot(direction, direction).sqrt();
        let from_centre = [0, 1, 2].map(|i| (line.start[i] - sphere.centre[i]) as f64 + along * direction[i]);
        Truth {
            distance,
            other,
            point: [0, 1, 2].map(|i| sphere.centre[i] as f64 + from_centre[i]),
            normal: from_centre.map(|c| c / sphere.radius as f64),
        }
    }
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truth {
    /// How far along, in ulp.
    pub(super) distance: f64,
    /// Where the other root is.
    pub(super) other: f64,
    /// The point, in ulp.
    pub(super) point: [f64; 3],
    /// The outward normal there.
    pub(super) normal: [f64; 3],
}

/// The record of a sphere as the scene's compiler has it.
pub(super) fn record(surface: Surface, centre: [I16F16; 3], radius: I16F16) -> SphereRecord {
    let colour = [0.5; 3];
    let sphere = scene::Sphere {
        name: String::new(),
        centre: centre.map(f64::from),
        radius: radius.into(),
        hollow: surface == Surface::Wall,
        emission: [0.0; 3],
        material: match surface {
            Surface::Glass => Material::Glass {
                tint: colour,
                index: 1.5,
            },
            _ => Material::Diffuse(colour),
        },
    };
    sphere_record(&sphere, MaterialId::new(0))
}

/// A start anywhere within, any direction.
fn within(draw: &mut Draw, surface: Surface, smallest: f64, largest: f64) -> Case {
    loop {
        let radius = draw.magnitude(smallest, largest);
        let from_centre = radius * draw.number(0.0, 1.0).cbrt();
        let start = draw.direction().map(|c| c * from_centre);
        let direction = draw.direction();
        let case = Case::new(draw, surface, radius, start, direction);
        if Meeting::of(&case.line(), &case.sphere()).power > 0 {
            return case;
        }
    }
}

/// A wall as scenes have it, from up to 300 units before it.
fn near_a_flat_wall(draw: &mut Draw) -> Case {
    loop {
        let radius = draw.number(5000.0, WALL);
        let from_centre = radius - draw.magnitude(ULP, 300.0);
        let start = draw.direction().map(|c| c * from_centre);
        let direction = draw.direction();
        let case = Case::new(draw, Surface::Wall, radius, start, direction);
        if Meeting::of(&case.line(), &case.sphere()).power > 0 {
            return case;
        }
    }
}

/// A ray that starts outside, at `distance` from the centre, and passes it at `share` of the radius.
fn aimed(
    draw: &mut Draw,
    surface: Surface,
    radius: f64,
    distance: f64,
    share: impl Fn(&mut Draw) -> f64,
) -> Case {
    loop {
        let direction = draw.direction();
        let beside = share(draw) * radius;
        let along = (distance * distance - beside * beside).max(0.0).sqrt();
        let across = draw.across(direction);
        let start = combine(-along, direction, beside, across);
        let case = Case::new(draw, surface, radius, start, direction);
        if Meeting::of(&case.line(), &case.sphere()).power < 0 {
            return case;
        }
    }
}

/// A start up to 16 ulp above the surface, any direction.
fn above(draw: &mut Draw, surface: Surface, radius: f64) -> Case {
    loop {
        let height = draw.number(1.0, 16.0) * ULP;
        let start = draw.direction().map(|c| c * (radius + height));
        let direction = draw.direction();
        let case = Case::new(draw, surface, radius, start, direction);
        if Meeting::of(&case.line(), &case.sphere()).power < 0 {
            return case;
        }
    }
}

/// A start on the surface, rounded; outwards for a `side` of 1, inwards for -1.
fn on(draw: &mut Draw, surface: Surface, radius: f64, side: f64) -> Case {
    let normal = draw.direction();
    let direction = draw.direction();
    let turned = side * dot(direction, normal).signum();
    let start = normal.map(|c| c * radius);
    let case = Case::new(draw, surface, radius, start, direction.map(|c| c * turned));
    Case {
        ray: Ray {
            departed: PrimitiveId::new(0),
            normal: unit(normal),
            ..case.ray
        },
        departs: true,
        ..case
    }
}
