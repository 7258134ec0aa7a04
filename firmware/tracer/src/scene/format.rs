//! A scene's bytes: a header, then the records of each kind of shape in the order of [`crate::geometry`]'s list, then the materials.
//!
//! | bytes | header |
//! | --- | --- |
//! | 4 | magic "FXS2" |
//! | 4 | what the scene needs: a bit for each [`Capability`](super::Capability) in its list's order |
//! | 2 | materials |
//! | 2 a kind | primitives of each kind of shape |
//! | to a multiple of 8 | zero |
//!
//! Records are read where they lie, so the bytes are aligned to 8, numbers are the core's own, little-endian, and a record is what
//! its `#[repr(C)]` type says. What a shape's record may hold, [`Shape::is_sound`] says.

use bytemuck::{Pod, Zeroable};

use super::{Capabilities, Scene};
use crate::aggregate::Linear;
use crate::geometry::{KINDS, PrimitiveSet, Primitives, Shape, Visitor};
use crate::material::MaterialRecord;

const _: () = assert!(
    cfg!(target_endian = "little"),
    "scenes are read in place, as little-endian words"
);

/// Primitives in a scene, at most: with a material of its own for each, that is what a core's data memory holds.
pub const MAX_PRIMITIVES: usize = 256;

/// The longest scene.
pub const MAX_BYTES: usize =
    size_of::<Header>() + MAX_PRIMITIVES * (MAX_RECORD + size_of::<MaterialRecord>());

/// The longest record of a shape.
const MAX_RECORD: usize = 32;

const MAGIC: [u8; 4] = *b"FXS2";

/// Kinds of shape, filled up to a multiple of 8 bytes with the three fields before.
const COUNTS: usize = (KINDS + 1).next_multiple_of(4) - 1;

/// Why a scene was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlobError {
    /// It is shorter than it says, or longer.
    Length,
    /// Its bytes do not begin at a multiple of 8.
    Misaligned,
    /// It does not begin as a scene.
    BadMagic,
    /// It has more primitives than there can be, or fields that mean nothing.
    BadHeader,
    /// A shape holds what no shape of its kind does, or a material that there is none of.
    BadShape,
    /// A material holds what none does.
    BadMaterial,
    /// It needs something that this image was built without.
    NotInThisImage,
}

/// What comes before the records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    magic: [u8; 4],
    needs: Capabilities,
    materials: u16,
    counts: [u16; COUNTS],
}

const _: () = assert!(size_of::<Header>().is_multiple_of(8));

impl Header {
    /// The header of a scene with so many materials, and primitives of each kind.
    pub fn new(needs: Capabilities, materials: u16, primitives: [u16; KINDS]) -> Self {
        let mut counts = [0; COUNTS];
        counts[..KINDS].copy_from_slice(&primitives);
        Self {
            magic: MAGIC,
            needs,
            materials,
            counts,
        }
    }
}

/// Takes `count` records from the front.
pub(crate) fn take_records<'s, T: Pod>(bytes: &mut &'s [u8], count: u16) -> Result<&'s [T], BlobError> {
    let len = usize::from(count) * size_of::<T>();
    let (records, rest) = bytes.split_at_checked(len).ok_or(BlobError::Length)?;
    *bytes = rest;
    bytemuck::try_cast_slice(records).map_err(|_| BlobError::Misaligned)
}

impl<'s> Scene<'s> {
    /// A view of the bytes that the host's scene compiler wrote, for an image with these capabilities.
    pub fn view(mut bytes: &'s [u8], image: Capabilities) -> Result<Self, BlobError> {
        let [header] = take_records::<Header>(&mut bytes, 1)? else {
            return Err(BlobError::Length);
        };
        let (counts, unused) = header.counts.split_first_chunk().ok_or(BlobError::BadHeader)?;
        let primitives: usize = counts.iter().map(|&count| usize::from(count)).sum();
        if header.magic != MAGIC {
            return Err(BlobError::BadMagic);
        }
        if primitives > MAX_PRIMITIVES || unused.iter().any(|&count| count != 0) {
            return Err(BlobError::BadHeader);
        }
        if !image.covers(header.needs) {
            return Err(BlobError::NotInThisImage);
        }
        let scene = Self {
            aggregate: Linear {
                primitives: Primitives::take(&mut bytes, *counts)?,
                opened: &PrimitiveSet::EMPTY,
            },
            materials: take_records(&mut bytes, header.materials)?,
        };
        if !bytes.is_empty() {
            return Err(BlobError::Length);
        }
        scene.check(header.needs)?;
        Ok(scene)
    }

    /// Whether all records are sound, and of no other shape or BSDF than the header says.
    fn check(&self, needs: Capabilities) -> Result<(), BlobError> {
        for material in self.materials {
            match material.capability() {
                Some(capability) if needs.has(capability) || material.absorbs_all() => {}
                _ => return Err(BlobError::BadMaterial),
            }
        }
        let mut check = Check {
            needs,
            materials: self.materials.len(),
            sound: true,
        };
        self.aggregate.primitives.visit(&mut check);
        if check.sound {
            Ok(())
        } else {
            Err(BlobError::BadShape)
        }
    }
}

/// Looks at each shape's record.
struct Check {
    needs: Capabilities,
    materials: usize,
    sound: bool,
}

impl Visitor for Check {
    fn visit<S: Shape>(&mut self, _first: usize, shapes: &[S]) {
        const { assert!(size_of::<S>() <= MAX_RECORD && size_of::<S>().is_multiple_of(8)) };
        let all = |sound: fn(&Self, &S) -> bool| shapes.iter().all(|shape| sound(self, shape));
        self.sound = self.sound
            && (shapes.is_empty() || self.needs.has(S::CAPABILITY))
            && all(|this, shape| shape.is_sound() && shape.material().index() < this.materials);
    }
}
