//! A picture without a fleet: every unit in this process, on all of its cores.

use fixedmath::U48F16;
use rayon::prelude::*;
use tracer::camera::Camera;
use tracer::integrator::{Integrator, Path};
use tracer::profile::Profile;
use tracer::scene::All;
use tracer::unit::{Plan, SPAN, Sums, render};
use wire::PixelSums;

use crate::firmware::Choice;
use crate::firmware::arithmetic::{Arithmetic, Sampler, with_choice, with_profile};
use crate::image::film::Film;
use crate::scene::CompiledScene;

/// The film that any fleet must end with.
///
/// # Panics
/// If the plan has more units than there are ids.
pub fn film<P: Profile>(compiled: &CompiledScene, plan: &Plan) -> Film {
    let units = plan.units().expect("unit ids fit 32 bits");
    let (scene, path) = (compiled.view(), Path::<P, All>::new(plan));
    let camera = Camera::new(&compiled.camera);
    let render_unit = |id| {
        let mut sums = [[U48F16::ZERO; 3]; SPAN];
        render(&path, &scene, &camera, plan, id, &mut sums);
        sums
    };
    let sums: Vec<Sums> = (0..units).into_par_iter().map(render_unit).collect();
    let mut film = Film::new(plan.width, plan.height).with_exponent(compiled.exponent);
    for (id, sums) in (0..units).zip(&sums) {
        let extent = plan.extent(id);
        let span = sums[..usize::from(extent.pixels)]
            .iter()
            .map(|pixel| pixel.map(U48F16::to_bits));
        let packet = PixelSums::new(&span.collect::<Vec<_>>()).expect("a unit fits a packet");
        let span: Vec<[u64; 3]> = packet.iter().collect();
        film.add(extent.first_pixel, extent.samples.into(), &span)
            .expect("units lie within the film");
    }
    film
}

/// The same by a profile and a sampler that are chosen at run time.
///
/// # Panics
/// As [`film`] does.
pub fn film_as(profile: Arithmetic, sampler: Sampler, compiled: &CompiledScene, plan: &Plan) -> Film {
    with_profile!(profile, sampler, P => film::<P>(compiled, plan))
}

/// The same by `precise` but for one choice, which is the published system's.
///
/// # Panics
/// As [`film`] does.
pub fn film_of_choice(choice: Choice, compiled: &CompiledScene, plan: &Plan) -> Film {
    with_choice!(choice, P => film::<P>(compiled, plan))
}
