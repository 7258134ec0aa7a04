//! Why a path in fixed point is not the path in double precision.
//!
//! A path and its double, the tracer's own source over `f64` with the same random numbers, are walked side by side. As long as
//! everything is decided alike, they are the same path but for rounding. The first decision that comes out differently parts
//! them, and is the cause of all that differs from then on. Both begin every sample with the same random numbers: in a picture of
//! the lockstep oracle, a path that draws more of them than its double shifts those of all that follow in its unit, which is noise
//! and no cause.
//!
//! Two paths through one sub-pixel start from the same camera ray but for rounding, so there is no parting before the first hit.

mod observed;
mod walk;

use std::fmt;

use fixedmath::U32F32;
use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::geometry::Ray;
use tracer::profile::Profile;
use tracer::random::Random;
use tracer::scene::Scene;
use tracer::unit::Plan;

use crate::oracle::lockstep::Lockstep;
use crate::oracle::lockstep::samples::samples;
use crate::scene::CompiledScene;

use observed::Counted;
pub use observed::{Explicable, Framed, Readable};
pub use walk::Quantity;
use walk::{Branch, Decisions, Walk, taken_over};

/// The decision that came out differently, in the order in which a bounce takes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// One path met a surface where the other met none.
    HitOrMiss,
    /// The nearest surface was another primitive's.
    Nearest,
    /// Roulette, or the limit of depth, ended one of them.
    Roulette,
    /// One came from the side of the surface that the normal points to, the other from behind.
    Side,
    /// One was past the critical angle, the other was not.
    TotalReflection,
    /// The random number fell between the two reflectances: one was reflected, the other refracted.
    Fresnel,
    /// One sample of the hemisphere was rejected.
    Rejection,
    /// The hemisphere was put around the normal in another frame.
    Frame,
    /// None: they are one path to the end, but for rounding.
    Rounding,
}

impl Cause {
    /// All there are.
    pub const ALL: [Self; 9] = [
        Self::HitOrMiss,
        Self::Nearest,
        Self::Roulette,
        Self::Side,
        Self::TotalReflection,
        Self::Fresnel,
        Self::Rejection,
        Self::Frame,
        Self::Rounding,
    ];

    /// Why these two bounces differ, if they do.
    fn between(one: &Decisions, other: &Decisions) -> Option<Self> {
        let is_total = |decisions: &Decisions| decisions.branch == Some(Branch::Total);
        let differences = [
            (one.surface.is_some() != other.surface.is_some(), Self::HitOrMiss),
            (one.surface != other.surface, Self::Nearest),
            (one.survives != other.survives, Self::Roulette),
            (one.from_inside != other.from_inside, Self::Side),
            (is_total(one) != is_total(other), Self::TotalReflection),
            (one.branch != other.branch, Self::Fresnel),
            (one.drawn != other.drawn, Self::Rejection),
            (one.is_turned != other.is_turned, Self::Frame),
        ];
        let first = differences.into_iter().find(|(differs, _)| *differs);
        first.map(|(_, cause)| cause)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::HitOrMiss => "hit or miss",
            Self::Nearest => "nearest",
            Self::Roulette => "roulette",
            Self::Side => "side",
            Self::TotalReflection => "total reflection",
            Self::Fresnel => "Fresnel",
            Self::Rejection => "rejection",
            Self::Frame => "frame",
            Self::Rounding => "rounding alone",
        })
    }
}

/// Bounces that are told apart; the last one stands for itself and all later ones.
pub const BOUNCES: usize = 24;
/// Powers of two of ulp that offsets are counted by: the first is below 2^-15 ulp, the last 2^24 and above.
const OFFSETS: usize = 41;
const LEAST_OFFSET: i32 = -16;

/// What one cause did to a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// Paths that it parted.
    pub paths: u64,
    /// Those of them that double precision would have sent the same way as fixed point, had it started that bounce from the same
    /// ray: rounding of earlier bounces parted them, and not this bounce's.
    pub inherited: u64,
    /// By the bounce at which it came about, from the first; of paths that never parted, by their last.
    pub bounces: [u64; BOUNCES],
    /// How far apart the rays started at that bounce, by powers of two of ulp.
    offsets: [u64; OFFSETS],
    /// Sum of differences of radiance, fixed point less double precision, mean of the channels.
    difference: f64,
    /// And of their squares.
    squares: f64,
}

impl Default for Share {
    fn default() -> Self {
        Self {
            paths: 0,
            inherited: 0,
            bounces: [0; BOUNCES],
            offsets: [0; OFFSETS],
            difference: 0.0,
            squares: 0.0,
        }
    }
}

impl Share {
    fn add(&mut self, parting: &Parting) {
        self.paths += 1;
        self.inherited += u64::from(parting.is_inherited);
        self.bounces[(parting.bounce as usize - 1).min(BOUNCES - 1)] += 1;
        let exponent = (parting.offset.log2().ceil().max(f64::from(LEAST_OFFSET)) as i32) - LEAST_OFFSET;
        self.offsets[(exponent as usize).min(OFFSETS - 1)] += 1;
        self.difference += parting.difference;
        self.squares += parting.difference * parting.difference;
    }

    fn merge(&mut self, other: &Self) {
        self.paths += other.paths;
        self.inherited += other.inherited;
        let counts = self.bounces.iter_mut().chain(&mut self.offsets);
        for (count, other) in counts.zip(other.bounces.iter().chain(&other.offsets)) {
            *count += other;
        }
        self.difference += other.difference;
        self.squares += other.squares;
    }

    /// The bounce by which half of the paths had parted; 0 without paths.
    pub fn median_bounce(&self) -> u32 {
        let mut seen = 0;
        let until = self.bounces.iter().take_while(|&count| {
            seen += count;
            2 * seen < self.paths
        });
        let before = until.count() as u32;
        if self.paths == 0 { 0 } else { before + 1 }
    }

    /// The power of two of ulp (2^-16 units of length) that half of the offsets stay below; none without paths.
    pub fn median_offset(&self) -> Option<f64> {
        let mut seen = 0;
        let bin = self.offsets.iter().position(|count| {
            seen += count;
            2 * seen >= self.paths && self.paths > 0
        })?;
        Some(2f64.powi(bin as i32 + LEAST_OFFSET))
    }
}

/// Where two paths part, or end together.
struct Parting {
    cause: Cause,
    /// From 1.
    bounce: u32,
    is_inherited: bool,
    /// In ulp of 2^-16.
    offset: f64,
    /// In the scene's radiance, mean of the channels.
    difference: f64,
}

/// All paths of a picture beside their doubles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Divergence {
    /// Paths walked.
    pub samples: u64,
    /// Sum of the doubles' radiance, mean of the channels.
    radiance: f64,
    shares: [Share; Cause::ALL.len()],
}

/// A figure of a picture, and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// The figure.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

impl Divergence {
    /// What a cause did.
    pub fn share(&self, cause: Cause) -> &Share {
        &self.shares[cause as usize]
    }

    /// Mean radiance in double precision.
    pub fn mean(&self) -> f64 {
        self.radiance / self.samples as f64
    }

    /// What a cause adds to the picture's bias, as a share of its mean radiance: the mean difference of all samples, of which
    /// those with other causes count as none.
    pub fn bias(&self, cause: Cause) -> Figure {
        let share = self.share(cause);
        self.figure(share.difference, share.squares)
    }

    /// All causes together: the bias of arithmetic alone.
    pub fn total_bias(&self) -> Figure {
        let sum = |value: fn(&Share) -> f64| self.shares.iter().map(value).sum();
        self.figure(sum(|share| share.difference), sum(|share| share.squares))
    }

    fn figure(&self, difference: f64, squares: f64) -> Figure {
        let spread = squares - difference * difference / self.samples as f64;
        Figure {
            value: difference / self.radiance,
            standard_error: spread.max(0.0).sqrt() / self.radiance,
        }
    }

    /// Root of a cause's mean squared difference of a sample, in radiance, those with other causes counting as none: what it adds
    /// to the noise between the two pictures.
    pub fn rms(&self, cause: Cause) -> f64 {
        (self.share(cause).squares / self.samples as f64).sqrt()
    }

    /// The same of all causes together.
    pub fn total_rms(&self) -> f64 {
        let squares: f64 = self.shares.iter().map(|share| share.squares).sum();
        (squares / self.samples as f64).sqrt()
    }

    /// The share of paths that part.
    pub fn parted(&self) -> f64 {
        1.0 - self.share(Cause::Rounding).paths as f64 / self.samples as f64
    }

    fn add(&mut self, parting: &Parting, radiance: f64) {
        self.samples += 1;
        self.radiance += radiance;
        self.shares[parting.cause as usize].add(parting);
    }

    fn merged(mut self, other: &Self) -> Self {
        self.samples += other.samples;
        self.radiance += other.radiance;
        for (share, other) in self.shares.iter_mut().zip(&other.shares) {
            share.merge(other);
        }
        self
    }
}

/// Walks all paths of `plan` beside their doubles, on all host cores.
///
/// `progress` is told of samples done since it was last told.
pub fn explain<P: Explicable>(
    compiled: &CompiledScene,
    plan: &Plan,
    progress: impl Fn(u64) + Sync,
) -> Divergence {
    beside_doubles::<P>(compiled, plan, None, progress)
}

/// The same for paths that are in double precision themselves, but for one quantity of every ray, which is rounded to the nearest
/// in the format that `precise` has for it: what that format alone does.
pub fn explain_rounding<P: Explicable>(
    compiled: &CompiledScene,
    plan: &Plan,
    rounded: Quantity,
    progress: impl Fn(u64) + Sync,
) -> Divergence {
    beside_doubles::<Lockstep<P>>(compiled, plan, Some(rounded), progress)
}

fn beside_doubles<P: Explicable>(
    compiled: &CompiledScene,
    plan: &Plan,
    rounded: Option<Quantity>,
    progress: impl Fn(u64) + Sync,
) -> Divergence {
    let scene = compiled.view();
    let unit = 2f64.powi(-compiled.exponent) / 3.0;
    let cameras = (Camera::new(&compiled.camera), Camera::new(&compiled.camera));
    let spans: Vec<Divergence> = (0..plan.spans())
        .into_par_iter()
        .map(|span| {
            let mut found = Divergence::default();
            for pass in 0..plan.passes() {
                let id = pass * plan.spans() + span;
                let mut random = Counted::<P::Random>::for_unit(plan.seed, id);
                let before = found.samples;
                for (_, [column, row]) in samples(plan, id) {
                    let mut doubles = random.clone();
                    let fixed = cameras.0.ray(column, row, &mut random);
                    let exact = cameras.1.ray(column, row, &mut doubles);
                    let pair = Pair::<P, Lockstep<P>> {
                        fixed: Walk::new(fixed, random).rounding(rounded),
                        exact: Walk::new(exact, doubles),
                    };
                    let (parting, radiance);
                    (parting, radiance, random) = pair.walk(&scene, plan, unit);
                    found.add(&parting, radiance);
                }
                progress(found.samples - before);
            }
            found
        })
        .collect();
    // In their order, so that sums of floats are the same each time.
    spans.iter().fold(Divergence::default(), Divergence::merged)
}

/// A path and its double.
struct Pair<P: Profile, D: Profile> {
    fixed: Walk<P>,
    exact: Walk<D>,
}

impl<P, D> Pair<P, D>
where
    P: Explicable,
    D: Explicable<Numbers = floating::Floating<f64>, Random = P::Random>,
{
    /// Walks both to their ends. Says how they parted, the double's radiance, and what random numbers come next.
    fn walk(mut self, scene: &Scene<'_>, plan: &Plan, unit: f64) -> (Parting, f64, Counted<P::Random>) {
        let mut parting = self.walk_together(scene, plan);
        while !self.fixed.is_over {
            self.fixed.step(scene, plan);
        }
        while !self.exact.is_over {
            self.exact.step(scene, plan);
        }
        let grey = |sums: [U32F32; 3]| sums.iter().map(|sum| sum.to_num::<f64>()).sum::<f64>() * unit;
        let (fixed, exact) = (grey(self.fixed.sums()), grey(self.exact.sums()));
        parting.difference = fixed - exact;
        (parting, exact, self.fixed.random)
    }

    /// Walks both for as long as they are one path.
    fn walk_together(&mut self, scene: &Scene<'_>, plan: &Plan) -> Parting {
        loop {
            let offset = offset(&self.fixed.ray, &self.exact.ray);
            let mut alike = taken_over::<P, D>(&self.fixed);
            let fixed = self.fixed.step(scene, plan);
            let exact = self.exact.step(scene, plan);
            let cause = Cause::between(&fixed, &exact);
            if cause.is_some() || self.fixed.is_over {
                return Parting {
                    cause: cause.unwrap_or(Cause::Rounding),
                    bounce: self.fixed.rays,
                    is_inherited: cause.is_some()
                        && Cause::between(&fixed, &alike.step(scene, plan)).is_none(),
                    offset,
                    difference: 0.0,
                };
            }
        }
    }
}

/// How far two rays' starts are from each other, in ulp of 2^-16.
fn offset<A: Readable, B: Readable>(one: &Ray<A>, other: &Ray<B>) -> f64 {
    let along = |i: usize| A::length_of(one.origin[i]) - B::length_of(other.origin[i]);
    65536.0 * (0..3).map(|i| along(i).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests;
