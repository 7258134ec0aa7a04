//! Records taken from a scene's bytes, where they lie.

use bytemuck::Pod;

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
    /// An emitter holds what none does.
    BadLight,
    /// It needs something that this image was built without.
    NotInThisImage,
}

/// Takes `count` records from the front.
pub(crate) fn take_records<'s, T: Pod>(bytes: &mut &'s [u8], count: u16) -> Result<&'s [T], BlobError> {
    let len = usize::from(count) * size_of::<T>();
    let (records, rest) = bytes.split_at_checked(len).ok_or(BlobError::Length)?;
    *bytes = rest;
    bytemuck::try_cast_slice(records).map_err(|_| BlobError::Misaligned)
}
