//! The perfect mirror.

use bytemuck::{Pod, Zeroable};

use super::{Bsdf, Parameters};
use crate::arithmetic::Formats;
use crate::arithmetic::vector::reflected;
use crate::capability::Capability;
use crate::geometry::Interaction;
use crate::profile::Profile;

/// Reflects in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Mirror {
    /// Zero.
    pub reserved: Parameters,
}

impl Bsdf for Mirror {
    const CAPABILITY: Capability = Capability::Mirror;
    const IS_SPECULAR: bool = true;

    #[inline]
    fn sample<P: Profile>(
        &self,
        direction: [<P::Numbers as Formats>::Unit; 3],
        interaction: &Interaction<P::Numbers>,
        _random: &mut P::Random,
    ) -> [<P::Numbers as Formats>::Unit; 3] {
        reflected::<P::Numbers>(direction, interaction.facing())
    }
}
