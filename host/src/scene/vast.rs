//! Records of vast spheres.

use fixedmath::I16F16;
use tracer::geometry::sphere::{Bend, VastSphere};
use tracer::material::MaterialId;

use super::fixed::{q16, q30};
use super::vector::{length, scaled, sub};
use super::{Material, Sphere};

/// The record of a sphere in a core's unit, around its scene's `middle`, for a tracer with this origin.
pub(crate) fn record(
    sphere: &Sphere,
    middle: [f64; 3],
    origin: [I16F16; 3],
    material: MaterialId,
) -> VastSphere {
    let outward = sub(middle, sphere.centre);
    let distance = length(outward);
    // In the centre one point of it is as near as another.
    let outward = if distance > 0.0 {
        scaled(outward, 1.0 / distance)
    } else {
        [0.0, 1.0, 0.0]
    };
    let pole = [0, 1, 2].map(|i| sphere.centre[i] + sphere.radius * outward[i]);
    let normal = if sphere.hollow {
        scaled(outward, -1.0)
    } else {
        outward
    };
    VastSphere {
        pole: [0, 1, 2].map(|i| q16(pole[i]) - origin[i]),
        normal: normal.map(q30),
        bend: bend(sphere.radius, sphere.hollow),
        has_inside: matches!(sphere.material, Material::Glass { .. }).into(),
        reserved: 0,
        material,
    }
}

/// The bend of a sphere of this radius, at least 2^14.
///
/// From a radius of 2^45 on it is a plane within 2^-17 wherever a scene can be, and no ray comes back to it.
fn bend(radius: f64, towards: bool) -> Bend {
    let shift = (radius.log2().floor() as i32 - 14).clamp(0, 30);
    // Casts of floats are cut to the integer's range.
    let mantissa = (radius * 2f64.powi(16 - shift)) as i32;
    let curvature = (2f64.powi(44) / radius).round() as i32;
    let sign = if towards { 1 } else { -1 };
    Bend {
        curvature: sign * curvature,
        radius: sign * mantissa,
        shift: shift as u32,
    }
}
