//! Pictures with known errors and known noise: what is there is found, what is not there is not.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::tiles::sidak_threshold;
use super::*;
use crate::image::picture::Picture;

const SIZE: (u16, u16) = (64, 48);
const NOISE: f64 = 0.05;

/// Standard normal numbers (Box and Muller).
struct Noise(Xoshiro256PlusPlus);

impl Noise {
    fn seeded(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        let mut uniform = || ((self.0.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let (r, angle) = (uniform(), uniform());
        (-2.0 * r.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

/// Radiance with a gradient, so that no two tiles are alike.
fn truth(x: u16, y: u16) -> [f64; 3] {
    let (x, y) = (f64::from(x) / 64.0, f64::from(y) / 48.0);
    [0.2 + 0.5 * x, 0.4 + 0.3 * y, 0.6 - 0.3 * x * y]
}

/// `truth` with noise and whatever `change` does to it.
fn estimate(seed: u64, change: impl Fn(u16, u16, [f64; 3]) -> [f64; 3]) -> Estimate {
    let mut noise = Noise::seeded(seed);
    let mut pixels = Vec::new();
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            // The channels share most of their noise, as those of a path do.
            let shared = noise.next();
            let radiance = change(x, y, truth(x, y));
            pixels.push(Some(
                radiance.map(|c| c + NOISE * (0.8 * shared + 0.6 * noise.next())),
            ));
        }
    }
    let variance = vec![[NOISE * NOISE; 3]; pixels.len()];
    Estimate {
        picture: Picture::new(SIZE.0, SIZE.1, pixels),
        variance: Some(variance),
        spp: Some(1024),
    }
}

fn unchanged(_: u16, _: u16, radiance: [f64; 3]) -> [f64; 3] {
    radiance
}

fn exact(change: impl Fn([f64; 3]) -> [f64; 3]) -> Estimate {
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    let pixels = pixels.map(|(x, y)| Some(change(truth(x, y)))).collect();
    Estimate {
        picture: Picture::new(SIZE.0, SIZE.1, pixels),
        variance: None,
        spp: None,
    }
}

/// Left, top and channel of every failed test.
fn failures(comparison: &Comparison) -> Vec<(u16, u16, usize)> {
    comparison
        .tiles
        .failed()
        .map(|(tile, channel)| (tile.x, tile.y, channel))
        .collect()
}

#[test]
fn a_known_bias_is_found_with_its_sign() {
    for factor in [0.98, 1.0, 1.05] {
        let image = estimate(1, |_, _, radiance| radiance.map(|c| c * factor));
        let comparison = compare(&image, &estimate(2, unchanged)).unwrap();
        let (bias, error) = (comparison.bias.unwrap(), comparison.bias_standard_error.unwrap());
        assert!(
            (bias - (factor - 1.0)).abs() < 4.0 * error,
            "{factor}: {bias} +- {error}"
        );
        assert!(error < 0.004, "{error}");
    }
}

#[test]
fn without_noise_every_figure_is_exact() {
    let comparison = compare(&exact(|rgb| rgb.map(|c| c + 0.1)), &exact(|rgb| rgb)).unwrap();
    let level: f64 = comparison.reference_mean.iter().sum::<f64>() / 3.0;
    assert!((comparison.bias.unwrap() - 0.1 / level).abs() < 1e-12);
    assert!((comparison.rmse - 0.1).abs() < 1e-12);
    assert!((comparison.max_abs - 0.1).abs() < 1e-12);
    assert!(comparison.squared_error.standard_error < 1e-12);
    assert_eq!(comparison.bias_standard_error, None);
    assert_eq!(comparison.uniformity, None);
    assert_eq!(comparison.tiles.max_z(), f64::INFINITY);
    assert_eq!(comparison.tiles.failed().count(), comparison.tiles.tested());
}

#[test]
fn a_picture_equals_itself() {
    let image = estimate(1, unchanged);
    let comparison = compare(&image, &image).unwrap();
    assert_eq!(
        (comparison.bias, comparison.rmse, comparison.psnr_db),
        (Some(0.0), 0.0, None)
    );
    assert_eq!(comparison.tiles.failed().count(), 0);
    // Two estimates with noise of their own are never that alike, and the p-values say so.
    assert!(comparison.squared_error.corrected < 0.0);
    assert!(comparison.uniformity.unwrap().p_value < 1e-9);
}

#[test]
fn noise_is_taken_off_the_squared_error() {
    let off = compare(
        &estimate(1, |_, _, rgb| rgb.map(|c| c + 0.03)),
        &estimate(2, unchanged),
    )
    .unwrap();
    assert!((off.rmse - 0.03).abs() < 0.002, "{}", off.rmse);
    let none = compare(&estimate(1, unchanged), &estimate(2, unchanged)).unwrap();
    let SquaredError {
        corrected,
        standard_error,
    } = none.squared_error;
    assert!(
        corrected.abs() < 4.0 * standard_error,
        "{corrected} +- {standard_error}"
    );
    assert!(none.squared_error.rmse_at_most() < 0.02 && off.squared_error.rmse_at_most() > 0.03);
    // The raw mean square would have been 2 * 0.05^2 = 0.005.
    assert!(standard_error < 0.0002, "{standard_error}");
}

#[test]
fn noise_alone_raises_no_more_alarms_than_stated() {
    let runs = 300;
    let mut alarms = 0;
    let mut uneven = 0;
    let mut pixels = 0;
    for seed in 0..runs {
        let comparison = compare(&estimate(2 * seed, unchanged), &estimate(2 * seed + 1, unchanged)).unwrap();
        alarms += usize::from(comparison.tiles.failed().count() > 0);
        uneven += usize::from(comparison.uniformity.unwrap().p_value < 0.01);
        pixels += usize::from(!comparison.pixels.unwrap().failed.is_empty());
    }
    // 3 expected at most of each; 11 or more happen once in 3,000 such tests.
    assert!(alarms <= 10, "{alarms} of {runs}");
    assert!(uneven <= 10, "{uneven} of {runs}");
    assert!(pixels <= 10, "{pixels} of {runs}");
}

#[test]
fn one_wrong_pixel_is_named() {
    let wrong = |x: u16, y: u16, [r, g, b]: [f64; 3]| {
        let off = if (x, y) == (17, 5) { 10.0 * NOISE } else { 0.0 };
        [r, g, b + off]
    };
    let found = compare(&estimate(1, wrong), &estimate(2, unchanged))
        .unwrap()
        .pixels
        .unwrap();
    let failed: Vec<_> = found
        .failed
        .iter()
        .map(|test| (test.x, test.y, test.channel))
        .collect();
    assert_eq!(failed, [(17, 5, 2)]);
    assert_eq!((found.tested, found.max_z), (3 * 64 * 48, found.failed[0].z));
}

#[test]
fn few_samples_are_not_tested_for_a_normal_distribution() {
    let few = Estimate {
        spp: Some(64),
        ..estimate(1, unchanged)
    };
    assert_eq!(compare(&few, &estimate(2, unchanged)).unwrap().uniformity, None);
    assert_eq!(compare(&estimate(2, unchanged), &few).unwrap().uniformity, None);
    assert!(
        compare(&estimate(1, unchanged), &exact(|rgb| rgb))
            .unwrap()
            .uniformity
            .is_some()
    );
}

#[test]
fn one_dark_tile_is_caught_though_the_mean_forgives_it() {
    // 7 % too dark in one tile of 48: a fixed-point overflow once looked like this.
    let dark = |x: u16, y: u16, rgb: [f64; 3]| {
        if (24..32).contains(&x) && (16..24).contains(&y) {
            rgb.map(|c| c * 0.93)
        } else {
            rgb
        }
    };
    let comparison = compare(&estimate(1, dark), &exact(|rgb| rgb)).unwrap();
    assert!(comparison.bias.unwrap().abs() < 0.003, "{:?}", comparison.bias);
    let tiles = comparison.tiles;
    assert!(tiles.failed().count() > 0);
    assert!(
        tiles
            .failed()
            .all(|(tile, channel)| (tile.x, tile.y) == (24, 16) && tile.z[channel] < 0.0)
    );
    let worst = tiles.most_biased().unwrap();
    assert!((worst.bias + 0.07).abs() < 4.0 * worst.bias_noise, "{worst:?}");
}

#[test]
fn a_single_channel_is_caught_too() {
    let blue = |x: u16, y: u16, [r, g, b]: [f64; 3]| {
        if x < 8 && y < 8 {
            [r, g, b * 0.9]
        } else {
            [r, g, b]
        }
    };
    let comparison = compare(&estimate(3, blue), &exact(|rgb| rgb)).unwrap();
    assert_eq!(failures(&comparison), [(0, 0, 2)]);
}

#[test]
fn tiles_at_the_edges_are_tested() {
    // 10x9 pixels: tiles of 8x8, 2x8, 8x1 and 2x1, with an error in the last pixel only.
    let pixels = |last: f64| {
        let mut pixels = vec![Some([0.5; 3]); 90];
        pixels[89] = Some([last; 3]);
        Estimate {
            picture: Picture::new(10, 9, pixels),
            variance: Some(vec![[1e-4; 3]; 90]),
            spp: Some(4),
        }
    };
    let comparison = compare(&pixels(0.6), &pixels(0.5)).unwrap();
    assert_eq!(comparison.tiles.tested(), 12);
    assert_eq!(failures(&comparison), [(8, 8, 0), (8, 8, 1), (8, 8, 2)]);
    // The tile is that pixel and its left neighbour: 0.1 / 1.0.
    assert!((comparison.tiles.most_biased().unwrap().bias - 0.1).abs() < 1e-12);
}

#[test]
fn missing_pixels_are_left_out_and_counted() {
    let mut pixels = exact(|rgb| rgb).picture.pixels().to_vec();
    pixels[5] = None;
    pixels[700] = None;
    let holes = Estimate {
        picture: Picture::new(SIZE.0, SIZE.1, pixels),
        variance: None,
        spp: None,
    };
    let comparison = compare(&holes, &exact(|rgb| rgb)).unwrap();
    assert_eq!((comparison.missing, comparison.compared), (2, 64 * 48 - 2));
    assert_eq!(comparison.bias, Some(0.0));

    let nothing = Estimate {
        picture: Picture::new(64, 48, vec![None; 64 * 48]),
        variance: None,
        spp: None,
    };
    assert_eq!(
        compare(&nothing, &exact(|rgb| rgb)),
        Err(CompareError::NothingInCommon)
    );
}

#[test]
fn other_sizes_are_refused() {
    let small = Estimate {
        picture: Picture::new(1, 1, vec![Some([1.0; 3])]),
        variance: None,
        spp: None,
    };
    let message = compare(&small, &exact(|rgb| rgb)).unwrap_err().to_string();
    assert!(message.contains("1x1") && message.contains("64x48"), "{message}");
}

#[test]
fn a_black_reference_has_no_relative_bias() {
    let comparison = compare(&exact(|_| [0.1; 3]), &exact(|_| [0.0; 3])).unwrap();
    assert_eq!(comparison.bias, None);
    assert!((comparison.rmse - 0.1).abs() < 1e-12);
    assert!(comparison.tiles.most_biased().unwrap().bias.is_finite());
}

#[test]
fn psnr_is_over_what_a_display_shows() {
    // Both are white on a display, whatever their radiance.
    let comparison = compare(&exact(|_| [12.0; 3]), &exact(|_| [1.5; 3])).unwrap();
    assert_eq!(comparison.psnr_db, None);
    // Radiances that a display shows as 0.5 and 0.6: an error of 0.1 is 20 dB.
    let radiance = |shown: f64| ((shown + 0.055) / 1.055).powf(2.4);
    let comparison = compare(&exact(|_| [radiance(0.6); 3]), &exact(|_| [radiance(0.5); 3])).unwrap();
    assert!((comparison.psnr_db.unwrap() - 20.0).abs() < 1e-9);
}

#[test]
fn thresholds_are_those_of_the_normal_table() {
    assert!((sidak_threshold(1) - 2.5758).abs() < 1e-4);
    // 1 - 0.99^(1/144) = 6.979e-5, both sides.
    assert!(
        (sidak_threshold(144) - 3.9764).abs() < 1e-3,
        "{}",
        sidak_threshold(144)
    );
    assert!((two_sided_p(-1.96) - 0.05).abs() < 1e-4);
}

/// The parts of the standard error are those of either side, and the tiles' median is not moved by one bright tile.
#[test]
fn noise_is_told_apart_by_side() {
    let flat = |variance: &dyn Fn(usize) -> f64| Estimate {
        picture: Picture::new(24, 8, vec![Some([0.5; 3]); 192]),
        variance: Some((0..192).map(|pixel| [variance(pixel % 24 / 8); 3]).collect()),
        spp: Some(64),
    };
    let picture = flat(&|_| 9e-4);
    let reference = flat(&|tile| if tile == 2 { 1.0 } else { 1e-4 });
    let found = compare(&picture, &reference).unwrap();
    let near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-12;
    // Of a channel's sum over 192 pixels, 192 v; over three of 192 times 0.5 each.
    let relative = |sum: f64| sum.sqrt() / (192.0 * 0.5);
    assert!(near(found.standard_error.unwrap(), relative(192.0 * 9e-4)));
    let both = 64.0 + 128.0 * 1e-4;
    assert!(near(found.reference_standard_error.unwrap(), relative(both)));
    let share = found.noise_share.unwrap();
    assert!(near(share.tile, 1.0 / 3.0), "{share:?}");
    assert!(near(share.mean, (both / (192.0 * 9e-4)).sqrt()), "{share:?}");
    assert_eq!(share.largest(), share.mean);
    let exact = Estimate {
        variance: None,
        ..reference
    };
    let found = compare(&picture, &exact).unwrap();
    assert_eq!((found.reference_standard_error, found.noise_share), (None, None));
}

/// A sky without noise: off by what its light is rounded by, and by a little more.
#[test]
fn the_rounding_of_light_is_no_error() {
    let sky = |radiance: f64| exact(move |_| [radiance; 3]);
    let failed = |picture: &Estimate| compare(picture, &sky(0.7)).unwrap().tiles.failed().count();
    assert_eq!(failed(&sky(0.7 * (1.0 + 1.0 / 17_000.0))), 0);
    assert!(failed(&sky(0.7 * (1.0 + 1.0 / 16_000.0))) > 0);
    assert!(failed(&sky(0.7 * (1.0 - 1.0 / 16_000.0))) > 0);
}
