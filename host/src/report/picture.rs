//! Pictures within the page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, PreEscaped, html};

use super::prose::prose;
use crate::image::picture::Picture;
use crate::image::raster::Raster;
use crate::stability;

/// A picture and what stands below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    caption: String,
    raster: Raster,
}

/// A picture that cannot be put into the page.
#[derive(Debug, thiserror::Error)]
#[error("the picture `{caption}` cannot be encoded as PNG")]
pub struct ImageError {
    caption: String,
    #[source]
    cause: png::EncodingError,
}

impl Image {
    /// A picture as a display shows it.
    pub fn of(caption: impl Into<String>, picture: &Picture) -> Self {
        let (width, height) = picture.size();
        Self {
            caption: caption.into(),
            raster: Raster {
                width: width.into(),
                height: height.into(),
                rgb: picture.display(),
            },
        }
    }

    /// As an element of a page, which shows every pixel as a square.
    pub fn markup(&self) -> Result<Markup, ImageError> {
        let mut png = Vec::new();
        self.raster.write_png(&mut png).map_err(|cause| ImageError {
            caption: self.caption.clone(),
            cause,
        })?;
        let data = STANDARD.encode(png);
        let (width, height) = (self.raster.width, self.raster.height);
        let text = html! { (self.caption.replace('`', "")) }.into_string();
        // Closed like an element of XML, which HTML allows: so a test can read the page back.
        let image = format!(
            r#"<img src="data:image/png;base64,{data}" width="{width}" height="{height}" alt="{text}"/>"#
        );
        Ok(html! {
            figure class="picture" { (PreEscaped(image)) figcaption { (prose(&self.caption)) } }
        })
    }
}

impl From<&stability::Panel> for Image {
    fn from(panel: &stability::Panel) -> Self {
        let (width, height) = panel.size();
        Self {
            caption: panel.caption().to_owned(),
            raster: Raster {
                width: width.into(),
                height: height.into(),
                rgb: panel.pixels().as_flattened().to_vec(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_within_the_page_to_the_bit() {
        let picture = Picture::new(2, 1, vec![Some([1.0, 0.0, 0.0]), Some([0.0; 3])]);
        let markup = Image::of("red \" & black", &picture)
            .markup()
            .unwrap()
            .into_string();
        let parsed = roxmltree::Document::parse(&markup).expect("it is well formed");
        let image = parsed
            .descendants()
            .find(|node| node.has_tag_name("img"))
            .expect("a picture");
        assert_eq!(image.attribute("alt"), Some("red \" & black"));
        let source = image.attribute("src").expect("its bytes");
        let bytes = STANDARD
            .decode(source.strip_prefix("data:image/png;base64,").expect("a PNG"))
            .unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, [255, 0, 0, 0, 0, 0]);
    }
}
