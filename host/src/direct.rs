//! A picture without a fleet: every unit in this process, on all of its cores.

use rayon::prelude::*;
use tracer::profile::Profile;
use tracer::scene::{All, BlobError, Scene};
use tracer::unit::{Plan, RUN, render};

use crate::film::Film;
use crate::picture::Estimate;
use crate::scene::CompiledScene;
use crate::{lockstep, noise};

/// The film that any fleet must end with.
///
/// # Panics
/// If the plan has more units than there are ids.
pub fn film<P: Profile>(compiled: &CompiledScene, plan: &Plan) -> Result<Film, BlobError> {
    let units = plan.units().expect("unit ids fit 32 bits");
    let render_unit = |scene: &mut Result<Scene<P::Numbers>, BlobError>, id| {
        let scene = scene.as_ref().map_err(|error| *error)?;
        let mut sums = [[0; 3]; RUN];
        render::<P, All>(scene, plan, id, &mut sums);
        Ok(sums)
    };
    // A scene's numbers need not be fit to be shared between threads, so each thread has its own.
    let sums: Vec<_> = (0..units)
        .into_par_iter()
        .map_init(|| Scene::decode::<All>(&compiled.blob), render_unit)
        .collect::<Result<_, _>>()?;
    let mut film = Film::new(plan.width, plan.height).with_exponent(compiled.exponent);
    for (id, sums) in (0..units).zip(&sums) {
        let extent = plan.extent(id);
        let run = &sums[..usize::from(extent.pixels)];
        film.add(extent.first_pixel, extent.samples.into(), run)
            .expect("units lie within the film");
    }
    Ok(film)
}

/// The film's picture with the variance of its samples, and the lockstep oracle's.
///
/// # Panics
/// If the plan has more units than there are ids.
pub fn estimate<P: Profile>(
    compiled: &CompiledScene,
    plan: &Plan,
) -> Result<(Estimate, Estimate), BlobError> {
    let lockstep = lockstep::render::<P>(compiled, plan, |_| ())?;
    let picture = film::<P>(compiled, plan)?.picture();
    let fixed = Estimate {
        variance: noise::variance::<P>(compiled, plan, &picture, &lockstep, |_| ())?,
        picture,
        spp: lockstep.spp,
    };
    Ok((fixed, lockstep))
}
