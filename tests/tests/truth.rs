//! The profiles against double precision: the whole picture, every tile, and path by path.
//!
//! Seeds are fixed, so each of these has one outcome. The bounds are what sampling noise allows, not what was found.

#![expect(clippy::print_stdout, reason = "figures of tests, by helpers of theirs")]

use std::sync::OnceLock;

use host::bench::generators::low_bits::PreciseByLowBits;
use host::image::picture::{Estimate, Picture};
use host::oracle::compare::{Comparison, SIDE, compare};
use host::oracle::direct;
use host::oracle::lockstep::Paired;
use host::oracle::reference::Rendered;
use host::scene::{Integrator, Material, Scene, compile};
use tracer::kronecker::Stratified;
use tracer::profile::{Paper, Precise, Profile};
use tracer::unit::Plan;
use whole_system::{
    cornell, equivalent, estimate, estimate_by, explained_by_noise, film, pair, plan, reference, repository,
};

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
fn small_reference() -> &'static Rendered {
    static REFERENCE: OnceLock<Rendered> = OnceLock::new();
    REFERENCE.get_or_init(|| reference(&cornell(), 64, 48, 1024))
}

/// Samples a pixel of the small picture by `precise`.
const SPP: u32 = 1024;

/// It and its double.
fn small_pair() -> &'static Paired {
    static PAIR: OnceLock<Paired> = OnceLock::new();
    PAIR.get_or_init(|| pair::<Precise>(&cornell(), &plan::<Precise>(64, 48, SPP)))
}

/// It as the film has it.
fn small_picture() -> &'static Picture {
    static PICTURE: OnceLock<Picture> = OnceLock::new();
    PICTURE.get_or_init(|| film::<Precise>(&cornell(), &plan::<Precise>(64, 48, SPP)).picture())
}

/// A picture that has the small picture's noise.
fn with_noise(picture: Picture) -> Estimate {
    small_reference().pooled_noise(
        Estimate {
            picture,
            ..small_pair().picture.clone()
        },
        Integrator::Path,
    )
}

/// What a wide picture shows, tracer and reference work out each for itself.
#[test]
fn a_wide_picture_is_the_reference_s() {
    let precise = estimate::<Precise>(&cornell(), &plan::<Precise>(64, 36, 128));
    let reference = reference(&cornell(), 64, 36, 128);
    let found = compare(
        &reference.pooled_noise(precise, Integrator::Path),
        &reference.estimate,
    )
    .unwrap();
    show("precise, 16:9", &found);
    assert_eq!(found.tiles.failed().count(), 0);
}

/// Pixels so large that the tent filter starts rays above the ceiling: all see it there at once.
#[test]
fn a_tiny_picture_is_the_reference_s() {
    let (width, height) = (16, 12);
    let reference = reference(&cornell(), width, height, 1024);
    for integrator in [Integrator::Path, Integrator::NextEvent] {
        let precise = estimate_by::<Precise>(&cornell(), &plan::<Precise>(width, height, 2048), integrator);
        let found = compare(&precise, &reference.estimate).unwrap();
        show(&format!("precise, {width}x{height}, {integrator}"), &found);
        assert!(
            found.bias.unwrap().abs() < 0.02,
            "5 % apart if one sees through it"
        );
        assert_eq!(found.tiles.failed().count(), 0);
    }
}

/// The noise of both means is 0.1 % together, half of the bound: most of it that of 3 million samples of paths that look for light. The
/// reference has as many, and a quarter of their variance for each.
#[test]
fn precise_is_as_bright_as_double_precision() {
    let reference = grey(
        reference(&cornell(), 256, 192, 64)
            .estimate
            .picture
            .mean()
            .unwrap(),
    );
    assert!(
        (reference - 0.3131).abs() < 0.001,
        "the reference itself: {reference}"
    );
    let compiled = compile(&cornell(), 256, 192, Integrator::NextEvent);
    let precise = direct::film::<Stratified<Precise>>(&compiled, &plan::<Precise>(256, 192, 64));
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
    let reference = small_reference();
    let precise = with_noise(small_picture().clone());
    let found = compare(&precise, &reference.estimate).unwrap();
    show("precise", &found);
    assert_eq!(found.tiles.failed().count(), 0);
}

#[test]
fn no_tile_is_off_in_scenes_of_other_kinds() {
    // As many samples as give the reference less noise than the picture has.
    for (name, spp) in [("open", 32), ("tiny", 64), ("mirrors", 128)] {
        let scene = Scene::load(&repository(&format!("tests/scenes/{name}.toml"))).unwrap();
        let reference = reference(&scene, 64, 48, spp);
        let precise = estimate::<Precise>(&scene, &plan::<Precise>(64, 48, 128));
        let found = compare(
            &reference.pooled_noise(precise, Integrator::Path),
            &reference.estimate,
        )
        .unwrap();
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
    let wrong = estimate::<Precise>(&wrong, &plan::<Precise>(64, 48, 2048));
    let reference = small_reference();
    let found = compare(
        &reference.pooled_noise(wrong, Integrator::Path),
        &reference.estimate,
    )
    .unwrap();
    show("index 1.3", &found);
    assert!(found.bias.unwrap().abs() < 0.01, "the mean alone would not tell");
    assert!(found.tiles.failed().count() > 0);
}

/// Fixed point against double precision, path by path: the mean within 0.05 %, every tile within a quarter of a level on the display.
/// A picture that is further off passes once in a thousand times.
#[test]
fn precise_is_its_double_within_a_quarter_of_a_level() {
    let found =
        equivalent("precise", small_picture(), small_pair()).unwrap_or_else(|error| panic!("{error}"));
    let worst = found.worst().expect("tiles");
    println!(
        "precise: off by {:+.4} % of its mean's bound, worst tile ({}, {}) by {:+.1} % of its; false alarms {:.1e}",
        100.0 * found.picture.difference / found.picture.bound,
        worst.x,
        worst.y,
        100.0 * worst.test.difference / worst.test.bound,
        found.false_alarm(),
    );
    assert!(
        found.false_alarm() < 0.01,
        "more samples, or this fails by chance"
    );
}

/// Float against float, which share no formula: nothing but noise is between them.
#[test]
fn the_double_is_the_reference_but_for_noise() {
    let reference = small_reference();
    let double = reference.pooled_noise(small_pair().double.clone(), Integrator::Path);
    let found = explained_by_noise("double", &double, &reference.estimate);
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    let (pixels, uniformity) = (found.pixels.expect("tested"), found.uniformity.expect("tested"));
    println!(
        "double: largest z of a pixel {:.2} of {:.2}, p-values {:?}, p {:.3}",
        pixels.max_z, pixels.threshold_z, uniformity.histogram, uniformity.p_value
    );
}

/// `picture`, with another pixel for each of its own.
fn changed(
    picture: &Picture,
    change: impl Fn(usize, usize, &dyn Fn(usize, usize) -> [f64; 3]) -> [f64; 3],
) -> Picture {
    let (width, height) = picture.size();
    let at = |x: usize, y: usize| picture.pixels()[y * usize::from(width) + x].expect("every pixel is there");
    let places = (0..usize::from(height)).flat_map(|y| (0..usize::from(width)).map(move |x| (x, y)));
    Picture::new(
        width,
        height,
        places.map(|(x, y)| Some(change(x, y, &at))).collect(),
    )
}

/// Proof that equivalence can fail, and that it leaves what is needed to see why. An epsilon of 0.1 moves the mean by little where a surface is
/// left by identity; tiles tell it.
#[test]
fn planted_faults_are_not_equivalent() {
    let (picture, side) = (small_picture(), usize::from(SIDE));
    let fault = |name: &str, picture: &Picture| {
        equivalent(&format!("planted/{name}"), picture, small_pair()).expect_err("a fault is planted")
    };
    let darker = fault("darker", &changed(picture, |x, y, at| at(x, y).map(|c| 0.99 * c)));
    let folder = darker.rsplit(" are in ").next().expect("where the evidence is");
    for file in [
        "picture.png",
        "picture.exr",
        "reference.png",
        "reference.exr",
        "difference.png",
        "p-values.csv",
    ] {
        assert!(
            std::path::Path::new(folder).join(file).is_file(),
            "{file} in {folder}"
        );
    }
    let in_tile = |x: usize, y: usize| (x / side, y / side) == (3, 2);
    let tile = fault(
        "tile",
        &changed(picture, |x, y, at| {
            at(x, y).map(|c| if in_tile(x, y) { 1.01 * c } else { c })
        }),
    );
    assert!(
        tile.contains(", 3 of 144 tiles") && tile.contains("(24, 16) green"),
        "{tile}"
    );
    fault(
        "shifted",
        &changed(picture, |x, y, at| at(x.saturating_sub(1), y)),
    );
    let coarse = Plan {
        epsilon: Paper::EPSILON,
        ..plan::<Precise>(64, 48, SPP)
    };
    let coarse = fault("epsilon", &film::<Precise>(&cornell(), &coarse).picture());
    println!("{darker}\n{tile}\n{coarse}");
}

/// Proof that the tests of noise can fail: a picture one pixel aside, and random numbers that repeat.
#[test]
fn planted_faults_are_not_noise() {
    let reference = small_reference();
    let double = &small_pair().double.picture;
    let shifted = changed(double, |x, y, at| at(x.saturating_sub(1), y));
    let low_bits = film::<PreciseByLowBits>(&cornell(), &plan::<Precise>(64, 48, SPP)).picture();
    for (name, fault) in [("planted/shifted noise", shifted), ("planted/low bits", low_bits)] {
        let fault = with_noise(fault);
        let said = explained_by_noise(name, &fault, &reference.estimate).expect_err("a fault is planted");
        println!("{said}");
    }
}

/// A pixel of 64 samples walks about 430 rays; one path that rounding sends elsewhere spoils it.
#[test]
fn precise_follows_the_paths_of_its_double() {
    let Paired { picture, double, .. } = pair::<Precise>(&cornell(), &plan::<Precise>(64, 48, 64));
    let pairs = picture.picture.pixels().iter().flatten();
    let pairs = pairs.zip(double.picture.pixels().iter().flatten());
    let same = pairs.filter(|(a, b)| (0..3).all(|i| (a[i] - b[i]).abs() < 0.001));
    let share = same.count() as f64 / double.picture.pixels().len() as f64;
    println!(
        "precise: {:.2} % of pixels within 0.001 of their doubles",
        100.0 * share
    );
    assert!(share > 0.98, "{share}");
}

/// The bytes themselves, for every board and host alike. A change that means to alter them says so in the changelog and
/// puts the new ones here, as this test prints them.
#[test]
fn pictures_are_the_golden_ones_to_the_bit() {
    let precise = film::<Precise>(&cornell(), &plan::<Precise>(64, 48, 16)).sha256();
    let paper = film::<Paper>(&cornell(), &plan::<Paper>(32, 24, 8)).sha256();
    let compiled = compile(&cornell(), 64, 48, Integrator::NextEvent);
    let looking = direct::film::<Stratified<Precise>>(&compiled, &plan::<Precise>(64, 48, 24)).sha256();
    assert_eq!([precise.as_str(), paper.as_str(), looking.as_str()], GOLDEN);
}

const GOLDEN: [&str; 3] = [
    "7f747d408780baa786eea4f9e66ee325725eefbc1afb29220b9b8119d9e00fd4",
    "3e19da610219518bcf7fa47fba4fc0a658556deb181bfb8137694b8444a3d114",
    "cd69a5a5a91129c9de42f8dc06aafdd230444f4308b528259f947c7e0911a56d",
];
