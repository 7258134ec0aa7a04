//! What light needs of the number formats: throughput, emission, and sums of them.

use core::fmt::Debug;
use core::ops::Add;

use fixedmath::{I16F16, U0F32, U16F16, U32F32, product};

use crate::arithmetic::{Formats, Mixed, Published};

/// Throughput and radiance.
pub trait RadianceNumbers: Formats {
    /// Throughput and reflectance: [0, 1].
    type Weight: Copy + Debug;
    /// Radiance of one sample, and sums of it.
    type Radiance: Copy + Debug + Add<Output = Self::Radiance>;

    /// Nothing absorbed yet.
    const FULL: Self::Weight;
    /// No light.
    const DARK: Self::Radiance;

    /// A reflectance of the scene, of which all ones stand for 1.
    fn weight(reflectance: U0F32) -> Self::Weight;
    /// What is left of `throughput` after a reflection.
    fn attenuate(throughput: Self::Weight, reflectance: Self::Weight) -> Self::Weight;
    /// `throughput` of an emission.
    fn emitted(throughput: Self::Weight, emission: U16F16) -> Self::Radiance;
    /// A sum for the film.
    fn film_sum(sum: Self::Radiance) -> U32F32;
}

impl RadianceNumbers for Mixed {
    /// All ones stand for 1.
    type Weight = U0F32;
    type Radiance = U32F32;

    const FULL: U0F32 = U0F32::MAX;
    const DARK: U32F32 = U32F32::ZERO;

    fn weight(reflectance: U0F32) -> U0F32 {
        reflectance
    }

    #[inline]
    fn attenuate(throughput: U0F32, reflectance: U0F32) -> U0F32 {
        let product = u64::from(throughput.to_bits()) * u64::from(reflectance.to_bits());
        U0F32::from_bits((product >> 32) as u32)
    }

    #[inline]
    fn emitted(throughput: U0F32, emission: U16F16) -> U32F32 {
        let product = u64::from(throughput.to_bits()) * u64::from(emission.to_bits());
        U32F32::from_bits(product >> 16)
    }

    #[inline]
    fn film_sum(sum: U32F32) -> U32F32 {
        sum
    }
}

impl RadianceNumbers for Published {
    type Weight = I16F16;
    type Radiance = U32F32;

    const FULL: I16F16 = I16F16::ONE;
    const DARK: U32F32 = U32F32::ZERO;

    fn weight(reflectance: U0F32) -> I16F16 {
        // All ones stand for 1, so the reading rounds up.
        I16F16::from_bits(((u64::from(reflectance.to_bits()) + 0x8000) >> 16) as i32)
    }

    fn attenuate(throughput: I16F16, reflectance: I16F16) -> I16F16 {
        product::truncated(throughput, reflectance)
    }

    fn emitted(throughput: I16F16, emission: U16F16) -> U32F32 {
        // Negative only where 16:16 has gone wrong; there is no negative light.
        U32F32::from_bits(throughput.to_bits().max(0) as u64 * u64::from(emission.to_bits()))
    }

    fn film_sum(sum: U32F32) -> U32F32 {
        sum
    }
}
