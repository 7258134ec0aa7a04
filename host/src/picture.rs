//! Pictures of linear radiance, with the holes and the noise they have, and their display as PNG.

use std::path::Path;

use crate::file::{WriteError, write_whole};
use crate::raster::Raster;

/// Radiance of every pixel, row-major from the top row.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u16,
    height: u16,
    pixels: Vec<Option<[f64; 3]>>,
}

/// A picture that knows how uncertain it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The pixels' means.
    pub picture: Picture,
    /// Variance of each pixel's mean (not of one sample), by channel; `None` when nobody measured it.
    pub variance: Option<Vec<[f64; 3]>>,
    /// Samples per pixel, where known.
    pub spp: Option<u32>,
}

/// Display gamma.
const GAMMA: f64 = 2.2;

/// The colour of a pixel without samples in a PNG: a magenta that no lit surface has.
const MISSING: [u8; 3] = [255, 0, 255];

impl Picture {
    /// A picture of `width` by `height` pixels; a pixel that was never sampled is `None`.
    ///
    /// # Panics
    /// If there are not `width * height` pixels.
    pub fn new(width: u16, height: u16, pixels: Vec<Option<[f64; 3]>>) -> Self {
        assert_eq!(
            pixels.len(),
            usize::from(width) * usize::from(height),
            "a picture of {width}x{height}"
        );
        Self {
            width,
            height,
            pixels,
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u16, u16) {
        (self.width, self.height)
    }

    /// All pixels.
    pub fn pixels(&self) -> &[Option<[f64; 3]>] {
        &self.pixels
    }

    /// Mean radiance of the pixels there are; `None` when there is none.
    pub fn mean(&self) -> Option<[f64; 3]> {
        let mut sum = [0.0; 3];
        let mut count = 0usize;
        for pixel in self.pixels.iter().flatten() {
            for (sum, component) in sum.iter_mut().zip(pixel) {
                *sum += component;
            }
            count += 1;
        }
        (count > 0).then(|| sum.map(|component| component / count as f64))
    }

    /// How the picture looks on a display: 8 bits a channel, gamma 2.2, clamped; a missing pixel is magenta.
    pub fn display(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|pixel| pixel.map_or(MISSING, |radiance| radiance.map(to_8_bits)))
            .collect()
    }

    /// Writes what [`Picture::display`] says as a PNG file.
    pub fn write_png(&self, path: &Path) -> Result<(), WriteError> {
        let raster = Raster {
            width: self.width.into(),
            height: self.height.into(),
            rgb: self.display(),
        };
        write_whole(path, |writer| raster.write_png(writer))
    }
}

/// Radiance on a display of gamma 2.2, 1 being white.
pub fn displayed(radiance: f64) -> f64 {
    radiance.clamp(0.0, 1.0).powf(1.0 / GAMMA)
}

fn to_8_bits(radiance: f64) -> u8 {
    (displayed(radiance) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::BufReader;

    use super::*;

    #[test]
    fn display_clamps_and_marks_what_is_missing() {
        let pixels = vec![
            Some([0.0, 1.0, 12.0]),
            None,
            Some([-0.5, 0.5, 0.1]),
            Some([f64::NAN; 3]),
        ];
        let picture = Picture::new(2, 2, pixels);
        // 0.5 ^ (1 / 2.2) = 0.7297, 0.1 ^ (1 / 2.2) = 0.3511
        assert_eq!(picture.display(), [0, 255, 255, 255, 0, 255, 0, 186, 90, 0, 0, 0]);
    }

    #[test]
    fn the_mean_leaves_missing_pixels_out() {
        let picture = Picture::new(3, 1, vec![Some([1.0, 2.0, 3.0]), None, Some([3.0, 2.0, 1.0])]);
        assert_eq!(picture.mean(), Some([2.0, 2.0, 2.0]));
        assert_eq!(Picture::new(1, 1, vec![None]).mean(), None);
    }

    #[test]
    fn png_round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let picture = Picture::new(2, 1, vec![Some([0.25, 0.5, 0.75]), None]);
        picture.write_png(&path).unwrap();
        let file = BufReader::new(File::open(path).unwrap());
        let mut decoder = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        let frame = decoder.next_frame(&mut pixels).unwrap();
        assert_eq!(
            (frame.width, frame.height, frame.color_type, frame.bit_depth),
            (2, 1, png::ColorType::Rgb, png::BitDepth::Eight)
        );
        assert_eq!(pixels, picture.display());
    }
}
