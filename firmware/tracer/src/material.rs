//! What a surface does with light: emission, absorption, and the direction in which a path goes on.

use crate::numbers::Numbers;
use crate::random::Random;
use crate::vector;

/// A surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface<N: Numbers> {
    /// Whether it emits at all.
    pub emits: bool,
    /// Radiance given off, 16:16 per channel.
    pub emission: [u32; 3],
    /// Share of light reflected or transmitted, per channel.
    pub reflectance: [N::Weight; 3],
    /// [`Surface::reflectance`] over [`Surface::survival`].
    pub survivor: [N::Weight; 3],
    /// The largest channel of the reflectance: the chance to go on under roulette. 0 for a surface that only absorbs.
    pub survival: N::Unit,
    /// How directions change.
    pub bsdf: Bsdf<N>,
}

/// Bidirectional scattering distribution: diffuse, or a Dirac delta or two.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<N: Numbers> {
    /// Lambert's.
    Diffuse,
    /// A perfect mirror.
    Mirror,
    /// A smooth dielectric, its Fresnel reflectance by Schlick's approximation.
    Glass(Dielectric<N>),
}

/// A dielectric in air.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<N: Numbers> {
    /// Ratio of indices for a ray that enters: 1 / index.
    pub entering: N::Ratio,
    /// Its square.
    pub entering_squared: N::Ratio,
    /// Ratio of indices for a ray that leaves: the index.
    pub leaving: N::Ratio,
    /// Its square.
    pub leaving_squared: N::Ratio,
    /// Reflectance at normal incidence.
    pub normal_reflectance: N::Unit,
}

impl<N: Numbers> Surface<N> {
    /// Whether light goes through.
    pub fn transmits(&self) -> bool {
        matches!(self.bsdf, Bsdf::Glass(_))
    }

    /// Whether no light goes on from here.
    pub fn absorbs_all(&self) -> bool {
        self.survival == N::ZERO
    }
}

/// A way to draw a direction in proportion to its cosine with the normal.
pub trait Diffuse {
    /// A direction on the side of `normal`.
    fn direction<N: Numbers, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3];
}

/// smallpt's: a point of the unit disc, lifted onto the hemisphere, in an orthonormal basis around the normal.
#[derive(Clone, Copy, Debug)]
pub enum Basis {}

impl Diffuse for Basis {
    fn direction<N: Numbers, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3] {
        /// 0.1 in 2:30.
        const NEAR_AXIS: i32 = 107_374_182;
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

fn cross<N: Numbers>(a: [N::Unit; 3], b: [N::Unit; 3]) -> [N::Unit; 3] {
    let minor = |i: usize, j: usize| N::times(a[i], b[j]) - N::times(a[j], b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// Ours: the normal plus a point of the unit sphere, brought to unit length. Its density is the cosine's exactly, it
/// needs no basis, and there is no axis where it breaks down.
#[derive(Clone, Copy, Debug)]
pub enum Offset {}

impl Diffuse for Offset {
    #[inline]
    fn direction<N: Numbers, R: Random>(normal: [N::Unit; 3], random: &mut R) -> [N::Unit; 3] {
        let offset = N::sphere(random.fraction(), random.fraction());
        N::bisector(normal, offset, normal)
    }
}

/// `d` mirrored in a surface with unit normal `n`.
pub fn mirrored<N: Numbers>(d: [N::Unit; 3], n: [N::Unit; 3]) -> [N::Unit; 3] {
    let cosine = N::cosine(d, n);
    N::renormalised([0, 1, 2].map(|i| {
        let share = N::times(n[i], cosine);
        d[i] - share - share
    }))
}

impl<N: Numbers> Dielectric<N> {
    /// The direction in which `d` goes on: mirrored with the chance of Schlick's reflectance, else refracted, so that
    /// neither branch needs a weight.
    pub fn direction<R: Random>(
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
            (vector::neg(outward), against)
        };
        let (ratio, ratio_squared) = if enters {
            (self.entering, self.entering_squared)
        } else {
            (self.leaving, self.leaving_squared)
        };
        let square = N::refracted_square(cosine, ratio_squared);
        if !N::is_refracted(square) {
            return mirrored::<N>(d, facing);
        }
        let refracted = N::root_of_ratio(square);
        // Schlick's cosine is the one on the thin side.
        let reflectance = self.reflectance(if enters { cosine } else { refracted });
        if N::below(random.fraction(), reflectance) {
            return mirrored::<N>(d, facing);
        }
        N::renormalised(N::refract(ratio, d, cosine, refracted, facing))
    }

    /// Schlick's `r0 + (1 - r0) (1 - cosine)^5`.
    fn reflectance(&self, cosine: N::Unit) -> N::Unit {
        let x = N::ONE - cosine;
        let square = N::times(x, x);
        let fifth = N::times(N::times(square, square), x);
        self.normal_reflectance + N::times(N::ONE - self.normal_reflectance, fifth)
    }
}
