//! Shapes with a material, and rays that meet them.

use fixedmath::I2F30;
use tracer::arithmetic::Mixed;
use tracer::geometry::{PrimitiveId, Ray};

use super::body::{Body, Start, line_of, sphere};
use crate::scene::{Material, REACH};
use crate::stability::draw::{Draw, combine, length, unit};

/// A body, and a ray that may meet it.
pub(in crate::stability) type Drawn = (Body, Ray<Mixed>);

/// A shape with a material, and from which side rays come.
pub(super) struct Class {
    /// What rows are called.
    pub(super) name: &'static str,
    pub(super) material: Material,
    /// Draws a body of it, and a ray that may meet it.
    pub(super) draw: fn(&mut Draw, &Material) -> Drawn,
}

const GREY: [f64; 3] = [0.5; 3];
pub(in crate::stability) const DIFFUSE: Material = Material::Diffuse(GREY);
const MIRROR: Material = Material::Mirror(GREY);
const GLASS: Material = Material::Glass {
    tint: GREY,
    index: 1.5,
};

/// All of them.
pub(super) const CLASSES: &[Class] = &[
    Class {
        name: "wall, diffuse",
        material: DIFFUSE,
        draw: wall,
    },
    Class {
        name: "wall, mirror",
        material: MIRROR,
        draw: wall,
    },
    Class {
        name: "ball, diffuse",
        material: DIFFUSE,
        draw: ball,
    },
    Class {
        name: "ball, mirror",
        material: MIRROR,
        draw: ball,
    },
    Class {
        name: "glass ball",
        material: GLASS,
        draw: glass,
    },
    Class {
        name: "two-sided ball, diffuse",
        material: DIFFUSE,
        draw: two_sided,
    },
    Class {
        name: "two-sided ball, mirror",
        material: MIRROR,
        draw: two_sided,
    },
    Class {
        name: "vast wall, diffuse",
        material: DIFFUSE,
        draw: vast_wall,
    },
    Class {
        name: "vast wall, mirror",
        material: MIRROR,
        draw: vast_wall,
    },
    Class {
        name: "vast ball, diffuse",
        material: DIFFUSE,
        draw: vast_ball,
    },
    Class {
        name: "vast ball, mirror",
        material: MIRROR,
        draw: vast_ball,
    },
    Class {
        name: "vast ball of glass",
        material: GLASS,
        draw: vast_ball,
    },
];

/// The smallest radius, in units.
pub(super) const SMALL: f64 = 1.0 / 256.0;
/// The largest one of a sphere that is not vast, in units.
pub(super) const LARGE: f64 = 1e4;
/// The smallest vast radius, in units, and the largest.
pub(super) const VAST: [f64; 2] = [2.0 * REACH, 1e5];
/// How far from the centre of a ball a ray may start, in units: what the format has room for, less a hundredth.
const FAR: f64 = 2.0 * REACH * 0.99;
/// How far from a scene's middle its surfaces are, where they are vast, in units.
const ROOM: f64 = 300.0;
/// An ulp, in units.
pub(super) const ULP: f64 = 1.0 / 65_536.0;

fn wall(draw: &mut Draw, material: &Material) -> Drawn {
    let radius = draw.magnitude(SMALL, LARGE);
    round(draw, material, radius, true, false, true)
}

fn ball(draw: &mut Draw, material: &Material) -> Drawn {
    let radius = draw.magnitude(SMALL, LARGE);
    round(draw, material, radius, false, false, false)
}

fn glass(draw: &mut Draw, material: &Material) -> Drawn {
    let radius = draw.magnitude(SMALL, LARGE);
    let within = is_even(draw);
    round(draw, material, radius, false, false, within)
}

fn two_sided(draw: &mut Draw, material: &Material) -> Drawn {
    let radius = draw.magnitude(SMALL, LARGE);
    let within = is_even(draw);
    round(draw, material, radius, false, true, within)
}

pub(in crate::stability) fn vast_wall(draw: &mut Draw, material: &Material) -> Drawn {
    vast(draw, material, true)
}

pub(in crate::stability) fn vast_ball(draw: &mut Draw, material: &Material) -> Drawn {
    vast(draw, material, false)
}

fn is_even(draw: &mut Draw) -> bool {
    draw.number(0.0, 1.0) < 0.5
}

/// A direction to a surface whose normal on the ray's side is `normal`: any, or in one of four cases one that grazes it.
fn towards(draw: &mut Draw, normal: [f64; 3]) -> [f64; 3] {
    if draw.number(0.0, 1.0) < 0.75 {
        return draw.direction();
    }
    let sine = draw.magnitude(1e-6, 1.0);
    let across = draw.across(normal);
    combine((1.0 - sine * sine).sqrt(), across, -sine, normal)
}

fn ray(start: [f64; 3], direction: [f64; 3]) -> Ray<Mixed> {
    Ray {
        origin: start.map(length),
        direction: unit(direction),
        departed: PrimitiveId::NONE,
        normal: [I2F30::ZERO; 3],
    }
}

/// A sphere that is not vast, and a ray that passes through a point next to its surface, or starts there.
fn round(
    draw: &mut Draw,
    material: &Material,
    radius: f64,
    hollow: bool,
    two_sided: bool,
    within: bool,
) -> Drawn {
    loop {
        let centre = [(); 3].map(|()| draw.number(-300.0, 300.0));
        let outward = draw.direction();
        let side = if within { -1.0 } else { 1.0 };
        let direction = towards(draw, outward.map(|c| side * c));
        // From within a ray may start at the far side.
        let farthest = if within { 2.0 * radius } else { FAR - radius };
        let back = draw.magnitude(4.0 * ULP, farthest);
        let start = [0, 1, 2].map(|i| centre[i] + radius * outward[i] - back * direction[i]);
        let body = Body::usual(&sphere(centre, radius, hollow, *material), two_sided);
        let ray = ray(start, direction);
        if body.is_within(&line_of(&ray)) == within {
            return (body, ray);
        }
    }
}

/// A vast sphere, and a ray near it.
fn vast(draw: &mut Draw, material: &Material, hollow: bool) -> Drawn {
    loop {
        let radius = draw.magnitude(VAST[0], VAST[1]);
        let to_centre = draw.direction();
        let height = draw.magnitude(ULP, ROOM);
        let distance = if hollow { radius - height } else { radius + height };
        let centre = to_centre.map(|c| c * distance);
        let body = Body::vast(&sphere(centre, radius, hollow, *material), [0.0; 3]);
        let up = to_centre.map(|c| if hollow { c } else { -c });
        let along = draw.across(up);
        let aside = draw.magnitude(ULP, 10.0 * ROOM);
        let lift = draw.magnitude(ULP, ROOM) - height;
        let is_glass = matches!(material, Material::Glass { .. });
        let below = is_glass && is_even(draw);
        let lift = if below {
            -height - draw.magnitude(ULP, ROOM)
        } else {
            lift
        };
        let start = combine(aside, along, lift, up);
        let direction = towards(draw, up.map(|c| if below { -c } else { c }));
        let ray = ray(start, direction);
        let is_beyond = matches!(body.first(&line_of(&ray)), Start::Beyond);
        if is_beyond == below {
            return (body, ray);
        }
    }
}
