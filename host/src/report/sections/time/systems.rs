//! The tracers that are compared, and how each draws a picture on the host.

use floating::Lockstep;
use tracer::kronecker::Stratified;
use tracer::profile::{Paper, Precise, Profile};
use tracer::unit::{Plan, Termination};

use crate::firmware::arithmetic::Arithmetic;
use crate::image::picture::Picture;
use crate::oracle::{direct, lockstep};
use crate::scene::{CompiledScene, Integrator, Scene, samples_per_unit};
use crate::stability::Effort;

/// A way to compute the picture.
pub(super) struct System {
    pub(super) name: &'static str,
    /// As the rows of samples call it.
    pub(super) row: RowName,
    pub(super) integrator: Integrator,
    pub(super) arithmetic: Arithmetic,
    /// A picture beside the same samples in double precision.
    pub(super) paired: fn(&CompiledScene, &Plan, &Effort) -> lockstep::Paired,
    /// The picture alone, and what its film's sums hash to.
    pub(super) film: fn(&CompiledScene, &Plan) -> (Picture, String),
    /// Whether there is an arithmetic to tell from double precision.
    pub(super) is_exact: bool,
}

/// Profile, integrator and sampler.
pub(super) type RowName = [&'static str; 3];

fn paired<P: Profile<Random: Clone>>(
    compiled: &CompiledScene,
    plan: &Plan,
    effort: &Effort,
) -> lockstep::Paired {
    lockstep::render::<P>(compiled, plan, |samples| effort.done(2 * samples))
}

fn film<P: Profile>(compiled: &CompiledScene, plan: &Plan) -> (Picture, String) {
    let film = direct::film::<P>(compiled, plan);
    (film.picture(), film.sha256())
}

/// A system whose arithmetic is not double precision.
const fn system<P: Profile<Random: Clone>>(
    name: &'static str,
    row: RowName,
    integrator: Integrator,
    arithmetic: Arithmetic,
) -> System {
    System {
        name,
        row,
        integrator,
        arithmetic,
        paired: paired::<P>,
        film: film::<P>,
        is_exact: false,
    }
}

/// A system whose paths meet light and do not look for it.
const fn path<P: Profile<Random: Clone>>(
    name: &'static str,
    profile: &'static str,
    arithmetic: Arithmetic,
) -> System {
    system::<P>(
        name,
        [profile, "path", "independent"],
        Integrator::Path,
        arithmetic,
    )
}

pub(super) const SYSTEMS: [System; 5] = [
    system::<Stratified<Precise>>(
        "precise, next event, Kronecker",
        ["precise", "next-event", "kronecker"],
        Integrator::NextEvent,
        Arithmetic::Precise,
    ),
    path::<Precise>("precise", "precise", Arithmetic::Precise),
    path::<Paper>("paper", "paper", Arithmetic::Paper),
    path::<Lockstep<Precise, f32>>("soft float, single", "precise in f32", Arithmetic::Precise),
    System {
        is_exact: true,
        ..path::<Lockstep<Precise, f64>>("soft float, double", "precise in f64", Arithmetic::Precise)
    },
];

/// The plan of a picture as cores have it.
pub(super) fn plan(
    arithmetic: Arithmetic,
    scene: &Scene,
    [width, height]: [u16; 2],
    spp: u32,
    seed: u64,
) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: samples_per_unit(scene, spp, Termination::Roulette),
        seed,
        termination: Termination::Roulette,
        epsilon: arithmetic.epsilon(scene.scale().magnification),
    }
}
