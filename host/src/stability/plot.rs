//! Curves on logarithmic axes.

use std::ops::Range;
use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::image::drawing::{self, Canvas, DrawingError};
use crate::platform::file::WriteError;

/// Curves of one quantity over another, both on logarithmic axes.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Its file's name, without extension.
    pub name: &'static str,
    /// What it shows.
    pub title: String,
    /// The quantity across, with its unit.
    pub across: &'static str,
    /// The quantity upwards, with its unit.
    pub upwards: &'static str,
    /// Curves by name; points that are not above 0 have no place on the axes, and are left out.
    pub curves: Vec<(String, Vec<(f64, f64)>)>,
}

const SIZE: (u32, u32) = (960, 600);
/// Pixels a line of the legend.
const LINE: u32 = 20;
/// Distinct for the colour-blind (P. Tol's bright scheme), and black.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x44, 0x77, 0xaa),
    RGBColor(0xee, 0x66, 0x77),
    RGBColor(0x22, 0x88, 0x33),
    RGBColor(0xcc, 0xbb, 0x44),
    RGBColor(0x66, 0xcc, 0xee),
    RGBColor(0xaa, 0x33, 0x77),
    RGBColor(0xbb, 0xbb, 0xbb),
    RGBColor(0, 0, 0),
];

impl Plot {
    /// Writes it as a PNG file.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        drawing::write_png(path, || {
            drawing::draw_on(SIZE.0, SIZE.1, |canvas| self.draw(canvas))
        })
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Result<(), DrawingError> {
        let curves: Vec<Vec<(f64, f64)>> = self
            .curves
            .iter()
            .map(|(_, curve)| {
                curve
                    .iter()
                    .copied()
                    .filter(|&(x, y)| x > 0.0 && y > 0.0)
                    .collect()
            })
            .collect();
        let points = || curves.iter().flatten();
        let (across, upwards) = (range(points().map(|p| p.0)), range(points().map(|p| p.1)));
        let legend = LINE * self.curves.len() as u32 + drawing::MARGIN;
        let (chart, _) = canvas.split_vertically(SIZE.1 - legend);
        let font = |size: u32| (drawing::FONT, size).into_font();
        let mut chart = ChartBuilder::on(&chart)
            .margin(drawing::MARGIN)
            .caption(&self.title, font(drawing::LARGE))
            .x_label_area_size(44)
            .y_label_area_size(84)
            .build_cartesian_2d(across.log_scale(), upwards.log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.across)
            .y_desc(self.upwards)
            .label_style(font(drawing::SMALL))
            .axis_desc_style(font(drawing::NORMAL))
            .x_label_formatter(&|x| format!("{x:.0e}"))
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .light_line_style(WHITE)
            .draw()?;
        for ((curve, (name, _)), index) in curves.iter().zip(&self.curves).zip(0u32..) {
            let colour = COLOURS[index as usize % COLOURS.len()];
            chart.draw_series([PathElement::new(curve.clone(), colour.stroke_width(2))])?;
            chart.draw_series(curve.iter().map(|&point| Circle::new(point, 3, colour.filled())))?;
            let (left, top) = (108, SIZE.1 - legend + LINE * index);
            let (x, y) = (left as i32, (top + LINE / 3) as i32);
            canvas.draw(&PathElement::new(
                [(x - 40, y), (x - 10, y)],
                colour.stroke_width(3),
            ))?;
            drawing::text(canvas, name, drawing::NORMAL, (left, top), HPos::Left, VPos::Top)?;
        }
        Ok(())
    }
}

/// From the power of ten below the least value to the one above the greatest.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.1..1.0;
    }
    let (low, high) = (low.log10().floor(), high.log10().ceil());
    10f64.powf(low)..10f64.powf(high.max(low + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_drawn_in_their_colours() {
        let plot = Plot {
            name: "plot",
            title: "Title".to_owned(),
            across: "x",
            upwards: "y",
            curves: vec![("a".to_owned(), vec![(1.0, 0.0), (2.0, 3.0), (40.0, 500.0)])],
        };
        let folder = tempfile::tempdir().unwrap();
        plot.write(&folder.path().join("plot.png")).unwrap();
        let raster = drawing::draw_on(SIZE.0, SIZE.1, |canvas| plot.draw(canvas)).unwrap();
        let blue = raster.rgb.chunks(3).filter(|pixel| *pixel == [0x44, 0x77, 0xaa]);
        assert!(blue.count() > 100, "a curve and its line in the legend");
    }
}
