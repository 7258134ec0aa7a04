//! The table of materials, and the list of BSDFs that they are made with.

use bytemuck::{Pod, Zeroable};
use fixedmath::{I2F30, U0F32, U16F16};

/// What a BSDF has in a record: three words, which its own type lends a meaning.
pub type Parameters = [u32; 3];

/// A material's record, fourteen words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialRecord {
    /// Which BSDF: its place in the list.
    pub bsdf: u8,
    /// 1 if it emits at all, else 0.
    pub emits: u8,
    /// Zero.
    pub reserved: u16,
    /// The chance to go on under roulette: the largest channel of the reflectance. 0 for a surface that only absorbs.
    pub continuation: I2F30,
    /// Radiance given off, per channel.
    pub emission: [U16F16; 3],
    /// Share of light reflected or transmitted, per channel; all ones stand for 1.
    pub reflectance: [U0F32; 3],
    /// The reflectance over the continuation probability, likewise.
    pub continued: [U0F32; 3],
    /// The BSDF's.
    pub parameters: Parameters,
}

const _: () = assert!(size_of::<MaterialRecord>() == 56);

impl MaterialRecord {
    /// Whether no light goes on from here.
    #[inline]
    pub fn absorbs_all(&self) -> bool {
        self.continuation == I2F30::ZERO
    }

    /// Whether it gives off light.
    #[inline]
    pub fn emits(&self) -> bool {
        self.emits != 0
    }
}

/// The list of BSDFs and the arithmetic they need; a material's record has a BSDF's place in it.
macro_rules! bsdfs {
    ($($(#[$meta:meta])* $bsdf:ident, $numbers:ident;)+) => {
        /// What all BSDFs together need of the number formats.
        pub trait MaterialNumbers: $($numbers +)+ {}

        impl<N: $($numbers +)+> MaterialNumbers for N {}

        /// Which BSDF a material has.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Kind {
            $($(#[$meta])* $bsdf,)+
        }

        impl MaterialRecord {
            /// The BSDF; none where the record is no material's.
            #[inline]
            pub fn kind(&self) -> Option<Kind> {
                const KINDS: &[Kind] = &[$(Kind::$bsdf),+];
                KINDS.get(usize::from(self.bsdf)).copied()
            }

            /// What an image must be capable of for it; none where the record is no material's.
            pub fn capability(&self) -> Option<Capability> {
                Some(match self.kind()? {
                    $(Kind::$bsdf => <$bsdf as Bsdf>::CAPABILITY,)+
                })
            }

            /// Whether its BSDF is specular.
            #[inline]
            pub fn is_specular(&self) -> bool {
                const SPECULAR: u32 = 0 $(| (<$bsdf as Bsdf>::IS_SPECULAR as u32) << Kind::$bsdf as u32)+;
                SPECULAR >> (self.bsdf & 31) & 1 == 1
            }

            /// Samples the BSDF; none where the image was built without it.
            #[inline]
            pub fn sample<P: Profile, F: $crate::capability::Needs>(
                &self,
                direction: [<P::Numbers as Formats>::Unit; 3],
                interaction: &Interaction<P::Numbers>,
                random: &mut P::Random,
            ) -> Option<[<P::Numbers as Formats>::Unit; 3]> {
                // Compared, and not looked up in the list of kinds: that would cost 25 instructions a sample.
                match self.bsdf {
                    $(
                        bsdf if bsdf == Kind::$bsdf as u8 && F::NEEDS.has(<$bsdf as Bsdf>::CAPABILITY) => {
                            let parameters: &$bsdf = bytemuck::must_cast_ref(&self.parameters);
                            Some(parameters.sample::<P>(direction, interaction, random))
                        }
                    )+
                    _ => None,
                }
            }
        }
    };
}

pub(super) use bsdfs;
