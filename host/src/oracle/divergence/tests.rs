use tracer::geometry::PrimitiveId;
use tracer::integrator::{Integrator as _, Path};
use tracer::material::RadianceNumbers;
use tracer::profile::{Paper, Precise, Profile};
use tracer::scene::All;
use tracer::unit::{Termination, walk};

use super::*;
use crate::image::picture::Picture;
use crate::oracle::direct;
use crate::platform::workspace;
use crate::scene;

fn plan<P: Profile>(spp: u32) -> Plan {
    Plan {
        width: 32,
        height: 24,
        spp,
        samples_per_unit: spp as u16,
        seed: 3,
        termination: Termination::Roulette,
        epsilon: P::EPSILON,
    }
}

fn compiled(file: &str) -> CompiledScene {
    let file = workspace::file(file).unwrap();
    let scene = scene::Scene::load(&file).unwrap();
    scene::compile(&scene, 32, 24, scene::Integrator::Path)
}

/// Every sample of a picture, as the tracer itself walks it and as it is walked here: sums for the film, and rays.
fn assert_same_walk<P: Explicable>(compiled: &CompiledScene, plan: &Plan) {
    let (scene, path) = (compiled.view(), Path::<P, All>::new(plan));
    let camera = Camera::<P::Numbers>::new(&compiled.camera);
    for id in 0..plan.units().unwrap() {
        let mut own = Vec::new();
        walk(&path, &scene, &camera, plan, id, |pixel, sample| {
            own.push((pixel, sample.radiance.map(P::Numbers::film_sum), sample.rays));
        });
        let mut random = Counted::<P::Random>::for_unit(plan.seed, id);
        let mut here = Vec::new();
        for (pixel, [column, row]) in samples(plan, id) {
            let ray = camera.ray(column, row, &mut random);
            let mut walk = Walk::<P>::new(ray, random);
            while !walk.is_over {
                walk.step(&scene, plan);
            }
            here.push((pixel, walk.sums(), walk.rays));
            random = walk.random;
        }
        assert!(own == here, "unit {id} of {}", P::NAME);
    }
}

/// What is explained is what the tracer does: radiance to the last bit of a sum, and every ray.
#[test]
fn a_path_taken_apart_is_the_tracers_own() {
    for file in ["scenes/cornell.toml", "tests/scenes/cut-open.toml"] {
        let compiled = compiled(file);
        assert_same_walk::<Precise>(&compiled, &plan::<Precise>(16));
        assert_same_walk::<Lockstep<Precise>>(&compiled, &plan::<Precise>(16));
        assert_same_walk::<Paper>(&compiled, &plan::<Paper>(16));
        assert_same_walk::<Lockstep<Paper>>(&compiled, &plan::<Paper>(16));
        let flat = Plan {
            termination: Termination::Depth(4),
            ..plan::<Precise>(16)
        };
        assert_same_walk::<Precise>(&compiled, &flat);
    }
}

/// Every path has one cause, and all causes together are what sets the two pictures apart.
#[test]
fn causes_add_up() {
    let compiled = compiled("scenes/cornell.toml");
    let plan = plan::<Paper>(16);
    let found = explain::<Paper>(&compiled, &plan, |_| ());
    let paths: u64 = Cause::ALL.iter().map(|&cause| found.share(cause).paths).sum();
    assert_eq!((paths, found.samples), (32 * 24 * 16, 32 * 24 * 16));
    for cause in Cause::ALL {
        let share = found.share(cause);
        assert_eq!(share.bounces.iter().sum::<u64>(), share.paths, "{cause}");
        assert_eq!(share.offsets.iter().sum::<u64>(), share.paths, "{cause}");
    }
    let biases = Cause::ALL.map(|cause| found.bias(cause).value);
    let total = found.total_bias();
    assert!((biases.iter().sum::<f64>() - total.value).abs() < 1e-12);
    let grey = |picture: Picture| picture.mean().unwrap().iter().sum::<f64>() / 3.0;
    let fixed = grey(direct::film::<Paper>(&compiled, &plan).picture());
    // The film rounds each unit's sum to 2^-16, which moves no pixel's mean by more than 2^-17 / 16.
    assert!((fixed - found.mean() * (1.0 + total.value)).abs() < 2f64.powi(-21));
}

fn decisions() -> Decisions {
    Decisions {
        surface: Some(PrimitiveId::new(3)),
        survives: true,
        from_inside: false,
        branch: Some(Branch::Refracted),
        is_turned: false,
        drawn: 1,
    }
}

/// The first decision that differs is the cause, whatever follows from it.
#[test]
fn each_cause_is_told() {
    let one = decisions();
    assert_eq!(Cause::between(&one, &one), None);
    let miss = Decisions::default();
    assert_eq!(Cause::between(&one, &miss), Some(Cause::HitOrMiss));
    type Change = fn(&mut Decisions);
    let cases: [(Change, Cause); 7] = [
        (|other| other.surface = Some(PrimitiveId::new(4)), Cause::Nearest),
        (|other| other.survives = false, Cause::Roulette),
        (|other| other.from_inside = true, Cause::Side),
        (|other| other.branch = Some(Branch::Total), Cause::TotalReflection),
        (|other| other.branch = Some(Branch::Reflected), Cause::Fresnel),
        (|other| other.drawn = 2, Cause::Rejection),
        (|other| other.is_turned = true, Cause::Frame),
    ];
    for (number, (change, cause)) in cases.iter().enumerate() {
        let mut other = decisions();
        // All decisions after it differ, too.
        cases[number..]
            .iter()
            .rev()
            .for_each(|(change, _)| change(&mut other));
        change(&mut other);
        assert_eq!(Cause::between(&one, &other), Some(*cause));
    }
}

/// Double precision beside itself parts nowhere; with its rays' starts rounded it does, and a path that never parts stays close.
#[test]
fn what_is_rounded_is_what_parts() {
    let compiled = compiled("scenes/cornell.toml");
    let plan = plan::<Precise>(64);
    let same = explain::<Lockstep<Precise>>(&compiled, &plan, |_| ());
    assert_eq!((same.parted(), same.total_rms()), (0.0, 0.0));
    let rounded = explain_rounding::<Precise>(&compiled, &plan, Quantity::Start, |_| ());
    assert!(
        rounded.parted() > 0.0 && rounded.parted() < 0.001,
        "{}",
        rounded.parted()
    );
    let offset = rounded.share(Cause::Rounding).median_offset().unwrap();
    assert!((0.5..=16.0).contains(&offset), "{offset} ulp");
}
