//! Pixels as displays take them, and their PNG files.

use std::io::Write;

use png::{BitDepth, ColorType, Encoder, EncodingError};

/// Pixels of 8 bits a channel: red, green, blue, row-major from the top row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Raster {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<u8>,
}

impl Raster {
    /// Writes them as a PNG file, losing nothing.
    pub(crate) fn write_png(&self, file: impl Write) -> Result<(), EncodingError> {
        let mut encoder = Encoder::new(file, self.width, self.height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()
    }
}
