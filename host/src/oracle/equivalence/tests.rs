use super::*;
use crate::image::picture::{Estimate, displayed};

const SIZE: (u16, u16) = (32, 24);

/// A double of 0.3 everywhere, beside which a picture has noise of this standard deviation a pixel.
fn pair(noise: f64) -> Paired {
    let count = usize::from(SIZE.0) * usize::from(SIZE.1);
    let double = Estimate {
        picture: flat(0.3),
        variance: None,
        spp: None,
    };
    Paired {
        picture: double.clone(),
        double,
        variance: vec![[noise * noise; 3]; count],
    }
}

fn flat(level: f64) -> Picture {
    let count = usize::from(SIZE.0) * usize::from(SIZE.1);
    Picture::new(SIZE.0, SIZE.1, vec![Some([level; 3]); count])
}

/// A double of 0.3 needs 0.0011 for a quarter of a level; 0.05 % of it is 0.00015.
#[test]
fn what_lies_within_the_bounds_passes_and_nothing_else() {
    let quiet = pair(1e-4);
    for (level, passes) in [
        (0.3, true),
        (0.30013, true),
        (0.29987, true),
        (0.3002, false),
        (0.2998, false),
    ] {
        assert_eq!(test(&flat(level), &quiet).unwrap().passes(), passes, "{level}");
    }
    // The same difference, inside its bound, is not known to be inside where there is much noise.
    let loud = test(&flat(0.3), &pair(0.05)).unwrap();
    assert!(!loud.passes() && loud.picture.difference == 0.0);
    assert!(
        loud.false_alarm() > 0.99,
        "and that was to be expected: {}",
        loud.false_alarm()
    );
}

#[test]
fn one_tile_is_found_by_name() {
    let mut pixels = flat(0.3).pixels().to_vec();
    for (index, pixel) in pixels.iter_mut().enumerate() {
        let (x, y) = (index % 32, index / 32);
        if (8..16).contains(&x) && (16..24).contains(&y) {
            *pixel = Some([0.3, 0.302, 0.3]);
        }
    }
    let found = test(&Picture::new(SIZE.0, SIZE.1, pixels), &pair(1e-4)).unwrap();
    let failed: Vec<_> = found
        .failed()
        .map(|tile| (tile.x, tile.y, tile.channel))
        .collect();
    assert_eq!(failed, [(8, 16, 1)]);
    assert!(found.picture.passes(), "the mean forgives it");
}

/// A mean on its bound passes as often as stated, and one without error as often as its power says.
#[test]
fn the_rates_are_those_of_the_normal_table() {
    let on_the_bound = |off: f64| Test {
        difference: 1.0 + off * 0.1,
        standard_error: 0.1,
        bound: 1.0,
    };
    // The 0.1 % quantile of the normal distribution is -3.0902.
    assert!(on_the_bound(-3.0903).passes() && !on_the_bound(-3.0901).passes());
    let power = Test {
        difference: 0.0,
        standard_error: 0.2,
        bound: 1.0,
    }
    .power();
    // 2 Phi(5 - 3.0902) - 1.
    assert!((power - 0.943_84).abs() < 1e-4, "{power}");
}

#[test]
fn a_tile_without_parted_paths_has_the_noise_of_its_like() {
    let mut pair = pair(0.01);
    for variance in &mut pair.variance[..8] {
        *variance = [0.0; 3];
    }
    let found = test(&flat(0.3), &pair).unwrap();
    let first = &found.tiles[0].test;
    assert!((first.standard_error / found.tiles[3].test.standard_error - 1.0).abs() < 0.02);
}

#[test]
fn a_step_of_the_display_is_that_much_radiance() {
    for radiance in [0.001, 0.01, 0.1, 0.3, 0.9] {
        let step = radiance_of(TILE, radiance);
        let shown = displayed(radiance + step) - displayed(radiance);
        assert!((shown / TILE - 1.0).abs() < 0.02, "{radiance}: {shown}");
    }
    assert!((radiance_of(TILE, 4.0) / radiance_of(TILE, 1.0) - 4.0).abs() < 1e-12);
}

#[test]
fn other_sizes_and_holes_are_refused() {
    let small = Picture::new(1, 1, vec![Some([0.3; 3])]);
    assert!(matches!(
        test(&small, &pair(0.01)),
        Err(CompareError::Size { .. })
    ));
    let mut pixels = flat(0.3).pixels().to_vec();
    pixels[7] = None;
    let holes = Picture::new(SIZE.0, SIZE.1, pixels);
    assert_eq!(test(&holes, &pair(0.01)), Err(CompareError::Incomplete(1)));
}
