//! The scene as a core has it: a view of the bytes that the host's compiler writes.

mod format;

pub use crate::blob::BlobError;
pub use crate::capability::{All, Capabilities, Capability, Needs};
pub use crate::geometry::MAX_PRIMITIVES;
pub use format::{Header, MAX_BYTES, MAX_LIGHT_BYTES};

use crate::aggregate::Linear;
use crate::camera::CameraRecord;
use crate::light::Lights;
use crate::material::MaterialRecord;

/// What there is. [`Scene::view`] makes it, [`Scene::seen_from`] says from where it is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'s> {
    /// The shapes.
    pub aggregate: Linear<'s>,
    /// What they are made of.
    pub materials: &'s [MaterialRecord],
    /// The emitters that are looked for.
    pub lights: Lights<'s>,
}

impl<'s> Scene<'s> {
    /// The scene as this camera sees it, for an image with these capabilities.
    pub fn seen_from(self, camera: &'s CameraRecord, image: Capabilities) -> Result<Self, BlobError> {
        if !image.covers(camera.needs()) {
            return Err(BlobError::NotInThisImage);
        }
        let aggregate = Linear {
            opened: &camera.opened,
            ..self.aggregate
        };
        Ok(Self { aggregate, ..self })
    }
}
