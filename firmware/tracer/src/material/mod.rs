//! What a surface does with light: emission, absorption, and the direction in which a path goes on.
//!
//! A BSDF is a file: its parameters as they lie in a material's record, the arithmetic it needs of the number formats, and how it
//! samples. It is listed once, at the end of this file.

mod dielectric;
mod diffuse;
mod mirror;
mod radiance;
mod table;

pub use crate::geometry::MaterialId;
pub use dielectric::{Dielectric, DielectricNumbers};
pub use diffuse::{Diffuse, HemisphereSampling, MalleyDisc, RejectedDisc};
pub use mirror::Mirror;
pub use radiance::RadianceNumbers;
pub use table::{MaterialRecord, Parameters};

use bytemuck::Pod;

use crate::arithmetic::{Formats, Sampling};
use crate::capability::Capability;
use crate::geometry::Interaction;
use crate::profile::Profile;

/// Bidirectional scattering distribution: how directions change. Its record is a material's [`Parameters`].
pub trait Bsdf: Pod {
    /// What an image must be capable of for it.
    const CAPABILITY: Capability;

    /// Whether it sends light on in so few directions that none leads to an emitter but by chance.
    const IS_SPECULAR: bool;

    /// A direction in which light that comes along `direction` goes on, in proportion to the BSDF and the cosine, so that no
    /// weight but the material's reflectance is needed.
    fn sample<P: Profile>(
        &self,
        direction: [<P::Numbers as Formats>::Unit; 3],
        interaction: &Interaction<P::Numbers>,
        random: &mut P::Random,
    ) -> [<P::Numbers as Formats>::Unit; 3];
}

table::bsdfs! {
    /// Lambert's.
    Diffuse, Sampling;
    /// A perfect mirror.
    Mirror, Sampling;
    /// A smooth dielectric in air.
    Dielectric, DielectricNumbers;
}
