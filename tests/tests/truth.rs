//! The profiles against double precision: the whole picture, every tile, and path by path.
//!
//! Seeds are fixed, so each of these has one outcome. The bounds are what sampling noise allows, not what was found.

#![expect(clippy::print_stdout, reason = "figures of tests, by helpers of theirs")]

use std::sync::OnceLock;

use host::image::picture::Estimate;
use host::oracle::compare::{Comparison, compare};
use host::scene::{Material, Scene};
use tracer::profile::{Paper, Precise, Profile};
use whole_system::{cornell, estimate, film, plan, reference, repository};

fn grey(mean: [f64; 3]) -> f64 {
    mean.iter().sum::<f64>() / 3.0
}

fn show(name: &str, found: &Comparison) {
    let tiles = &found.tiles;
    println!(
        "{name}: mean {:.5} against {:.5}, bias {:+.3} % (standard error {:.3} %), rmse {:.5}, worst tile {:+.2} %, \
         largest z {:.2} of {} with a threshold of {:.2}",
        grey(found.mean),
        grey(found.reference_mean),
        100.0 * found.bias.unwrap(),
        100.0 * found.bias_standard_error.unwrap(),
        found.rmse,
        100.0 * tiles.most_biased().unwrap().bias,
        tiles.max_z(),
        tiles.tested(),
        tiles.threshold_z,
    );
}

/// A small picture of little noise, for the tests that look at tiles.
fn small_reference() -> &'static Estimate {
    static REFERENCE: OnceLock<Estimate> = OnceLock::new();
    REFERENCE.get_or_init(|| reference(&cornell(), 64, 48, 4096))
}

/// What a wide picture shows, tracer and reference work out each for itself.
#[test]
fn a_wide_picture_is_the_reference_s() {
    let (precise, _) = estimate::<Precise>(&cornell(), &plan::<Precise>(64, 36, 256));
    let found = compare(&precise, &reference(&cornell(), 64, 36, 1024)).unwrap();
    show("precise, 16:9", &found);
    assert_eq!(found.tiles.failed().count(), 0);
}

/// 25 million samples on either side: the two means' noise is 0.1 % together, half of the bound.
#[test]
fn precise_is_as_bright_as_double_precision() {
    let reference = grey(reference(&cornell(), 256, 192, 512).picture.mean().unwrap());
    assert!(
        (reference - 0.3131).abs() < 0.001,
        "the reference itself: {reference}"
    );
    let precise = film::<Precise>(&cornell(), &plan::<Precise>(256, 192, 512));
    let precise = grey(precise.picture().mean().unwrap());
    let bias = precise / reference - 1.0;
    println!(
        "precise: mean {precise:.5} against {reference:.5}, bias {:+.3} %",
        100.0 * bias
    );
    assert!(bias.abs() < 0.002);
}

#[test]
fn no_tile_of_precise_is_further_off_than_chance_allows() {
    let (precise, _) = estimate::<Precise>(&cornell(), &plan::<Precise>(64, 48, 1024));
    let found = compare(&precise, small_reference()).unwrap();
    show("precise", &found);
    assert_eq!(found.tiles.failed().count(), 0);
}

#[test]
fn no_tile_is_off_in_scenes_of_other_kinds() {
    for name in ["open", "tiny", "mirrors"] {
        let scene = Scene::load(&repository(&format!("tests/scenes/{name}.toml"))).unwrap();
        let reference = reference(&scene, 64, 48, 1024);
        let (precise, _) = estimate::<Precise>(&scene, &plan::<Precise>(64, 48, 1024));
        let found = compare(&precise, &reference).unwrap();
        show(name, &found);
        assert_eq!(found.tiles.failed().count(), 0, "{name}");
    }
}

/// Proof that the tile test can fail: the glass ball gets an index of 1.3 instead of 1.5, which moves its caustic and
/// leaves the mean where it was.
#[test]
fn tiles_see_a_glass_ball_of_the_wrong_index() {
    let mut wrong = cornell();
    for sphere in &mut wrong.spheres {
        if let Material::Glass { index, .. } = &mut sphere.material {
            *index = 1.3;
        }
    }
    let (precise, _) = estimate::<Precise>(&wrong, &plan::<Precise>(64, 48, 4096));
    let found = compare(&precise, small_reference()).unwrap();
    show("index 1.3", &found);
    assert!(found.bias.unwrap().abs() < 0.01, "the mean alone would not tell");
    assert!(found.tiles.failed().count() > 0);
}

fn share_within<P: Profile>(limit: f64) -> f64 {
    let (fixed, lockstep) = estimate::<P>(&cornell(), &plan::<P>(64, 48, 64));
    let pairs = fixed
        .picture
        .pixels()
        .iter()
        .flatten()
        .zip(lockstep.picture.pixels().iter().flatten());
    let same = pairs
        .filter(|(a, b)| (0..3).all(|i| (a[i] - b[i]).abs() < limit))
        .count();
    same as f64 / fixed.picture.pixels().len() as f64
}

/// A pixel of 64 samples walks about 430 rays; one path that rounding sends elsewhere spoils it.
#[test]
fn precise_follows_the_paths_of_its_double() {
    let share = share_within::<Precise>(0.001);
    println!(
        "precise: {:.2} % of pixels within 0.001 of the lockstep oracle",
        100.0 * share
    );
    assert!(share > 0.95, "{share}");
    let share = share_within::<Paper>(0.001);
    println!(
        "paper: {:.2} % of pixels within 0.001 of the lockstep oracle",
        100.0 * share
    );
}

/// The bytes themselves, for every board and host alike. A change that means to alter them says so in the changelog and
/// puts the new ones here, as this test prints them.
#[test]
fn pictures_are_the_golden_ones_to_the_bit() {
    let precise = film::<Precise>(&cornell(), &plan::<Precise>(64, 48, 16)).sha256();
    let paper = film::<Paper>(&cornell(), &plan::<Paper>(32, 24, 8)).sha256();
    assert_eq!([precise.as_str(), paper.as_str()], GOLDEN);
}

const GOLDEN: [&str; 2] = [
    "c45891dc18c3da035e53483a7702a9ac251fb56183066d7a05d89d1ff96d39cb",
    "3e19da610219518bcf7fa47fba4fc0a658556deb181bfb8137694b8444a3d114",
];
