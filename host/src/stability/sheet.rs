//! Pictures side by side.

use std::path::Path;

use plotters::style::text_anchor::{HPos, VPos};

use crate::image::drawing::{
    DrawingError, GAP, LARGE, MARGIN, NORMAL, blit, diverging, draw_on, enlarged, text, write_png,
};
use crate::image::picture::Picture;
use crate::image::raster::Raster;
use crate::oracle::difference::differences;
use crate::platform::file::WriteError;

/// Pixels of the title, and of a picture's caption.
const TITLE: u32 = 40;
const CAPTION: u32 = 24;
/// Pixels across that a picture is enlarged to fill, by a whole factor.
const ACROSS: u32 = 256;

/// Rows of pictures of one size.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Its file's name, without extension.
    pub name: &'static str,
    /// What it shows.
    pub title: String,
    /// Row by row.
    pub rows: Vec<Vec<Panel>>,
}

/// A picture with a line above it.
#[derive(Clone, Debug)]
pub struct Panel {
    caption: String,
    size: (u16, u16),
    pixels: Vec<[u8; 3]>,
}

impl Panel {
    /// A picture as a display shows it.
    pub(super) fn picture(caption: impl Into<String>, picture: &Picture) -> Self {
        Self {
            caption: caption.into(),
            size: picture.size(),
            pixels: picture.display().as_chunks::<3>().0.to_vec(),
        }
    }

    /// The line above it.
    pub fn caption(&self) -> &str {
        &self.caption
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u16, u16) {
        self.size
    }

    /// Its pixels as a display shows them, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// How much darker (blue) or brighter (red) `picture` is than `other`, in radiance up to `range`, mean of the channels.
    pub(super) fn difference(
        caption: impl Into<String>,
        picture: &Picture,
        other: &Picture,
        range: f64,
    ) -> Self {
        let differences = differences(picture, other).into_iter();
        Self {
            caption: caption.into(),
            size: picture.size(),
            pixels: differences
                .map(|difference| diverging(difference.unwrap_or(0.0) / range))
                .collect(),
        }
    }
}

impl Sheet {
    /// Writes it as a PNG file.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_png(path, || self.draw())
    }

    fn draw(&self) -> Result<Raster, DrawingError> {
        let (width, height) = self
            .rows
            .iter()
            .flatten()
            .next()
            .ok_or("a sheet without pictures")?
            .size;
        let factor = ACROSS.div_ceil(width.into());
        let panel = (u32::from(width) * factor, u32::from(height) * factor);
        let (across, down) = (panel.0 + GAP, CAPTION + panel.1 + GAP);
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0) as u32;
        let size = (
            2 * MARGIN + columns * across - GAP,
            2 * MARGIN + TITLE + self.rows.len() as u32 * down - GAP,
        );
        draw_on(size.0, size.1, |canvas| {
            text(
                canvas,
                &self.title,
                LARGE,
                (MARGIN, MARGIN),
                HPos::Left,
                VPos::Top,
            )?;
            for (row, top) in self.rows.iter().zip((MARGIN + TITLE..).step_by(down as usize)) {
                for (it, left) in row.iter().zip((MARGIN..).step_by(across as usize)) {
                    text(canvas, &it.caption, NORMAL, (left, top), HPos::Left, VPos::Top)?;
                    let place = (left, top + CAPTION);
                    blit(canvas, place, panel, enlarged(&it.pixels, it.size, panel))?;
                }
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_beside_each_other() {
        let white = Picture::new(8, 6, vec![Some([1.0; 3]); 48]);
        let red = Picture::new(8, 6, vec![Some([1.0, 0.0, 0.0]); 48]);
        let sheet = Sheet {
            name: "sheet",
            title: "Title".to_owned(),
            rows: vec![vec![
                Panel::picture("white", &white),
                Panel::picture("red", &red),
                Panel::difference("difference", &red, &white, 1.0),
            ]],
        };
        let raster = sheet.draw().unwrap();
        let count = |colour: [u8; 3]| {
            raster
                .rgb
                .as_chunks::<3>()
                .0
                .iter()
                .filter(|it| **it == colour)
                .count()
        };
        assert_eq!(count([255, 0, 0]), 256 * 192);
        assert_eq!(count(diverging(-2.0 / 3.0)), 256 * 192);
    }
}
