//! What stands next to a surface, a few ulp in front of where a ray leaves it.

use super::body::{Body, sphere};
use super::classes::{LARGE, SMALL, ULP, VAST};
use crate::scene::Material;
use crate::stability::draw::{Draw, combine};

/// What neighbours there are.
pub(super) const KINDS: [&str; 6] = [
    "ball",
    "glass ball",
    "wall",
    "concentric",
    "vast ball",
    "vast wall",
];

const DIFFUSE: Material = Material::Diffuse([0.5; 3]);
const GLASS: Material = Material::Glass {
    tint: [0.5; 3],
    index: 1.5,
};

/// Where a ray leaves a surface, in units.
pub(super) struct Place {
    pub(super) point: [f64; 3],
    /// The normal on the side it leaves to.
    pub(super) normal: [f64; 3],
    /// Centre and radius of the sphere it leaves, and whether to its inside; none of a vast one.
    pub(super) sphere: Option<([f64; 3], f64, bool)>,
}

/// A neighbour of the given kind; none where there is none of it.
pub(super) fn neighbour(draw: &mut Draw, place: &Place, kind: usize) -> Option<Body> {
    // Every whole number of ulp up to 16 alike, or any magnitude up to an eighth of a unit.
    let gap = if draw.number(0.0, 1.0) < 0.5 {
        draw.number(1.0, 17.0).floor() * ULP
    } else {
        draw.magnitude(ULP, 0.125)
    };
    let along = |distance: f64| combine(1.0, place.point, distance, place.normal);
    let ball =
        |radius: f64, material| Body::usual(&sphere(along(radius + gap), radius, false, material), false);
    let wall = |radius: f64| sphere(along(gap - radius), radius, true, DIFFUSE);
    Some(match KINDS[kind] {
        "ball" => ball(draw.magnitude(SMALL, LARGE), DIFFUSE),
        "glass ball" => ball(draw.magnitude(SMALL, LARGE), GLASS),
        "wall" => Body::usual(&wall(draw.magnitude(SMALL.max(gap), LARGE)), false),
        "concentric" => {
            let (centre, radius, inwards) = place.sphere?;
            let radius = if inwards { radius - gap } else { radius + gap };
            (radius > ULP).then(|| Body::usual(&sphere(centre, radius, !inwards, DIFFUSE), false))?
        }
        "vast ball" => {
            let radius = draw.magnitude(VAST[0], VAST[1]);
            Body::vast(&sphere(along(radius + gap), radius, false, DIFFUSE), place.point)
        }
        _ => Body::vast(&wall(draw.magnitude(VAST[0], VAST[1])), place.point),
    })
}
