//! A scene's bytes: a header, what has been proved of its room if there is one, the records of each kind of shape in the order of
//! [`crate::geometry`]'s list, the materials, and the emitters and guides if any are looked for.
//!
//! | bytes | header |
//! | --- | --- |
//! | 4 | magic "FXS6" |
//! | 4 | what the scene needs: a bit for each [`Capability`](crate::capability::Capability) in its list's order |
//! | 2 | materials |
//! | 2 | the shift of the scene's grid |
//! | 2 a kind | emitters of each kind that are looked for: caps, then balls; and balls that paths are guided to |
//! | 2 a kind | primitives of each kind of shape |
//! | to a multiple of 8 | zero |
//!
//! Records are read where they lie, so the bytes are aligned to 8, numbers are the core's own, little-endian, and a record is what
//! its `#[repr(C)]` type says. What a shape's record may hold, [`Shape::is_sound`] says.

use bytemuck::{Pod, Zeroable};

use super::Scene;
use crate::aggregate::{Linear, Room};
use crate::blob::{BlobError, take_records};
use crate::capability::{Capabilities, Capability};
use crate::geometry::{Grid, KINDS, MAX_PRIMITIVES, PrimitiveSet, Primitives, Shape, Visitor};
use crate::light::{BallLight, Guide, Lights, MAX_GUIDES};
use crate::material::MaterialRecord;

const _: () = assert!(
    cfg!(target_endian = "little"),
    "scenes are read in place, as little-endian words"
);

/// The longest scene.
pub const MAX_BYTES: usize = size_of::<Header>()
    + size_of::<Room>()
    + MAX_PRIMITIVES * (MAX_RECORD + size_of::<MaterialRecord>())
    + MAX_LIGHT_BYTES
    + MAX_GUIDES * size_of::<Guide>();

/// The most bytes that emitters take: as many balls as there may be, or 116 caps.
pub const MAX_LIGHT_BYTES: usize = MAX_PRIMITIVES * size_of::<BallLight>();

/// The longest record of a shape.
const MAX_RECORD: usize = 48;

const MAGIC: [u8; 4] = *b"FXS6";

/// Kinds of shape, filled up to a multiple of 8 bytes with the fields before.
const COUNTS: usize = (KINDS + 5).next_multiple_of(4) - 5;

/// What comes before the records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    magic: [u8; 4],
    needs: Capabilities,
    materials: u16,
    grid: u16,
    lights: [u16; 3],
    counts: [u16; COUNTS],
}

const _: () = assert!(size_of::<Header>().is_multiple_of(8) && size_of::<Room>().is_multiple_of(8));

impl Header {
    /// The header of a scene with so many materials, this grid, and so many primitives and emitters of each kind.
    pub fn new(
        needs: Capabilities,
        materials: u16,
        grid: Grid,
        primitives: [u16; KINDS],
        lights: [u16; 3],
    ) -> Self {
        let mut counts = [0; COUNTS];
        counts[..KINDS].copy_from_slice(&primitives);
        Self {
            magic: MAGIC,
            needs,
            materials,
            grid: grid.shift() as u16,
            lights,
            counts,
        }
    }
}

impl<'s> Scene<'s> {
    /// A view of the bytes that the host's scene compiler wrote, for an image with these capabilities.
    #[inline]
    pub fn view(mut bytes: &'s [u8], image: Capabilities) -> Result<Self, BlobError> {
        let [header] = take_records::<Header>(&mut bytes, 1)? else {
            return Err(BlobError::Length);
        };
        let (counts, unused) = header.counts.split_first_chunk().ok_or(BlobError::BadHeader)?;
        let primitives: usize = counts.iter().map(|&count| usize::from(count)).sum();
        if header.magic != MAGIC {
            return Err(BlobError::BadMagic);
        }
        let [caps, balls, guides] = header.lights.map(usize::from);
        let too_many = primitives > MAX_PRIMITIVES || caps + balls > primitives || guides > MAX_GUIDES;
        if too_many || header.grid >= 32 || unused.iter().any(|&count| count != 0) {
            return Err(BlobError::BadHeader);
        }
        if !image.covers(header.needs) {
            return Err(BlobError::NotInThisImage);
        }
        let room = take_records(&mut bytes, header.needs.has(Capability::Room).into())?.first();
        let scene = Self {
            aggregate: Linear {
                room,
                grid: Grid::new(header.grid.into()),
                primitives: Primitives::take(&mut bytes, *counts)?,
                opened: &PrimitiveSet::EMPTY,
            },
            materials: take_records(&mut bytes, header.materials)?,
            lights: Lights::take(&mut bytes, header.lights)?,
        };
        if !bytes.is_empty() {
            return Err(BlobError::Length);
        }
        // What the image lacks is not needed, so that it takes no code to look at.
        scene.check(header.needs, image)?;
        Ok(scene)
    }

    /// Whether all records are sound, and of no other shape or BSDF than the header says.
    #[inline]
    fn check(&self, needs: Capabilities, image: Capabilities) -> Result<(), BlobError> {
        for material in self.materials {
            match material.capability() {
                Some(capability) if needs.has(capability) || material.absorbs_all() => {}
                _ => return Err(BlobError::BadMaterial),
            }
        }
        if !self.lights.is_sound(self.materials.len(), needs, image) {
            return Err(BlobError::BadLight);
        }
        let hollow_spheres = self.aggregate.primitives.hollow_spheres.len();
        if self
            .aggregate
            .room
            .is_some_and(|room| !room.is_sound(hollow_spheres))
        {
            return Err(BlobError::BadShape);
        }
        let mut check = Check {
            needs,
            image,
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
    image: Capabilities,
    materials: usize,
    sound: bool,
}

impl Visitor for Check {
    #[inline]
    fn visit<S: Shape>(&mut self, _first: usize, shapes: &[S]) {
        const { assert!(size_of::<S>() <= MAX_RECORD && size_of::<S>().is_multiple_of(8)) };
        if !self.image.has(S::CAPABILITY) {
            self.sound &= shapes.is_empty();
            return;
        }
        let all = |sound: fn(&Self, &S) -> bool| shapes.iter().all(|shape| sound(self, shape));
        self.sound = self.sound
            && (shapes.is_empty() || self.needs.has(S::CAPABILITY))
            && all(|this, shape| shape.is_sound() && shape.material().index() < this.materials);
    }
}
