//! The smooth dielectric: Snell's law, and Fresnel's reflectance by Schlick's approximation.

use core::fmt::Debug;

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, I4F28, I16F16, I36F28, product, root};

use super::Bsdf;
use crate::arithmetic::vector::{neg, reflected};
use crate::arithmetic::{Formats, Mixed, Published, Sampling};
use crate::capability::Capability;
use crate::geometry::Interaction;
use crate::profile::Profile;
use crate::random::Random;

/// A dielectric in air, such as glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Dielectric {
    /// Ratio of indices for a ray that leaves: the index of refraction.
    pub leaving: I4F28,
    /// Ratio of indices for a ray that enters: 1 / index.
    pub entering: I4F28,
    /// Reflectance at normal incidence.
    pub normal_reflectance: I2F30,
}

/// Ratios of refractive indices, and the operations of refraction.
pub trait DielectricNumbers: Sampling {
    /// Ratios of refractive indices, up to 4, and their squares.
    type Ratio: Copy + Debug;

    /// A ratio of the scene.
    fn ratio(ratio: I4F28) -> Self::Ratio;
    /// The square of a ratio.
    fn ratio_squared(ratio: Self::Ratio) -> Self::Ratio;
    /// `ratio^2 (1 - cosine^2)` taken from 1: the squared cosine of the refracted ray, negative past the critical angle.
    fn refracted_square(cosine: Self::Unit, ratio_squared: Self::Ratio) -> Self::Ratio;
    /// Whether there is a refracted ray.
    fn is_refracted(square: Self::Ratio) -> bool;
    /// The root of [`DielectricNumbers::refracted_square`].
    fn root_of_ratio(square: Self::Ratio) -> Self::Unit;
    /// `ratio d + (ratio cosine - refracted) n`: Snell's law.
    fn refract(
        ratio: Self::Ratio,
        d: [Self::Unit; 3],
        cosine: Self::Unit,
        refracted: Self::Unit,
        n: [Self::Unit; 3],
    ) -> [Self::Unit; 3];
}

impl Bsdf for Dielectric {
    const CAPABILITY: Capability = Capability::Glass;
    const IS_SPECULAR: bool = true;

    #[inline]
    fn sample<P: Profile>(
        &self,
        direction: [<P::Numbers as Formats>::Unit; 3],
        interaction: &Interaction<P::Numbers>,
        random: &mut P::Random,
    ) -> [<P::Numbers as Formats>::Unit; 3] {
        self.direction::<P::Numbers, _>(direction, interaction.normal, random)
    }
}

impl Dielectric {
    /// The direction in which `d` goes on: reflected with the chance of Schlick's reflectance, else refracted, so that neither
    /// branch needs a weight.
    #[inline]
    pub fn direction<N: DielectricNumbers, R: Random>(
        &self,
        d: [N::Unit; 3],
        outward: [N::Unit; 3],
        random: &mut R,
    ) -> [N::Unit; 3] {
        let against = N::cosine(d, outward);
        let enters = against < N::ZERO;
        let (facing, cosine) = if enters {
            (outward, -against)
        } else {
            (neg(outward), against)
        };
        let ratio = N::ratio(if enters { self.entering } else { self.leaving });
        let square = N::refracted_square(cosine, N::ratio_squared(ratio));
        if !N::is_refracted(square) {
            return reflected::<N>(d, facing);
        }
        let refracted = N::root_of_ratio(square);
        // Schlick's cosine is the one on the thin side.
        let reflectance = self.reflectance::<N>(if enters { cosine } else { refracted });
        if N::below(random.fraction(), reflectance) {
            return reflected::<N>(d, facing);
        }
        N::renormalised(N::refract(ratio, d, cosine, refracted, facing))
    }

    /// Schlick's `r0 + (1 - r0) (1 - cosine)^5`.
    fn reflectance<N: DielectricNumbers>(&self, cosine: N::Unit) -> N::Unit {
        let normal = N::unit(self.normal_reflectance);
        let x = N::ONE - cosine;
        let square = N::times(x, x);
        let fifth = N::times(N::times(square, square), x);
        normal + N::times(N::ONE - normal, fifth)
    }
}

/// 1 as a product of two direction components, 4:60.
const ONE_SQUARED: i64 = 1 << 60;

impl DielectricNumbers for Mixed {
    /// A ratio of 4 squared, taken from 1, still fits with room.
    type Ratio = I36F28;

    #[inline]
    fn ratio(ratio: I4F28) -> I36F28 {
        I36F28::from_bits(ratio.to_bits().into())
    }

    #[inline]
    fn ratio_squared(ratio: I36F28) -> I36F28 {
        I36F28::from_bits((ratio.to_bits() * ratio.to_bits()) >> 28)
    }

    #[inline]
    fn refracted_square(cosine: I2F30, ratio_squared: I36F28) -> I36F28 {
        let c = i64::from(cosine.to_bits());
        let sine_squared = (ONE_SQUARED - c * c) >> 30;
        I36F28::from_bits((1 << 28) - ((ratio_squared.to_bits() * sine_squared) >> 30))
    }

    #[inline]
    fn is_refracted(square: I36F28) -> bool {
        square >= I36F28::ZERO
    }

    #[inline]
    fn root_of_ratio(square: I36F28) -> I2F30 {
        // 4:28 to 4:60, whose root has 30 bits.
        I2F30::from_bits(root::nearest((square.to_bits() as u64) << 32) as i32)
    }

    #[inline]
    fn refract(ratio: I36F28, d: [I2F30; 3], cosine: I2F30, refracted: I2F30, n: [I2F30; 3]) -> [I2F30; 3] {
        let ratio = ratio.to_bits() as i32;
        let bend =
            ((i64::from(ratio) * i64::from(cosine.to_bits())) >> 30) as i32 - (refracted.to_bits() >> 2);
        let component = |d: I2F30, n: I2F30| {
            let sum = i64::from(ratio) * i64::from(d.to_bits()) + i64::from(bend) * i64::from(n.to_bits());
            I2F30::from_bits(((sum + (1 << 27)) >> 28) as i32)
        };
        [
            component(d[0], n[0]),
            component(d[1], n[1]),
            component(d[2], n[2]),
        ]
    }
}

impl DielectricNumbers for Published {
    type Ratio = I16F16;

    fn ratio(ratio: I4F28) -> I16F16 {
        I16F16::from_bits(ratio.to_bits() >> 12)
    }

    fn ratio_squared(ratio: I16F16) -> I16F16 {
        product::truncated(ratio, ratio)
    }

    fn refracted_square(cosine: I16F16, ratio_squared: I16F16) -> I16F16 {
        Self::ONE - product::truncated(ratio_squared, Self::ONE - product::truncated(cosine, cosine))
    }

    fn is_refracted(square: I16F16) -> bool {
        square >= I16F16::ZERO
    }

    fn root_of_ratio(square: I16F16) -> I16F16 {
        root::restoring(square)
    }

    fn refract(
        ratio: I16F16,
        d: [I16F16; 3],
        cosine: I16F16,
        refracted: I16F16,
        n: [I16F16; 3],
    ) -> [I16F16; 3] {
        let bend = product::truncated(ratio, cosine) - refracted;
        let component = |i: usize| product::truncated(ratio, d[i]) + product::truncated(bend, n[i]);
        [component(0), component(1), component(2)]
    }
}
