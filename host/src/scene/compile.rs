//! The scene compiler: from a description in double precision to the fixed-point blob that cores read.
//!
//! Everything that does not change during a render is worked out here: `1/r`, `r^2`, the camera's basis in the scale that
//! uses its format best, reflectance over survival. What the scene needs of the tracer comes out beside the blob.

use std::fmt;

use tracer::scene::{CameraRecord, Header, MaterialRecord, SphereRecord};

use super::light::Light;
use super::start::StartPatch;
use super::validate::is_cut_open;
use super::vector::{cross, normalised};
use super::{Camera, Material, Scene, Sphere};

/// A scene as cores get it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompiledScene {
    /// The bytes.
    pub blob: Vec<u8>,
    /// Their CRC-32, by which packets name the scene.
    pub id: u32,
    /// What the image must be built with.
    pub needs: SceneNeeds,
    /// Cores' radiance is the scene's times 2^exponent; 0 for all scenes but those whose light would not fit as it is.
    pub exponent: i32,
}

/// What a scene needs of the tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneNeeds {
    /// A diffuse surface that reflects at all.
    pub diffuse: bool,
    /// A mirror.
    pub mirror: bool,
    /// A dielectric.
    pub glass: bool,
    /// A solid that camera rays start in.
    pub two_sided: bool,
}

impl fmt::Display for SceneNeeds {
    /// The words that the firmware's build script reads, comma-separated.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = [
            (self.diffuse, "diffuse"),
            (self.mirror, "mirror"),
            (self.glass, "glass"),
            (self.two_sided, "twosided"),
        ];
        let needed: Vec<&str> = words
            .into_iter()
            .filter_map(|(needed, word)| needed.then_some(word))
            .collect();
        f.write_str(&needed.join(","))
    }
}

/// A sample lies up to this many pixels outside the film: a tent reaches a sub-pixel beyond the last one's centre.
const FILTER: f64 = 0.25;

/// Compiles a checked scene for a picture of `width` by `height` pixels.
pub fn compile(scene: &Scene, width: u16, height: u16) -> CompiledScene {
    // Hollow spheres go first: most rays end on one, and a near hit early spares roots later.
    let (hollow, solid): (Vec<&Sphere>, Vec<&Sphere>) =
        scene.spheres.iter().partition(|sphere| sphere.hollow);
    let header = Header {
        spheres: scene.spheres.len() as u16,
        hollow: hollow.len() as u16,
        camera: camera(&scene.camera, width, height),
    };
    let exponent = Light::of(scene.spheres.iter()).exponent();
    let patch = StartPatch::new(&scene.camera, width, height, FILTER);
    let mut blob = header.encode().to_vec();
    let mut two_sided = false;
    for sphere in hollow.into_iter().chain(solid) {
        let record = SphereRecord {
            two_sided: is_cut_open(sphere, &patch),
            ..record(sphere, exponent)
        };
        two_sided |= record.two_sided;
        blob.extend(record.encode());
    }
    let has = |wanted: fn(&Material) -> bool| scene.spheres.iter().any(|sphere| wanted(&sphere.material));
    let needs = SceneNeeds {
        diffuse: has(|material| matches!(material, Material::Diffuse(colour) if *colour != [0.0; 3])),
        mirror: has(|material| matches!(material, Material::Mirror(_))),
        glass: has(|material| matches!(material, Material::Glass { .. })),
        two_sided,
    };
    CompiledScene {
        id: wire::crc32(&blob),
        blob,
        needs,
        exponent,
    }
}

fn camera(camera: &Camera, width: u16, height: u16) -> CameraRecord {
    let aspect = f64::from(width) / f64::from(height);
    let right = normalised(cross(camera.direction, camera.up));
    let plane_height = camera.height_for(width, height);
    let up = cross(right, camera.direction).map(|c| c * plane_height);
    let right = right.map(|c| c * plane_height * aspect);
    let scale = film_scale(camera.direction, right, up, width, height);
    let q30 = |v: [f64; 3]| v.map(|c| (c * scale * f64::from(1 << 30)).round() as i32);
    let axis = |pixels: u16| {
        let subpixels = 2 * u32::from(pixels);
        (subpixels, (1u64 << 45) / u64::from(subpixels))
    };
    CameraRecord {
        position: camera.position.map(q16),
        forward: q30(camera.direction),
        right: q30(right),
        up: q30(up),
        near: q16(camera.near),
        columns: axis(width),
        rows: axis(height),
    }
}

/// The largest scale at which neither the film's vectors nor their sum at any sample leaves 2:30.
///
/// A direction is normalised after it is summed, so the scale is free, and a large one keeps more bits.
fn film_scale(forward: [f64; 3], right: [f64; 3], up: [f64; 3], width: u16, height: u16) -> f64 {
    // Twice what the filter needs.
    let (x, y) = (0.5 + 0.5 / f64::from(width), 0.5 + 0.5 / f64::from(height));
    let sums = (0..3).map(|i| forward[i].abs() + right[i].abs() * x + up[i].abs() * y);
    let largest = sums
        .chain(right.map(f64::abs))
        .chain(up.map(f64::abs))
        .fold(0.0, f64::max);
    1.99 / largest
}

fn record(sphere: &Sphere, exponent: i32) -> SphereRecord {
    let radius = q16(sphere.radius);
    // The shift that leaves the radius 30 bits: a point of the sphere then has no more either. From 16,384 on it has 31.
    let shift = radius.leading_zeros().saturating_sub(2);
    let reciprocal = (1i64 << 60) / (i64::from(radius) << shift);
    let (reflectance, material) = match sphere.material {
        Material::Diffuse(colour) => (colour, MaterialRecord::Diffuse),
        Material::Mirror(colour) => (colour, MaterialRecord::Mirror),
        Material::Glass { tint, index } => (tint, glass(index)),
    };
    let survival = reflectance.iter().copied().fold(0.0, f64::max);
    let survivor = reflectance.map(|c| if survival > 0.0 { c / survival } else { 0.0 });
    SphereRecord {
        centre: sphere.centre.map(q16),
        radius,
        square: i64::from(radius) * i64::from(radius),
        reciprocal: reciprocal.min(i32::MAX.into()) as i32,
        shift: shift as u8,
        two_sided: false,
        emission: sphere
            .emission
            .map(|e| (e * 2f64.powi(exponent + 16)).round() as u32),
        reflectance: reflectance.map(q0_32),
        survivor: survivor.map(q0_32),
        survival: (survival * f64::from(1 << 30)).round() as i32,
        material,
    }
}

fn glass(index: f64) -> MaterialRecord {
    let q28 = |value: f64| (value * f64::from(1 << 28)).round() as i32;
    let normal = ((index - 1.0) / (index + 1.0)).powi(2);
    MaterialRecord::Glass {
        index: q28(index),
        inverse: q28(1.0 / index),
        normal_reflectance: (normal * f64::from(1 << 30)).round() as i32,
    }
}

/// To 16:16; scene validation keeps values within it.
fn q16(value: f64) -> i32 {
    (value * 65536.0).round() as i32
}

/// To 0:32, where all ones stand for 1: the conversion saturates there.
fn q0_32(value: f64) -> u32 {
    (value * 4_294_967_296.0).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cornell() -> Scene {
        Scene::load(&crate::workspace::scene(None).unwrap()).unwrap()
    }

    #[test]
    fn cornell_needs_all_three_materials_and_decodes() {
        let compiled = compile(&cornell(), 256, 192);
        assert_eq!(compiled.needs.to_string(), "diffuse,mirror,glass");
        let scene =
            tracer::scene::Scene::<tracer::numbers::Mixed>::decode::<tracer::scene::All>(&compiled.blob)
                .unwrap();
        assert_eq!((scene.hollow().len(), scene.solid().len()), (6, 3));
    }

    #[test]
    fn a_box_without_balls_needs_only_diffuse() {
        let mut scene = cornell();
        scene
            .spheres
            .retain(|sphere| matches!(sphere.material, Material::Diffuse(_)));
        assert_eq!(compile(&scene, 8, 8).needs.to_string(), "diffuse");
    }

    #[test]
    fn radii_keep_thirty_bits_in_their_reciprocals() {
        for radius in [
            1.0 / 256.0,
            0.3,
            1.0,
            16.5,
            600.0,
            10_000.0,
            16_383.0,
            16_384.0,
            20_000.0,
            20_000.0 + 1.0 / 65536.0,
            32_767.0,
        ] {
            let mut sphere = cornell().spheres[0].clone();
            sphere.radius = radius;
            let record = record(&sphere, 0);
            let found = f64::from(record.reciprocal) * 2f64.powi(i32::from(record.shift) - 44);
            let exact = 65536.0 / f64::from(record.radius);
            assert!(
                (found / exact - 1.0).abs() < 2e-9,
                "{radius}: {found} for {exact}"
            );
        }
    }

    #[test]
    fn film_vectors_use_their_format_and_never_leave_it() {
        for (width, height) in [(256, 192), (1, 1), (4096, 16), (16, 4096)] {
            let camera = camera(&cornell().camera, width, height);
            let sum = (0..3).map(|i| {
                let half = (i64::from(camera.right[i]).abs() + i64::from(camera.up[i]).abs()) / 2;
                i64::from(camera.forward[i]).abs() + half
            });
            assert!(sum.max().unwrap() < 1 << 31, "{width}x{height}");
        }
    }
}
