//! What the drawings of this crate are made of: labels, enlarged pixels and a scale of colours.
//!
//! The labels are set in DejaVu Sans, which comes within the binary: the machines this runs on may have no font at all,
//! and the pictures should look the same everywhere.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::image::raster::Raster;
use crate::platform::file::{WriteError, write_whole};

pub(crate) type Canvas<'a> = DrawingArea<BitMapBackend<'a>, Shift>;
pub(crate) type DrawingError = Box<dyn std::error::Error + Send + Sync>;

pub(crate) const FONT: &str = "DejaVu Sans";
/// Text sizes in pixels; even, because plotters truncates the baseline of odd ones to uneven lines.
pub(crate) const LARGE: u32 = 20;
pub(crate) const NORMAL: u32 = 16;
pub(crate) const SMALL: u32 = 12;
pub(crate) const MARGIN: u32 = 24;
pub(crate) const GAP: u32 = 16;
/// From darker than the reference to brighter; of equal perceived steps, and distinct for the colour-blind.
const DIVERGING: [[f64; 3]; 5] = [
    [5.0, 48.0, 97.0],
    [67.0, 147.0, 195.0],
    [247.0, 247.0, 247.0],
    [214.0, 96.0, 77.0],
    [103.0, 0.0, 31.0],
];

/// Draws on white.
pub(crate) fn draw_on(
    width: u32,
    height: u32,
    draw: impl FnOnce(&Canvas<'_>) -> Result<(), DrawingError>,
) -> Result<Raster, DrawingError> {
    register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
        .map_err(|_| "the built-in font is damaged")?;
    let mut rgb = vec![0; (width * height * 3) as usize];
    {
        let canvas = BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area();
        canvas.fill(&WHITE)?;
        draw(&canvas)?;
        canvas.present()?;
    }
    Ok(Raster { width, height, rgb })
}

/// Writes a drawing as a PNG file.
pub(crate) fn write_png(
    path: &Path,
    draw: impl FnOnce() -> Result<Raster, DrawingError>,
) -> Result<(), WriteError> {
    write_whole(path, |writer| {
        draw()?.write_png(writer).map_err(DrawingError::from)
    })
}

/// The colour of `share`, from -1 (darker) to 1 (brighter); beyond, the ends.
pub(crate) fn diverging(share: f64) -> [u8; 3] {
    let last = DIVERGING.len() - 1;
    let position = (share.clamp(-1.0, 1.0) + 1.0) / 2.0 * last as f64;
    let below = (position as usize).min(last - 1);
    let part = position - below as f64;
    [0, 1, 2].map(|c| ((1.0 - part) * DIVERGING[below][c] + part * DIVERGING[below + 1][c]).round() as u8)
}

/// Nearest-neighbour scaling: a pixel stays a square.
pub(crate) fn enlarged(pixels: &[[u8; 3]], (width, height): (u16, u16), to: (u32, u32)) -> Vec<u8> {
    let (width, height) = (usize::from(width), usize::from(height));
    let (columns, rows) = (to.0 as usize, to.1 as usize);
    let mut out = Vec::with_capacity(3 * columns * rows);
    for y in 0..rows {
        for x in 0..columns {
            out.extend(pixels[y * height / rows * width + x * width / columns]);
        }
    }
    out
}

pub(crate) fn blit(
    canvas: &Canvas<'_>,
    place: (u32, u32),
    size: (u32, u32),
    rgb: Vec<u8>,
) -> Result<(), DrawingError> {
    let bitmap = BitMapElement::with_owned_buffer(signed_place(place), size, rgb)
        .ok_or("a panel has the wrong size")?;
    Ok(canvas.draw(&bitmap)?)
}

pub(crate) fn outline(
    canvas: &Canvas<'_>,
    place: (u32, u32),
    size: (u32, u32),
    colour: &RGBColor,
) -> Result<(), DrawingError> {
    let (left, top) = signed_place(place);
    let (width, height) = signed_place(size);
    let corners = [(left, top), (left + width - 1, top + height - 1)];
    Ok(canvas.draw(&Rectangle::new(corners, colour.stroke_width(1)))?)
}

pub(crate) fn text(
    canvas: &Canvas<'_>,
    line: &str,
    size: u32,
    place: (u32, u32),
    horizontal: HPos,
    vertical: VPos,
) -> Result<(), DrawingError> {
    let style = TextStyle::from((FONT, size).into_font()).pos(Pos::new(horizontal, vertical));
    Ok(canvas.draw(&Text::new(line.to_owned(), signed_place(place), style))?)
}

/// A place in the drawing as plotters wants it; drawings have less than 2^31 pixels a side.
fn signed_place((x, y): (u32, u32)) -> (i32, i32) {
    (x as i32, y as i32)
}

/// A number with its sign, also a plus, and a true minus.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let is_zero = digits.bytes().all(|digit| matches!(digit, b'0' | b'.'));
    let sign = match value {
        _ if is_zero => "",
        value if value < 0.0 => "−",
        _ => "+",
    };
    format!("{sign}{digits}")
}
