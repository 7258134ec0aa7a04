//! Pixels as displays take them, and their PNG files.

use std::io::Write;

use png::{
    BitDepth, ColorType, Encoder, EncodingError, ScaledFloat, SourceChromaticities, SrgbRenderingIntent,
};

/// Pixels of 8 bits a channel in sRGB: red, green, blue, row-major from the top row.
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
        encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
        // For readers that do not know sRGB, what the PNG specification has stand beside it (11.3.2.5).
        encoder.set_source_gamma(ScaledFloat::from_scaled(45455));
        encoder.set_source_chromaticities(SourceChromaticities::new(
            (0.3127, 0.3290),
            (0.64, 0.33),
            (0.30, 0.60),
            (0.15, 0.06),
        ));
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()
    }
}
