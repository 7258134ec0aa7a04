//! The judgement of rounds that are made up: no compiler, no clock.

use super::*;
use crate::image::picture::Picture;

/// One pixel by both, three rounds of 64 samples: the plain one of this mean, the reference of mean 1, a sample's variance 6.4 and 0.64.
fn rounds(mean: f64) -> Rounds {
    let estimate = |mean: f64, variance: f64| Estimate {
        picture: Picture::new(1, 1, vec![Some([mean; 3])]),
        variance: Some(vec![[variance; 3]]),
        spp: Some(64),
    };
    let known = Rendered {
        estimate: estimate(1.0, 0.01),
        plain_variance: vec![[6.4; 3]],
        looking_variance: vec![[6.4; 3]],
    };
    Rounds {
        plain: vec![estimate(mean, 0.1); 3],
        reference: vec![known; 3],
        seconds: [64e-6, 32e-6],
    }
}

fn judged(name: &str, mean: f64) -> Result<Outcome, ContestError> {
    let text = "format = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nplane_height = 1\n\
                [[sphere]]\nname = \"room\"\nhollow = true\ncentre = [0, 0, 0]\nradius = 10\nemission = [1, 1, 1]\ndiffuse = [0, 0, 0]";
    let contest = Contest {
        scene: &Scene::parse(name, text).expect("a scene"),
        size: Size { width: 1, height: 1 },
        spp: 64,
    };
    contest.judge(&rounds(mean))
}

#[test]
fn efficiency_is_one_over_variance_times_time() {
    let outcome = judged("room.toml", 1.0).expect("they agree");
    assert_eq!(outcome.spp, 192);
    assert!((outcome.plain.seconds_per_sample - 1e-6).abs() < 1e-18);
    assert!((outcome.plain.variance.arithmetic - 6.4).abs() < 1e-12);
    // A tenth of the variance in half the time.
    assert!(
        (outcome.ratio.arithmetic - 20.0).abs() < 1e-9,
        "{:?}",
        outcome.ratio
    );
    assert!(
        (outcome.ratio.geometric - 20.0).abs() < 1e-9,
        "{:?}",
        outcome.ratio
    );
    assert!(
        outcome.table().contains("20.0 times as efficient"),
        "{}",
        outcome.table()
    );
}

/// The standard error of the difference is the root of 0.11 / 3, a fifth.
#[test]
fn renderers_of_different_pictures_have_no_ratio() {
    assert!(judged("room.toml", 1.76).is_ok());
    let error = judged("room.toml", 1.78).expect_err("they disagree").to_string();
    assert!(
        error.contains("about room") && error.contains("4.1 standard errors"),
        "{error}"
    );
}

#[test]
fn only_of_the_standard_scene_it_is_known_how_efficient_the_reference_has_to_be() {
    let slow = |name: &str| {
        let mut outcome = judged(name, 1.0).expect("they agree");
        assert!(outcome.suffices().is_ok());
        outcome.ratio.arithmetic = 9.9;
        outcome
    };
    assert!(slow("room.toml").suffices().is_ok());
    let error = slow("cornell.toml")
        .suffices()
        .expect_err("it is too slow")
        .to_string();
    assert!(error.contains("only 9.90 times"), "{error}");
}
