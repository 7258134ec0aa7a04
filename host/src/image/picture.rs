//! Pictures of linear radiance, with the holes and the noise they have, and their display as PNG.

use std::path::Path;

use crate::image::raster::Raster;
use crate::platform::file::{WriteError, write_whole};

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

    /// The same by an exposure that is so many stops longer, each of which is twice the radiance.
    #[must_use]
    pub fn exposed(&self, stops: i32) -> Self {
        let factor = 2f64.powi(stops);
        let pixels = self.pixels.iter();
        let pixels = pixels.map(|pixel| pixel.map(|radiance| radiance.map(|c| c * factor)));
        Self::new(self.width, self.height, pixels.collect())
    }

    /// How the picture looks on a display: 8 bits a channel in sRGB, clamped; a missing pixel is magenta.
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

/// Radiance on a display, 1 being white: the transfer function of sRGB (IEC 61966-2-1).
pub fn displayed(radiance: f64) -> f64 {
    match radiance.clamp(0.0, 1.0) {
        dark if dark <= 0.0031308 => 12.92 * dark,
        bright => 1.055 * bright.powf(1.0 / 2.4) - 0.055,
    }
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
        // 1.055 * 0.5 ^ (1 / 2.4) - 0.055 = 0.7354, 1.055 * 0.1 ^ (1 / 2.4) - 0.055 = 0.3492
        assert_eq!(picture.display(), [0, 255, 255, 255, 0, 255, 0, 188, 89, 0, 0, 0]);
    }

    #[test]
    fn the_mean_leaves_missing_pixels_out() {
        let picture = Picture::new(3, 1, vec![Some([1.0, 2.0, 3.0]), None, Some([3.0, 2.0, 1.0])]);
        assert_eq!(picture.mean(), Some([2.0, 2.0, 2.0]));
        assert_eq!(Picture::new(1, 1, vec![None]).mean(), None);
    }

    /// Radiance of what a PNG file of sRGB shows as `level`, by the standard's own formula in this direction.
    fn radiance_of(level: f64) -> f64 {
        match level / 255.0 {
            dark if dark <= 0.04045 => dark / 12.92,
            bright => ((bright + 0.055) / 1.055).powf(2.4),
        }
    }

    /// The file's chunks before its pixels, by name.
    fn chunks(mut bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
        bytes = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n").expect("a PNG file");
        let mut chunks = Vec::new();
        loop {
            let (length, rest) = bytes.split_first_chunk().expect("a length");
            let (name, rest) = rest.split_at(4);
            if name == b"IDAT" {
                return chunks;
            }
            let (data, rest) = rest.split_at(u32::from_be_bytes(*length) as usize);
            chunks.push((String::from_utf8(name.to_vec()).expect("a name"), data.to_vec()));
            bytes = &rest[4..]; // The checksum is the decoder's business.
        }
    }

    #[test]
    fn every_level_of_the_file_is_the_radiance_by_srgb_as_the_file_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        // The level itself, and how far from it a radiance still has it: as near to half a level as 1e-4 of one.
        let row = |level: f64| [level, level - 0.4999, level + 0.4999].map(radiance_of);
        let pixels: Vec<_> = (0..=255).map(|level| Some(row(level.into()))).collect();
        Picture::new(256, 1, pixels).write_png(&path).unwrap();

        let found = chunks(&std::fs::read(&path).unwrap());
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["IHDR", "sRGB", "gAMA", "cHRM"]);
        assert_eq!(found[1].1, [1], "relative colorimetric");
        assert_eq!(found[2].1, 45455u32.to_be_bytes());
        let chromaticities = [31270u32, 32900, 64000, 33000, 30000, 60000, 15000, 6000];
        assert_eq!(found[3].1, chromaticities.map(u32::to_be_bytes).concat());

        let (_, decoded) = decode(&path);
        for (level, shown) in (0..=255).zip(decoded.chunks_exact(3)) {
            assert_eq!(shown, [level; 3]);
        }
    }

    fn decode(path: &Path) -> (png::OutputInfo, Vec<u8>) {
        let file = BufReader::new(File::open(path).unwrap());
        let mut decoder = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        let frame = decoder.next_frame(&mut pixels).unwrap();
        (frame, pixels)
    }

    #[test]
    fn png_round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let picture = Picture::new(2, 1, vec![Some([0.25, 0.5, 0.75]), None]);
        picture.write_png(&path).unwrap();
        let (frame, pixels) = decode(&path);
        assert_eq!(
            (frame.width, frame.height, frame.color_type, frame.bit_depth),
            (2, 1, png::ColorType::Rgb, png::BitDepth::Eight)
        );
        assert_eq!(pixels, picture.display());
    }
}
