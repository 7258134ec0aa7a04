//! Lambert's BSDF, and two ways to sample the hemisphere for it.

use bytemuck::{Pod, Zeroable};
use fixedmath::I2F30;

use super::{Bsdf, Parameters};
use crate::arithmetic::vector::cross;
use crate::arithmetic::{Formats, Sampling};
use crate::capability::Capability;
use crate::geometry::Interaction;
use crate::profile::Profile;
use crate::random::Random;

/// Reflects alike in all directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Diffuse {
    /// Zero.
    pub reserved: Parameters,
}

impl Bsdf for Diffuse {
    const CAPABILITY: Capability = Capability::Diffuse;
    const IS_SPECULAR: bool = false;

    #[inline]
    fn sample<P: Profile>(
        &self,
        _direction: [<P::Numbers as Formats>::Unit; 3],
        interaction: &Interaction<P::Numbers>,
        random: &mut P::Random,
    ) -> [<P::Numbers as Formats>::Unit; 3] {
        P::Hemisphere::direction::<P::Numbers, _>(interaction.facing(), random)
    }
}

/// A way to draw a direction in proportion to its cosine with the normal.
pub trait HemisphereSampling {
    /// A direction on the side of `normal`.
    fn direction<N: Sampling, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3];
}

/// Malley's method, as smallpt has it: a point of the unit disc, lifted onto the hemisphere, in an orthonormal basis around the
/// normal.
#[derive(Clone, Copy, Debug)]
pub enum MalleyDisc {}

impl HemisphereSampling for MalleyDisc {
    fn direction<N: Sampling, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3] {
        /// 0.1.
        const NEAR_AXIS: I2F30 = I2F30::from_bits(107_374_182);
        let turn = random.fraction();
        let square = random.fraction();
        let radius = N::root_of(square);
        let height = N::root_of(!square);
        let along_x = normal[0] > N::unit(NEAR_AXIS) || -normal[0] > N::unit(NEAR_AXIS);
        let axis = if along_x {
            [N::ZERO, N::ONE, N::ZERO]
        } else {
            [N::ONE, N::ZERO, N::ZERO]
        };
        let u = N::normalised(cross::<N>(axis, normal), axis);
        let v = cross::<N>(normal, u);
        let (cosine, sine) = N::cos_sin(turn);
        let (x, y) = (N::times(cosine, radius), N::times(sine, radius));
        let direction =
            [0, 1, 2].map(|i| N::times(u[i], x) + N::times(v[i], y) + N::times(normal[i], height));
        N::normalised(direction, normal)
    }
}

/// Ours: a point of the unit disc, drawn until a point of the square around is one, lifted onto the hemisphere, in a frame around
/// the normal that there is for every normal.
#[derive(Clone, Copy, Debug)]
pub enum RejectedDisc {}

impl HemisphereSampling for RejectedDisc {
    #[inline]
    fn direction<N: Sampling, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3] {
        let mut pair = random.pair();
        loop {
            if let Some(point) = N::on_hemisphere(pair) {
                return N::around(normal, point);
            }
            pair = random.fraction();
        }
    }
}
