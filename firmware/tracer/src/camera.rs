//! The camera: where a sample's first ray starts.

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I16F16, U19F45, division, product};

use crate::arithmetic::{Mixed, Published, Sampling};
use crate::capability::{Capabilities, Capability};
use crate::geometry::{PrimitiveId, PrimitiveSet, Ray};
use crate::random::Random;

/// A camera's record: a view of a scene at one size of the picture. Aligned to 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraRecord {
    /// One over the sub-pixels across the film, and up it.
    pub reciprocals: [U19F45; 2],
    /// Sub-pixels from edge to edge, across and up: twice the pixels.
    pub subpixels: [u32; 2],
    /// The pinhole.
    pub position: [I16F16; 3],
    /// How far along its unit direction a ray starts.
    pub near: I16F16,
    /// To the film's centre. This and the next two share a scale that keeps every sum of them below 2.
    pub forward: [I2F30; 3],
    /// From the film's left edge to its right.
    pub right: [I2F30; 3],
    /// From the film's lower edge to its upper.
    pub up: [I2F30; 3],
    /// Zero.
    pub reserved: u32,
    /// The opaque solids that rays start within.
    pub opened: PrimitiveSet,
}

impl CameraRecord {
    /// The record in these bytes, where they are aligned and of its length.
    pub fn of_bytes(bytes: &[u8]) -> Option<&Self> {
        bytemuck::try_from_bytes(bytes).ok()
    }

    /// What an image must be capable of for it.
    pub fn needs(&self) -> Capabilities {
        if self.opened.is_empty() {
            Capabilities::NONE
        } else {
            Capabilities::of(&[Capability::TwoSided])
        }
    }
}

/// The arithmetic of the film.
pub trait FilmNumbers: Sampling {
    /// Sub-pixel `k`'s centre plus a jitter of sub-pixels, across a film of `subpixels`: [-1/2, 1/2] and a little more.
    fn across(k: u32, jitter: Self::Unit, subpixels: u32, reciprocal: U19F45) -> Self::Unit;
    /// `forward + a right + b up`.
    fn combine(
        forward: [Self::Unit; 3],
        a: Self::Unit,
        right: [Self::Unit; 3],
        b: Self::Unit,
        up: [Self::Unit; 3],
    ) -> [Self::Unit; 3];
}

/// A pinhole camera whose rays start some way along their direction.
#[derive(Clone, Copy, Debug)]
pub struct Camera<N: FilmNumbers> {
    reciprocals: [U19F45; 2],
    subpixels: [u32; 2],
    position: [N::Length; 3],
    near: N::Length,
    forward: [N::Unit; 3],
    right: [N::Unit; 3],
    up: [N::Unit; 3],
}

impl<N: FilmNumbers> Camera<N> {
    /// The camera of a record.
    pub fn new(record: &CameraRecord) -> Self {
        Self {
            reciprocals: record.reciprocals,
            subpixels: record.subpixels,
            position: record.position.map(N::length),
            near: N::length(record.near),
            forward: record.forward.map(N::unit),
            right: record.right.map(N::unit),
            up: record.up.map(N::unit),
        }
    }

    /// A ray through the sub-pixel in `column` from the left and `row` from below, spread by the tent filter.
    pub fn ray<R: Random>(&self, column: u32, row: u32, random: &mut R) -> Ray<N> {
        let [x, y] = random.film().map(N::tent);
        let x = N::across(column, x, self.subpixels[0], self.reciprocals[0]);
        let y = N::across(row, y, self.subpixels[1], self.reciprocals[1]);
        let direction = N::normalised(N::combine(self.forward, x, self.right, y, self.up), self.forward);
        let origin = [0, 1, 2].map(|i| self.position[i] + N::scale(self.near, direction[i]));
        Ray {
            origin,
            direction,
            departed: PrimitiveId::NONE,
            normal: direction,
        }
    }
}

impl FilmNumbers for Mixed {
    #[inline]
    fn across(k: u32, jitter: I2F30, _subpixels: u32, reciprocal: U19F45) -> I2F30 {
        let reciprocal = reciprocal.to_bits();
        // (2 k + 1) / (2 subpixels) in 2:30, then the jitter's share of a sub-pixel.
        let centre = ((u64::from(2 * k + 1) * reciprocal) >> 16) as i32;
        let offset = (i64::from(jitter.to_bits()) * (reciprocal >> 15) as i64) >> 30;
        I2F30::from_bits(centre - (1 << 29) + offset as i32)
    }

    #[inline]
    fn combine(forward: [I2F30; 3], a: I2F30, right: [I2F30; 3], b: I2F30, up: [I2F30; 3]) -> [I2F30; 3] {
        let (a, b) = (i64::from(a.to_bits()), i64::from(b.to_bits()));
        let component = |i: usize| {
            let sum = i64::from(right[i].to_bits()) * a + i64::from(up[i].to_bits()) * b;
            I2F30::from_bits(forward[i].to_bits() + ((sum + (1 << 29)) >> 30) as i32)
        };
        [component(0), component(1), component(2)]
    }
}

impl FilmNumbers for Published {
    fn across(k: u32, jitter: I16F16, subpixels: u32, _reciprocal: U19F45) -> I16F16 {
        // Sub-pixel indices stay below 2^15 up to 16,384 pixels, as far as 16:16 can count them.
        let place = I16F16::from_bits((k as i32) << 16) + I16F16::from_bits(1 << 15) + jitter;
        division::restoring(place, I16F16::from_bits((subpixels as i32) << 16)) - I16F16::from_bits(1 << 15)
    }

    fn combine(
        forward: [I16F16; 3],
        a: I16F16,
        right: [I16F16; 3],
        b: I16F16,
        up: [I16F16; 3],
    ) -> [I16F16; 3] {
        let component =
            |i: usize| forward[i] + product::truncated(right[i], a) + product::truncated(up[i], b);
        [component(0), component(1), component(2)]
    }
}
