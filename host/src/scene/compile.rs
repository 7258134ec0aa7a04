//! The scene compiler: from a description in double precision to the fixed-point records that cores read.
//!
//! Everything that does not change during a render is worked out here: `1/r`, `r^2`, the camera's basis in the scale that
//! uses its format best, reflectance over continuation probability. What the scene needs of the tracer comes out beside it.

use fixedmath::{I1F31, I4F28, I16F16, I32F32, U16F16, U19F45};
use tracer::camera::CameraRecord;
use tracer::geometry::sphere::{HollowSphere, SolidSphere, SphereRecord, VastSphere};
use tracer::geometry::{PrimitiveId, PrimitiveSet, Shape};
use tracer::material::{Bsdf, Dielectric, Kind, MaterialId, MaterialRecord};
use tracer::scene::{Capabilities, Capability, Header, MAX_LIGHT_BYTES};

use super::emitters::Emitters;
use super::fixed::{q0_32, q16, q30};
use super::guides::Guides;
use super::light::Light;
use super::proof::Proved;
use super::scale::{LONGEST, Scale};
use super::start::StartPatch;
use super::validate::is_cut_open;
use super::vast;
use super::vector::{cross, normalised};
use super::{Camera, Integrator, Material, Scene, Sphere};

/// A scene as cores get it, and a view of it.
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledScene {
    /// The scene's bytes, the same wherever it is seen from.
    pub blob: Blob,
    /// Their CRC-32, by which packets name the scene.
    pub id: u32,
    /// Where it is seen from, at which size of the picture.
    pub camera: CameraRecord,
    /// What the image must be built with for scene and camera.
    pub needs: Capabilities,
    /// How cores' lengths come from the scene's.
    pub scale: Scale,
    /// Cores' radiance is the scene's times 2^exponent; 0 for all scenes but those whose light would not fit as it is.
    pub exponent: i32,
}

impl CompiledScene {
    /// Whether its hollow spheres are proved to be a room.
    pub fn is_room(&self) -> bool {
        self.needs.has(Capability::Room)
    }

    /// Whether cores look at its solids roughly first.
    pub fn has_coarse_solids(&self) -> bool {
        self.needs.has(Capability::Coarse)
    }

    /// The scene as cores read it, seen from its camera.
    ///
    /// # Panics
    /// Never for what [`compile`] made.
    pub fn view(&self) -> tracer::scene::Scene<'_> {
        tracer::scene::Scene::view(self.blob.bytes(), self.needs)
            .and_then(|scene| scene.seen_from(&self.camera, self.needs))
            .expect("compiler and tracer agree")
    }
}

/// Bytes that are aligned as cores need it, to 8.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Blob(Vec<u64>);

impl Blob {
    /// Copies them, with zeros to a multiple of 8.
    pub fn new(bytes: &[u8]) -> Self {
        let mut words = vec![0; bytes.len().div_ceil(8)];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self(words)
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }
}

const _: () = assert!(
    wire::boot::encoded_len(size_of::<CameraRecord>(), tracer::scene::MAX_BYTES) <= wire::boot::MAX_LEN,
    "a scene of as many spheres as there may be fits the boot block"
);

/// A sample lies up to this many pixels outside the film: a tent reaches a sub-pixel beyond the last one's centre.
const FILTER: f64 = 0.25;

/// Compiles a checked scene, and its camera for a picture of `width` by `height` pixels, for this integrator.
///
/// # Panics
/// If the scene is too wide for a core, which a checked one is not.
pub fn compile(scene: &Scene, width: u16, height: u16, integrator: Integrator) -> CompiledScene {
    let scale = scene.scale();
    let (integrator, light) = light_for(scene, integrator);
    let exponent = light.exponent();
    let scene = near_origin(scale.applied(scene), scale);
    let all: Vec<&Sphere> = scene.spheres.iter().collect();
    let extent = scale.extent(&all, &scene.camera);
    // Hollow spheres go first: most rays end on one, and a near hit early spares roots later.
    let (vast, ordinary): (Vec<&Sphere>, Vec<&Sphere>) =
        all.iter().partition(|sphere| scale.is_vast(sphere.radius));
    let (hollow, solid): (Vec<&Sphere>, Vec<&Sphere>) =
        ordinary.into_iter().partition(|sphere| sphere.hollow);
    let counts = [hollow.len(), solid.len(), vast.len()].map(|count| count as u16);
    let spheres = [&hollow[..], &solid[..], &vast[..]].concat();
    let mut materials = Vec::new();
    let mut id_of = |sphere: &Sphere| material_id(&mut materials, material(sphere, exponent));
    let mut record_of = |sphere: &&Sphere| record(sphere, id_of(sphere));
    let hollow_records: Vec<SphereRecord> = hollow.iter().map(&mut record_of).collect();
    let solid_records: Vec<SphereRecord> = solid.iter().map(&mut record_of).collect();
    let middle = (!vast.is_empty()).then(|| extent.middle.map(q16));
    let proved = Proved::of(&extent, middle, hollow_records, solid_records);
    let vast_records: Vec<VastSphere> = vast
        .iter()
        .map(|sphere| vast::record(sphere, extent.middle, proved.origin, id_of(sphere)))
        .collect();
    let (mut emitters, mut guides) = (Emitters::default(), Guides::default());
    if integrator == Integrator::NextEvent {
        let records = proved.records();
        // With shapes of all kinds an image has no room for balls that are looked for, nor for guides.
        let is_crowded = !hollow.is_empty() && !vast.is_empty();
        emitters = Emitters::of(&spheres, &records, &extent, MAX_LIGHT_BYTES, !is_crowded);
        // A core's code memory holds one of them.
        if emitters.balls.is_empty() && !is_crowded {
            guides = Guides::of(&spheres, &records, &emitters, &extent);
            guides.compensate(&mut materials, &mut emitters);
        }
    }
    let needs = needs(&hollow, &solid, &vast)
        .union(proved.needs())
        .union(emitters.needs())
        .union(guides.needs());
    let [caps, balls] = emitters.counts();
    let lights = [caps, balls, guides.records.len() as u16];
    let header = Header::new(needs, materials.len() as u16, proved.grid, counts, lights);
    let blob = [
        bytemuck::bytes_of(&header),
        bytemuck::cast_slice(proved.room.as_slice()),
        bytemuck::cast_slice(&proved.hollow_spheres),
        bytemuck::cast_slice(&proved.solid_spheres),
        bytemuck::cast_slice(&vast_records),
        bytemuck::cast_slice(&materials),
        bytemuck::cast_slice(&emitters.caps),
        bytemuck::cast_slice(&emitters.balls),
        bytemuck::cast_slice(&guides.records),
    ]
    .concat();
    let blob = Blob::new(&blob);
    let camera = CameraRecord {
        opened: opened(&scene, &spheres, width, height),
        ..camera(&scene.camera, proved.origin, width, height)
    };
    CompiledScene {
        id: wire::crc32(blob.bytes()),
        needs: needs.union(camera.needs()),
        blob,
        camera,
        scale,
        exponent,
    }
}

/// The scene's light for this integrator; where that would lose the dimmest, for paths that meet light alone.
fn light_for(scene: &Scene, integrator: Integrator) -> (Integrator, Light) {
    let light = Light::of(scene.spheres.iter(), integrator);
    if light.too_faint().is_some() {
        (
            Integrator::Path,
            Light::of(scene.spheres.iter(), Integrator::Path),
        )
    } else {
        (integrator, light)
    }
}

/// The scene itself where 16:16 holds its coordinates; else the same around the origin, moved by a whole number of units.
fn near_origin(scene: Scene, scale: Scale) -> Scene {
    let fits = |point: [f64; 3]| point.iter().all(|c| c.abs() < LONGEST);
    let ordinary = |sphere: &&Sphere| !scale.is_vast(sphere.radius);
    let mut points = scene.spheres.iter().filter(ordinary).map(|sphere| sphere.centre);
    let spheres: Vec<&Sphere> = scene.spheres.iter().collect();
    let middle = scale.extent(&spheres, &scene.camera).middle;
    if fits(middle) && fits(scene.camera.position) && points.all(fits) {
        return scene;
    }
    let away = middle.map(f64::round);
    scene.moved(away.map(|c| -c))
}

fn camera(camera: &Camera, origin: [I16F16; 3], width: u16, height: u16) -> CameraRecord {
    let aspect = f64::from(width) / f64::from(height);
    let right = normalised(cross(camera.direction, camera.up));
    let plane_height = camera.height_for(width, height);
    let up = cross(right, camera.direction).map(|c| c * plane_height);
    let right = right.map(|c| c * plane_height * aspect);
    let scale = film_scale(camera.direction, right, up, width, height);
    let scaled = |v: [f64; 3]| v.map(|c| q30(c * scale));
    let subpixels = [width, height].map(|pixels| 2 * u32::from(pixels));
    CameraRecord {
        reciprocals: subpixels.map(|count| U19F45::from_bits((1 << 45) / u64::from(count))),
        subpixels,
        position: [0, 1, 2].map(|i| q16(camera.position[i]) - origin[i]),
        near: q16(camera.near),
        forward: scaled(camera.direction),
        right: scaled(right),
        up: scaled(up),
        reserved: 0,
        opened: PrimitiveSet::EMPTY,
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

/// The record of a sphere.
pub(crate) fn record(sphere: &Sphere, material: MaterialId) -> SphereRecord {
    let radius = q16(sphere.radius);
    let bits = radius.to_bits();
    // The shift that leaves the radius 30 bits: a point of the sphere then has no more either. From 16,384 on it has 31.
    let shift = bits.leading_zeros().saturating_sub(2);
    let reciprocal = (1i64 << 60) / (i64::from(bits) << shift);
    SphereRecord {
        square: I32F32::from_bits(i64::from(bits) * i64::from(bits)),
        centre: sphere.centre.map(q16),
        radius,
        reciprocal: I1F31::from_bits(reciprocal.min(i32::MAX.into()) as i32),
        shift: shift as u8,
        has_inside: matches!(sphere.material, Material::Glass { .. }).into(),
        material,
    }
}

/// The record of a sphere's material, for light of this common exponent.
pub(crate) fn material(sphere: &Sphere, exponent: i32) -> MaterialRecord {
    let (reflectance, bsdf, parameters) = match sphere.material {
        Material::Diffuse(colour) => (colour, Kind::Diffuse, [0; 3]),
        Material::Mirror(colour) => (colour, Kind::Mirror, [0; 3]),
        Material::Glass { tint, index } => (tint, Kind::Dielectric, bytemuck::must_cast(dielectric(index))),
    };
    let continuation = reflectance.iter().copied().fold(0.0, f64::max);
    let continued = reflectance.map(|c| if continuation > 0.0 { c / continuation } else { 0.0 });
    let emission = sphere
        .emission
        .map(|e| U16F16::from_bits((e * 2f64.powi(exponent + 16)).round() as u32));
    MaterialRecord {
        bsdf: bsdf as u8,
        emits: emission.iter().any(|channel| *channel != U16F16::ZERO).into(),
        reserved: 0,
        continuation: q30(continuation),
        emission,
        reflectance: reflectance.map(q0_32),
        continued: continued.map(q0_32),
        parameters,
    }
}

/// The id of `material` in the table, where it is put if it is new.
fn material_id(table: &mut Vec<MaterialRecord>, material: MaterialRecord) -> MaterialId {
    let known = table.iter().position(|known| *known == material);
    let index = known.unwrap_or_else(|| {
        table.push(material);
        table.len() - 1
    });
    MaterialId::new(index as u16)
}

fn dielectric(index: f64) -> Dielectric {
    let q28 = |value: f64| I4F28::from_bits((value * f64::from(1 << 28)).round() as i32);
    Dielectric {
        leaving: q28(index),
        entering: q28(1.0 / index),
        normal_reflectance: q30(((index - 1.0) / (index + 1.0)).powi(2)),
    }
}

/// What the scene needs of the tracer, wherever it is seen from.
fn needs(hollow: &[&Sphere], solid: &[&Sphere], vast: &[&Sphere]) -> Capabilities {
    let shapes = [
        (hollow, HollowSphere::CAPABILITY),
        (solid, SolidSphere::CAPABILITY),
        (vast, VastSphere::CAPABILITY),
    ];
    shapes
        .into_iter()
        .fold(Capabilities::NONE, |needs, (spheres, shape)| {
            spheres.iter().fold(needs, |needs, sphere| {
                needs.with(shape).union(of_material(sphere))
            })
        })
}

fn of_material(sphere: &Sphere) -> Capabilities {
    match sphere.material {
        // What only absorbs takes no code.
        Material::Diffuse([0.0, 0.0, 0.0]) => Capabilities::NONE,
        Material::Diffuse(_) => Capabilities::of(&[tracer::material::Diffuse::CAPABILITY]),
        Material::Mirror(_) => Capabilities::of(&[tracer::material::Mirror::CAPABILITY]),
        Material::Glass { .. } => Capabilities::of(&[Dielectric::CAPABILITY, Capability::Inside]),
    }
}

/// The solids that rays start within.
fn opened(scene: &Scene, spheres: &[&Sphere], width: u16, height: u16) -> PrimitiveSet {
    let patch = StartPatch::new(&scene.camera, width, height, FILTER);
    let mut opened = PrimitiveSet::EMPTY;
    for (index, sphere) in spheres.iter().enumerate() {
        if is_cut_open(sphere, &patch) {
            opened.insert(PrimitiveId::new(index));
        }
    }
    opened
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cornell() -> Scene {
        Scene::load(&crate::platform::workspace::scene(None).unwrap()).unwrap()
    }

    #[test]
    fn cornell_needs_all_three_materials_and_decodes() {
        let compiled = compile(&cornell(), 256, 192, Integrator::Path);
        assert_eq!(
            compiled.needs.to_string(),
            "hollow,room,solid,coarse,inside,diffuse,mirror,glass"
        );
        let primitives = compiled.view().aggregate.primitives;
        assert_eq!(
            (primitives.hollow_spheres.len(), primitives.solid_spheres.len()),
            (6, 3)
        );
    }

    #[test]
    fn a_box_without_balls_needs_only_diffuse() {
        let mut scene = cornell();
        scene
            .spheres
            .retain(|sphere| matches!(sphere.material, Material::Diffuse(_)));
        // The lamp is solid, and black.
        assert_eq!(
            compile(&scene, 8, 8, Integrator::Path).needs.to_string(),
            "hollow,room,solid,diffuse"
        );
    }

    /// A moved camera, and a picture of another size, see the same scene; even where they cut a ball open.
    #[test]
    fn a_scene_is_the_same_wherever_it_is_seen_from() {
        let mut scene = cornell();
        let there = compile(&scene, 256, 192, Integrator::Path);
        scene.camera.position = scene.spheres[6].centre;
        scene.camera.near = 0.5;
        let inside = compile(&scene, 64, 64, Integrator::Path);
        assert_eq!((inside.id, &inside.blob), (there.id, &there.blob));
        assert_ne!(inside.camera, there.camera);
        assert!(inside.needs.has(Capability::TwoSided) && !there.needs.has(Capability::TwoSided));
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
            let record = record(&sphere, MaterialId::new(0));
            let found = record.reciprocal.to_num::<f64>() * 2f64.powi(i32::from(record.shift) - 13);
            let exact = 1.0 / record.radius.to_num::<f64>();
            assert!(
                (found / exact - 1.0).abs() < 2e-9,
                "{radius}: {found} for {exact}"
            );
        }
    }

    #[test]
    fn film_vectors_use_their_format_and_never_leave_it() {
        for (width, height) in [(256, 192), (1, 1), (4096, 16), (16, 4096)] {
            let camera = camera(&cornell().camera, [I16F16::ZERO; 3], width, height);
            let sum = (0..3).map(|i| {
                let [forward, right, up] = [camera.forward, camera.right, camera.up]
                    .map(|vector| i64::from(vector[i].to_bits()).abs());
                forward + (right + up) / 2
            });
            assert!(sum.max().unwrap() < 1 << 31, "{width}x{height}");
        }
    }
}
