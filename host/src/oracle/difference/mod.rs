//! The difference between a picture and its reference as a labelled false-colour picture.
//!
//! The large map shows every pixel's difference, blue where the picture is darker than the reference and red where it
//! is brighter. Below it stand both pictures as a display shows them and a map of the tile test, in which an error shows
//! long before the eye finds it in the pixels' noise.

use std::path::Path;

use plotters::prelude::BLACK;
use plotters::style::text_anchor::{HPos, VPos};

use crate::image::drawing::{
    Canvas, DrawingError, GAP, LARGE, MARGIN, NORMAL, SMALL, blit, diverging, draw_on, enlarged, outline,
    signed, text, write_png,
};
use crate::image::picture::Picture;
use crate::image::raster::Raster;
use crate::oracle::compare::{Comparison, SIDE};
use crate::platform::file::WriteError;

/// What the map is enlarged to fill, by a whole factor.
const MAP: (u32, u32) = (768, 576);
/// Room for the title lines at the shortest; a narrow map stands in the middle.
const NARROWEST: u32 = 800;
const HEADER: u32 = 92;
const CAPTION: u32 = 24;
const BAR: u32 = 20;
const BAR_LABELS: u32 = 88;
/// A pixel that one of the pictures lacks.
const MISSING: [u8; 3] = [0, 0, 0];
/// Draws the difference of `image` from `reference` into a PNG file. `comparison` must be of these two.
pub fn write(
    path: &Path,
    title: &str,
    image: &Picture,
    reference: &Picture,
    comparison: &Comparison,
) -> Result<(), WriteError> {
    write_png(path, || draw(title, image, reference, comparison))
}

/// Where everything goes.
struct Layout {
    width: u32,
    height: u32,
    map: (u32, u32),
    map_left: u32,
    panel: (u32, u32),
}

impl Layout {
    fn new(size: (u16, u16)) -> Self {
        let (columns, rows) = (u32::from(size.0).max(1), u32::from(size.1).max(1));
        let factor = (MAP.0 / columns).min(MAP.1 / rows).max(1);
        let map = (columns * factor, rows * factor);
        let inner = (map.0 + GAP + BAR + BAR_LABELS).max(NARROWEST);
        let panel_width = ((inner - 2 * GAP) / 3).min(map.0);
        let panel = (panel_width, (panel_width * rows / columns).max(1));
        Self {
            width: inner + 2 * MARGIN,
            height: MARGIN + HEADER + map.1 + GAP + CAPTION + panel.1 + MARGIN,
            map,
            map_left: MARGIN + (inner - map.0 - GAP - BAR - BAR_LABELS) / 2,
            panel,
        }
    }
}

fn draw(
    title: &str,
    image: &Picture,
    reference: &Picture,
    comparison: &Comparison,
) -> Result<Raster, DrawingError> {
    let layout = Layout::new(image.size());
    draw_on(layout.width, layout.height, |canvas| {
        header(canvas, title, comparison)?;
        let differences = differences(image, reference);
        let range = range(&differences);
        let top = MARGIN + HEADER;
        let colours = differences
            .iter()
            .map(|d| d.map_or(MISSING, |d| diverging(d / range)));
        let map = enlarged(&colours.collect::<Vec<_>>(), image.size(), layout.map);
        blit(canvas, (layout.map_left, top), layout.map, map)?;
        colour_bar(
            canvas,
            (layout.map_left + layout.map.0 + GAP, top),
            layout.map.1,
            range,
        )?;
        panels(canvas, &layout, image, reference, comparison)
    })
}

fn header(canvas: &Canvas<'_>, title: &str, comparison: &Comparison) -> Result<(), DrawingError> {
    let plus_minus = |error: Option<f64>| error.map_or(String::new(), |e| format!(" ± {:.3} %", 100.0 * e));
    let bias = comparison
        .bias
        .map_or("undefined, the reference is black".to_owned(), |bias| {
            format!(
                "{}{}",
                signed(100.0 * bias, 3) + " %",
                plus_minus(comparison.bias_standard_error)
            )
        });
    let psnr = comparison
        .psnr_db
        .map_or("none, no difference".to_owned(), |db| format!("{db:.2} dB"));
    let tiles = &comparison.tiles;
    let worst = tiles.most_biased().map_or(String::new(), |tile| {
        let (bias, noise) = (signed(100.0 * tile.bias, 2), 100.0 * tile.bias_noise);
        format!("largest bias of an {SIDE}x{SIDE} tile {bias} % ± {noise:.2} %")
    });
    let lines = [
        (LARGE, format!("{title}: picture − reference")),
        (
            NORMAL,
            format!(
                "bias {bias}     noise-corrected rmse {:.4} (at most {:.4})     display PSNR {psnr}",
                comparison.rmse,
                comparison.squared_error.rmse_at_most()
            ),
        ),
        (
            NORMAL,
            format!(
                "{worst}     largest z {}, {} of {} tests beyond ±{:.2}",
                signed(tiles.max_z(), 2),
                tiles.failed().count(),
                tiles.tested(),
                tiles.threshold_z
            ),
        ),
    ];
    let mut y = MARGIN;
    for (size, line) in lines {
        text(canvas, &line, size, (MARGIN, y), HPos::Left, VPos::Top)?;
        y += size + 10;
    }
    Ok(())
}

/// The picture, the reference and the map of the tile test.
fn panels(
    canvas: &Canvas<'_>,
    layout: &Layout,
    image: &Picture,
    reference: &Picture,
    comparison: &Comparison,
) -> Result<(), DrawingError> {
    let size = image.size();
    let top = MARGIN + HEADER + layout.map.1 + GAP;
    let missing = match comparison.missing {
        0 => String::new(),
        missing => format!(" (missing pixels: {missing})"),
    };
    let threshold = comparison.tiles.threshold_z;
    let rendered = |picture: &Picture| picture.display().as_chunks::<3>().0.to_vec();
    let contents = [
        (format!("picture{missing}"), rendered(image)),
        ("reference".to_owned(), rendered(reference)),
        (
            format!("z by tile, −{threshold:.2} to +{threshold:.2}"),
            z_map(size, comparison),
        ),
    ];
    let step = (layout.width - 2 * MARGIN - layout.panel.0) / 2;
    for (index, (caption, pixels)) in (0..).zip(contents) {
        let left = MARGIN + index * step;
        text(canvas, &caption, NORMAL, (left, top), HPos::Left, VPos::Top)?;
        let place = (left, top + CAPTION);
        blit(canvas, place, layout.panel, enlarged(&pixels, size, layout.panel))?;
        outline(canvas, place, layout.panel, &BLACK)?;
        if index == 2 {
            outline_failures(canvas, place, layout.panel, size, comparison)?;
        }
    }
    Ok(())
}

/// Every tile in the colour of its largest z-score; the threshold has full colour.
fn z_map((width, height): (u16, u16), comparison: &Comparison) -> Vec<[u8; 3]> {
    let mut pixels = vec![MISSING; usize::from(width) * usize::from(height)];
    for tile in &comparison.tiles.tiles {
        let colour = diverging(tile.max_z() / comparison.tiles.threshold_z);
        for y in tile.y..tile.y.saturating_add(SIDE).min(height) {
            let row = usize::from(y) * usize::from(width);
            let end = tile.x.saturating_add(SIDE).min(width);
            pixels[row + usize::from(tile.x)..row + usize::from(end)].fill(colour);
        }
    }
    pixels
}

/// Puts a frame around every tile that failed, for those who cannot tell full colour from nearly full.
fn outline_failures(
    canvas: &Canvas<'_>,
    place: (u32, u32),
    panel: (u32, u32),
    (width, height): (u16, u16),
    comparison: &Comparison,
) -> Result<(), DrawingError> {
    for (tile, _) in comparison.tiles.failed() {
        let scale = |value: u16, from: u16, to: u32| u32::from(value) * to / u32::from(from);
        let (left, top) = (scale(tile.x, width, panel.0), scale(tile.y, height, panel.1));
        let right = scale(tile.x.saturating_add(SIDE).min(width), width, panel.0);
        let bottom = scale(tile.y.saturating_add(SIDE).min(height), height, panel.1);
        outline(
            canvas,
            (place.0 + left, place.1 + top),
            (right - left, bottom - top),
            &BLACK,
        )?;
    }
    Ok(())
}

/// The scale of the map, with five labels.
fn colour_bar(canvas: &Canvas<'_>, place: (u32, u32), height: u32, range: f64) -> Result<(), DrawingError> {
    let (left, top) = place;
    let share = |row: u32| 1.0 - 2.0 * f64::from(row) / f64::from(height.max(2) - 1);
    let rows: Vec<u8> = (0..height)
        .flat_map(|row| diverging(share(row)).repeat(BAR as usize))
        .collect();
    blit(canvas, place, (BAR, height), rows)?;
    outline(canvas, place, (BAR, height), &BLACK)?;
    let decimals = (1.0 - range.log10().floor()).max(0.0) as usize;
    for quarter in 0..5u32 {
        let value = range * (1.0 - f64::from(quarter) / 2.0);
        let y = top + (height - 1) * quarter / 4;
        let anchor = match quarter {
            0 => VPos::Top,
            4 => VPos::Bottom,
            _ => VPos::Center,
        };
        text(
            canvas,
            &signed(value, decimals),
            NORMAL,
            (left + BAR + 6, y),
            HPos::Left,
            anchor,
        )?;
    }
    let notes = [(1, "brighter"), (3, "darker")];
    for (quarter, note) in notes {
        let y = top + height * quarter / 4 + 16;
        text(canvas, note, SMALL, (left + BAR + 6, y), HPos::Left, VPos::Center)?;
    }
    text(
        canvas,
        "linear radiance,",
        12,
        (left, top - 24),
        HPos::Left,
        VPos::Bottom,
    )?;
    text(
        canvas,
        "mean of r, g, b",
        12,
        (left, top - 8),
        HPos::Left,
        VPos::Bottom,
    )
}

/// Mean difference over the channels of every pixel that both pictures have.
pub(crate) fn differences(image: &Picture, reference: &Picture) -> Vec<Option<f64>> {
    let both = image.pixels().iter().zip(reference.pixels());
    both.map(|(one, other)| {
        let (one, other) = ((*one)?, (*other)?);
        Some((0..3).map(|c| one[c] - other[c]).sum::<f64>() / 3.0)
    })
    .collect()
}

/// What has full colour: 1, 2 or 5 times a power of ten, within which 99 % of the pixels lie.
fn range(differences: &[Option<f64>]) -> f64 {
    let mut sizes: Vec<f64> = differences.iter().flatten().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let most = sizes
        .get(sizes.len() * 99 / 100)
        .copied()
        .unwrap_or(0.0)
        .clamp(1e-9, 1e9);
    let decade = 10f64.powf(most.log10().floor());
    let step = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|step| step * decade >= most)
        .unwrap_or(10.0);
    step * decade
}

#[cfg(test)]
mod tests;
