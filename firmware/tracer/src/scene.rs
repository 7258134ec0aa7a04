//! The compiled scene.

use core::marker::PhantomData;

/// What a scene needs of the tracer; code for the rest is not in the image.
pub trait Needs {
    /// A diffuse surface.
    const DIFFUSE: bool;
    /// A mirror.
    const MIRROR: bool;
    /// A dielectric.
    const GLASS: bool;
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
    const ROULETTE: bool = true;
}

/// Why a blob was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlobError {
    /// The blob ends before its contents do.
    Truncated,
}

/// A scene decoded for profile `P`.
#[derive(Debug)]
pub struct Scene<P>(PhantomData<P>);

impl<P: crate::profile::Profile> Scene<P> {
    /// Decodes a blob written by the host's scene compiler.
    pub fn decode(_blob: &[u8]) -> Result<Self, BlobError> {
        Ok(Self(PhantomData))
    }
}
