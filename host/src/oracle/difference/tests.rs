//! What the drawing must show, looked for in its pixels.

use super::*;
use crate::image::picture::Estimate;
use crate::oracle::compare::compare;

fn estimate(size: (u16, u16), radiance: impl Fn(u16, u16) -> Option<f64>) -> Estimate {
    let places = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
    let pixels: Vec<_> = places
        .map(|(x, y)| radiance(x, y).map(|value| [value; 3]))
        .collect();
    let variance = Some(vec![[1e-6; 3]; pixels.len()]);
    Estimate {
        picture: Picture::new(size.0, size.1, pixels),
        variance,
        spp: Some(4),
    }
}

fn drawing(image: &Estimate, reference: &Estimate) -> Raster {
    let comparison = compare(image, reference).unwrap();
    draw("test", &image.picture, &reference.picture, &comparison).unwrap()
}

impl Raster {
    fn at(&self, x: u32, y: u32) -> [u8; 3] {
        let index = (y * self.width + x) as usize;
        self.rgb.as_chunks::<3>().0[index]
    }
}

#[test]
fn red_is_brighter_and_blue_is_darker() {
    let image = estimate((32, 24), |x, _| Some(if x < 16 { 0.4 } else { 0.6 }));
    let reference = estimate((32, 24), |_, _| Some(0.5));
    let drawing = drawing(&image, &reference);
    let layout = Layout::new((32, 24));
    let row = MARGIN + HEADER + layout.map.1 / 2;
    let left = drawing.at(layout.map_left + layout.map.0 / 4, row);
    let right = drawing.at(layout.map_left + 3 * layout.map.0 / 4, row);
    assert_eq!(left, diverging(-1.0));
    assert_eq!(right, diverging(1.0));
    assert!(left[2] > left[0] && right[0] > right[2]);
}

#[test]
fn no_difference_is_white_and_a_missing_pixel_is_black() {
    let image = estimate((16, 12), |x, y| (x != 8 || y != 6).then_some(0.5));
    let reference = estimate((16, 12), |_, _| Some(0.5));
    let drawing = drawing(&image, &reference);
    let layout = Layout::new((16, 12));
    let factor = layout.map.0 / 16;
    let at = |x: u32, y: u32| {
        drawing.at(
            layout.map_left + x * factor + factor / 2,
            MARGIN + HEADER + y * factor + factor / 2,
        )
    };
    assert_eq!(at(8, 6), MISSING);
    assert_eq!(at(7, 6), diverging(0.0));
}

#[test]
fn there_are_words_in_it() {
    let image = estimate((64, 48), |_, _| Some(0.5));
    let drawing = drawing(&image, &image);
    let dark = |top: u32, bottom: u32| {
        let rows = (top * drawing.width) as usize..(bottom * drawing.width) as usize;
        drawing.rgb.as_chunks::<3>().0[rows]
            .iter()
            .filter(|pixel| pixel[0] < 100)
            .count()
    };
    assert!(dark(MARGIN, MARGIN + HEADER - 4) > 1000, "the header has no text");
}

#[test]
fn every_shape_can_be_drawn() {
    for size in [(1, 1), (1, 300), (300, 1), (17, 5), (1000, 700)] {
        let image = estimate(size, |x, y| {
            Some(0.5 + f64::from(x % 3) * 0.01 - f64::from(y % 2) * 0.02)
        });
        let reference = estimate(size, |_, _| Some(0.5));
        let drawing = drawing(&image, &reference);
        assert_eq!(drawing.rgb.len() as u32, 3 * drawing.width * drawing.height);
    }
}

#[test]
fn ranges_are_round_and_hold_most_pixels() {
    let of = |values: &[f64]| range(&values.iter().map(|&value| Some(value)).collect::<Vec<_>>());
    assert!((of(&[0.03, -0.011, 0.0]) - 0.05).abs() < 1e-12);
    assert!((of(&[0.07]) - 0.1).abs() < 1e-12);
    assert!((of(&[150.0]) - 200.0).abs() < 1e-9);
    // One firefly in two hundred pixels does not pale the others.
    let mut values = vec![0.015; 200];
    values[7] = 9.0;
    assert!((of(&values) - 0.02).abs() < 1e-12);
    assert!(of(&[]) > 0.0 && of(&[0.0]) > 0.0);
}

#[test]
fn signs_are_written_out() {
    assert_eq!(signed(0.25, 2), "+0.25");
    assert_eq!(signed(-0.25, 2), "−0.25");
    assert_eq!(signed(-0.001, 2), "0.00");
    assert_eq!(signed(f64::INFINITY, 2), "+inf");
}
