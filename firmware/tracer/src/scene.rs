//! The compiled scene: a blob the host writes, and what a tracer decodes from it.

mod blob;

pub use blob::{BlobError, CameraRecord, HEADER_BYTES, Header, MaterialRecord, SPHERE_BYTES, SphereRecord};

use crate::camera::{Axis, Camera};
use crate::material::{Bsdf, Dielectric, Surface};
use crate::numbers::Numbers;
use crate::sphere::Sphere;

/// Spheres in a scene, at most: what a core's data memory holds beside its stacks.
pub const MAX_SPHERES: usize = 64;

/// What a scene needs of the tracer; code for the rest is not in the image.
pub trait Needs {
    /// A diffuse surface.
    const DIFFUSE: bool;
    /// A mirror.
    const MIRROR: bool;
    /// A dielectric.
    const GLASS: bool;
    /// A solid that camera rays start in.
    const TWOSIDED: bool;
    /// Russian roulette; otherwise paths end at a fixed depth.
    const ROULETTE: bool;
}

/// Everything the tracer can do; for hosts, where code size is no matter.
#[derive(Clone, Copy, Debug)]
pub enum All {}

impl Needs for All {
    const DIFFUSE: bool = true;
    const MIRROR: bool = true;
    const GLASS: bool = true;
    const TWOSIDED: bool = true;
    const ROULETTE: bool = true;
}

/// A scene in the formats of `N`.
#[derive(Debug)]
pub struct Scene<N: Numbers> {
    /// The camera.
    pub camera: Camera<N>,
    spheres: [Sphere<N>; MAX_SPHERES],
    hollow: usize,
    count: usize,
}

impl<N: Numbers> Scene<N> {
    /// Decodes a blob written by the host's scene compiler, for an image built with `F`.
    pub fn decode<F: Needs>(blob: &[u8]) -> Result<Self, BlobError> {
        let mut scene = Self::empty();
        scene.load::<F>(blob)?;
        Ok(scene)
    }

    /// A scene without spheres, to be loaded.
    pub fn empty() -> Self {
        Self {
            camera: Camera::of_record(&CameraRecord::default()),
            spheres: [Sphere::of_record(&SphereRecord::default(), false); MAX_SPHERES],
            hollow: 0,
            count: 0,
        }
    }

    /// As [`Scene::decode`], into a scene that already has its place: a second copy would be a quarter of a core's stack.
    ///
    /// After an error the scene is empty.
    pub fn load<F: Needs>(&mut self, blob: &[u8]) -> Result<(), BlobError> {
        (self.hollow, self.count) = (0, 0);
        let (header, rest) = Header::decode(blob)?;
        let (hollow, count) = (usize::from(header.hollow), usize::from(header.spheres));
        if count > MAX_SPHERES || hollow > count || rest.len() != count * SPHERE_BYTES {
            return Err(BlobError::BadCounts);
        }
        for (i, (sphere, bytes)) in self
            .spheres
            .iter_mut()
            .zip(rest.chunks_exact(SPHERE_BYTES))
            .enumerate()
        {
            let record = SphereRecord::decode(bytes)?;
            let supported = match record.material {
                MaterialRecord::Diffuse => F::DIFFUSE || record.survival == 0,
                MaterialRecord::Mirror => F::MIRROR,
                MaterialRecord::Glass { .. } => F::GLASS,
            };
            if !supported || (record.two_sided && !F::TWOSIDED) {
                return Err(BlobError::NotInThisImage);
            }
            *sphere = Sphere::of_record(&record, i < hollow);
        }
        self.camera = Camera::of_record(&header.camera);
        (self.hollow, self.count) = (hollow, count);
        Ok(())
    }

    /// All spheres, hollow ones first.
    pub fn spheres(&self) -> &[Sphere<N>] {
        self.spheres.get(..self.count).unwrap_or_default()
    }

    /// The spheres seen from inside.
    pub fn hollow(&self) -> &[Sphere<N>] {
        self.spheres.get(..self.hollow).unwrap_or_default()
    }

    /// The spheres seen from outside.
    pub fn solid(&self) -> &[Sphere<N>] {
        self.spheres.get(self.hollow..self.count).unwrap_or_default()
    }
}

impl<N: Numbers> Sphere<N> {
    fn of_record(record: &SphereRecord, hollow: bool) -> Self {
        let bsdf = match record.material {
            MaterialRecord::Diffuse => Bsdf::Diffuse,
            MaterialRecord::Mirror => Bsdf::Mirror,
            MaterialRecord::Glass {
                index,
                inverse,
                normal_reflectance,
            } => {
                let (entering, leaving) = (N::ratio(inverse), N::ratio(index));
                Bsdf::Glass(Dielectric {
                    entering,
                    entering_squared: N::ratio_squared(entering),
                    leaving,
                    leaving_squared: N::ratio_squared(leaving),
                    normal_reflectance: N::unit(normal_reflectance),
                })
            }
        };
        Self {
            centre: record.centre.map(N::length),
            square: N::square(record.square),
            radius: N::length(record.radius),
            reciprocal: N::reciprocal(record.radius, record.reciprocal, record.shift),
            hollow,
            two_sided: record.two_sided,
            surface: Surface {
                emits: record.emission != [0; 3],
                emission: record.emission,
                reflectance: record.reflectance.map(N::weight),
                survivor: record.survivor.map(N::weight),
                survival: N::unit(record.survival),
                bsdf,
            },
        }
    }
}

impl<N: Numbers> Camera<N> {
    fn of_record(record: &CameraRecord) -> Self {
        let axis = |(subpixels, reciprocal)| Axis {
            subpixels,
            reciprocal,
        };
        Self {
            position: record.position.map(N::length),
            forward: record.forward.map(N::unit),
            right: record.right.map(N::unit),
            up: record.up.map(N::unit),
            near: N::length(record.near),
            columns: axis(record.columns),
            rows: axis(record.rows),
        }
    }
}
