//! Scenes made by hand, for tests that must not lean on the host's compiler.

use tracer::scene::{CameraRecord, Header, MaterialRecord, SphereRecord};

pub(crate) fn q16(value: f64) -> i32 {
    (value * 65536.0).round() as i32
}

pub(crate) fn q30(value: f64) -> i32 {
    (value * f64::from(1 << 30)).round() as i32
}

/// A grey sphere that reflects `reflectance` and emits nothing.
pub(crate) fn sphere(
    centre: [f64; 3],
    radius: f64,
    reflectance: f64,
    material: MaterialRecord,
) -> SphereRecord {
    let bits = q16(radius);
    let shift = bits.leading_zeros() - 2;
    SphereRecord {
        centre: centre.map(q16),
        radius: bits,
        square: i64::from(bits) * i64::from(bits),
        reciprocal: ((1i64 << 60) / (i64::from(bits) << shift)).min(i32::MAX.into()) as i32,
        shift: shift as u8,
        two_sided: false,
        emission: [0; 3],
        reflectance: [(reflectance * 4_294_967_296.0) as u32; 3],
        survivor: [u32::MAX; 3],
        survival: q30(reflectance),
        material,
    }
}

pub(crate) const GLASS: MaterialRecord = MaterialRecord::Glass {
    index: 3 << 27,
    inverse: ((1i64 << 29) / 3) as i32,
    normal_reflectance: (1 << 30) / 25,
};

/// A blob seen from `position` along +z by a camera whose film is a unit square at distance 1.
pub(crate) fn blob(
    position: [f64; 3],
    hollow: &[SphereRecord],
    solid: &[SphereRecord],
    pixels: u16,
) -> Vec<u8> {
    let subpixels = 2 * u32::from(pixels);
    let axis = (subpixels, (1u64 << 45) / u64::from(subpixels));
    let header = Header {
        spheres: (hollow.len() + solid.len()) as u16,
        hollow: hollow.len() as u16,
        camera: CameraRecord {
            position: position.map(q16),
            forward: [0, 0, q30(1.0)],
            right: [q30(1.0), 0, 0],
            up: [0, q30(1.0), 0],
            near: 0,
            columns: axis,
            rows: axis,
        },
    };
    let mut blob = header.encode().to_vec();
    hollow
        .iter()
        .chain(solid)
        .for_each(|sphere| blob.extend(sphere.encode()));
    blob
}
