//! The fast part of `cargo xtask verify stability`: what should hold in hard cases does, in a thousandth of them.

use host::image::picture::Picture;
use host::scene::Scene;
use host::stability::{Effort, PARTS};
use indicatif::ProgressBar;
use tracer::profile::{Paper, Precise};
use whole_system::{cornell, film, plan, reference, repository};

/// Of the full work, one part of so many.
const SHORT: u64 = 1000;

/// Parts that have nothing to find but figures for people are left out.
const JUDGED: [&str; 3] = ["reintersection", "convergence", "hard"];

#[test]
fn what_should_hold_does() {
    for name in JUDGED {
        let part = PARTS
            .iter()
            .find(|part| part.name == name)
            .expect("there is such a part");
        let findings = (part.measure)(&Effort::new(SHORT, ProgressBar::hidden()));
        let findings = findings.unwrap_or_else(|error| panic!("{name}: {error}"));
        for table in &findings.tables {
            println!("{table}");
        }
        assert!(findings.faults.is_empty(), "{name}: {:#?}", findings.faults);
    }
}

/// What is brightest in a picture.
fn brightest(picture: &Picture) -> f64 {
    let channels = picture.pixels().iter().flatten().flatten();
    channels.copied().fold(0.0, f64::max)
}

/// No light comes into a box that is closed: in 790,000 paths of fifteen bounces, with lamps two ulp behind the walls. By the published
/// arithmetic it is bright.
#[test]
fn a_sealed_box_is_dark() {
    let sealed = Scene::load(&repository("scenes/hard/sealed.toml")).unwrap();
    // The same with walls of a radius that 16:16 has no room for, whose corners are where its corner lamp is.
    let mut flat = sealed.clone();
    flat.spheres.retain(|sphere| sphere.name != "corner lamp");
    for wall in flat.spheres.iter_mut().filter(|sphere| sphere.hollow) {
        wall.centre = wall.centre.map(|c| c / 999.0 * 99_999.0);
        wall.radius = 1e5;
    }
    for scene in [&sealed, &flat] {
        let precise = film::<Precise>(scene, &plan::<Precise>(64, 48, 256));
        assert_eq!(brightest(&precise.picture()), 0.0);
    }
    let paper = film::<Paper>(&sealed, &plan::<Paper>(16, 12, 16));
    assert!(brightest(&paper.picture()) > 10.0);
}

/// The light's reflection on the glass ball of the Cornell box is within 1 % of double precision, of which the standard error of both means
/// is 0.3 %. The published system is not.
#[test]
fn the_glass_ball_reflects_the_light() {
    let mut hat = cornell();
    hat.camera.direction = [0.0875, -0.1113, -0.99];
    hat.camera.plane_height = 0.008;
    let mean = |picture: &Picture| picture.mean().unwrap().iter().sum::<f64>() / 3.0;
    let double = mean(&reference(&hat, 16, 12, 8192).estimate.picture);
    let off = |picture: &Picture| mean(picture) / double - 1.0;
    let precise = off(&film::<Precise>(&hat, &plan::<Precise>(16, 12, 8192)).picture());
    let paper = off(&film::<Paper>(&hat, &plan::<Paper>(16, 12, 2048)).picture());
    println!("precise {:+.2} %, paper {:+.2} %", 100.0 * precise, 100.0 * paper);
    assert!(precise.abs() < 0.01);
    assert!(paper.abs() > 0.01);
}
