//! Scenes made by hand, for tests that must not lean on the host's compiler.

use bytemuck::Zeroable;
use fixedmath::{I1F31, I2F30, I4F28, I16F16, I32F32, U0F32, U16F16, U19F45};
use tracer::camera::CameraRecord;
use tracer::geometry::Grid;
use tracer::geometry::PrimitiveSet;
use tracer::geometry::sphere::{CoarseSphere, SolidSphere, SphereRecord};
use tracer::material::{Dielectric, Kind, MaterialId, MaterialRecord};
use tracer::scene::{Capabilities, Capability, Header};

pub(crate) fn q16(value: f64) -> I16F16 {
    I16F16::from_num(value)
}

pub(crate) fn q30(value: f64) -> I2F30 {
    I2F30::from_num(value)
}

/// A ball or a room, of a material of its own.
#[derive(Clone, Copy)]
pub(crate) struct Sphere {
    pub(crate) record: SphereRecord,
    pub(crate) material: MaterialRecord,
}

/// A grey sphere that reflects `reflectance` and emits nothing.
pub(crate) fn sphere(centre: [f64; 3], radius: f64, reflectance: f64, bsdf: Kind) -> Sphere {
    let radius = I16F16::from_bits((radius * 65536.0).round() as i32);
    let bits = radius.to_bits();
    let shift = bits.leading_zeros() - 2;
    let mantissa = ((1i64 << 60) / (i64::from(bits) << shift)).min(i32::MAX.into()) as i32;
    Sphere {
        record: SphereRecord {
            square: I32F32::from_bits(i64::from(bits) * i64::from(bits)),
            centre: centre.map(q16),
            radius,
            reciprocal: I1F31::from_bits(mantissa),
            shift: shift as u8,
            has_inside: (bsdf == Kind::Dielectric).into(),
            material: MaterialId::new(0),
        },
        material: MaterialRecord {
            bsdf: bsdf as u8,
            continuation: q30(reflectance),
            emission: [U16F16::ZERO; 3],
            reflectance: [U0F32::from_bits((reflectance * 4_294_967_296.0) as u32); 3],
            continued: [U0F32::MAX; 3],
            parameters: if bsdf == Kind::Dielectric {
                bytemuck::must_cast(GLASS)
            } else {
                [0; 3]
            },
            ..MaterialRecord::zeroed()
        },
    }
}

/// Of index 3/2.
pub(crate) const GLASS: Dielectric = Dielectric {
    leaving: I4F28::from_bits(3 << 27),
    entering: I4F28::from_bits(((1i64 << 29) / 3) as i32),
    normal_reflectance: I2F30::from_bits((1 << 30) / 25),
};

/// The bytes of a scene, aligned.
#[derive(Clone)]
pub(crate) struct Blob(pub(crate) Vec<u64>);

impl Blob {
    pub(crate) fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }

    pub(crate) fn bytes_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.0)
    }
}

/// Units of an eighth: what 16 bits hold of all that 16:16 does.
pub(crate) const GRID: u32 = 17;

/// A solid sphere as it lies in a scene's bytes.
pub(crate) fn solid_sphere(grid: Grid, sphere: SphereRecord) -> SolidSphere {
    SolidSphere {
        coarse: CoarseSphere::new(grid, sphere.centre, sphere.square, I16F16::MAX),
        sphere,
    }
}

/// A scene that says it needs `needs`.
pub(crate) fn blob_for(needs: Capabilities, hollow: &[Sphere], solid: &[Sphere]) -> Blob {
    let spheres: Vec<Sphere> = hollow.iter().chain(solid).copied().collect();
    let count = spheres.len() as u16;
    let records: Vec<SphereRecord> = (0..count)
        .zip(&spheres)
        .map(|(index, sphere)| SphereRecord {
            material: MaterialId::new(index),
            ..sphere.record
        })
        .collect();
    let materials: Vec<MaterialRecord> = spheres.iter().map(|sphere| sphere.material).collect();
    // No room is claimed, and no grid that a ray could leave.
    let needs = needs.without(Capability::Room).without(Capability::Coarse);
    let grid = Grid::new(GRID);
    let (hollow_spheres, solid_spheres) = records.split_at(hollow.len());
    let solid_spheres: Vec<SolidSphere> = solid_spheres
        .iter()
        .map(|&record| solid_sphere(grid, record))
        .collect();
    let header = Header::new(
        needs,
        count,
        grid,
        [hollow.len() as u16, solid.len() as u16, 0],
        [0; 3],
    );
    let bytes = [
        bytemuck::bytes_of(&header),
        bytemuck::cast_slice(hollow_spheres),
        bytemuck::cast_slice(&solid_spheres),
        bytemuck::cast_slice(&materials),
    ]
    .concat();
    let mut blob = Blob(vec![0; bytes.len().div_ceil(8)]);
    blob.bytes_mut().copy_from_slice(&bytes);
    blob
}

/// A scene that needs all that can be needed.
pub(crate) fn blob(hollow: &[Sphere], solid: &[Sphere]) -> Blob {
    blob_for(Capabilities::ALL, hollow, solid)
}

/// A camera at the origin that looks along +z; its film is a unit square at distance 1.
pub(crate) fn camera(pixels: u16) -> CameraRecord {
    let subpixels = 2 * u32::from(pixels);
    CameraRecord {
        reciprocals: [U19F45::from_bits((1 << 45) / u64::from(subpixels)); 2],
        subpixels: [subpixels; 2],
        forward: [q30(0.0), q30(0.0), q30(1.0)],
        right: [q30(1.0), q30(0.0), q30(0.0)],
        up: [q30(0.0), q30(1.0), q30(0.0)],
        opened: PrimitiveSet::EMPTY,
        ..CameraRecord::zeroed()
    }
}
