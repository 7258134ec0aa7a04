//! Linear pictures in OpenEXR: 32-bit floats R, G, B.
//!
//! A pixel without samples is NaN. An [`Estimate`] that knows its noise carries it along as three more channels
//! (`variance.R` and so on: variance of the pixel's mean) and the attribute `samplesPerPixel`, so that a reference
//! written by one run serves the next with everything a comparison needs. Other programs show R, G, B and ignore the
//! rest.

use std::io::{BufReader, Seek};
use std::path::{Path, PathBuf};

use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    ReadChannels, ReadLayers, Text, WritableImage,
};

use crate::image::picture::{Estimate, Picture};
use crate::platform::file::{WriteError, write_whole};

const COLOURS: [&str; 3] = ["R", "G", "B"];
const VARIANCES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];
const SPP: &str = "samplesPerPixel";

/// Bytes of samples that a file may announce: a GiB. As many are asked for before the first is read, so a few wrong bytes in a header
/// could ask for more than there is.
const MAX_SAMPLES: usize = 1 << 30;

/// A picture that could not be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read the picture {}: {cause}; give an OpenEXR file with channels R, G and B", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub cause: String,
}

/// Writes `estimate` to `path`, its variance too if it has one.
pub fn write(path: &Path, estimate: &Estimate) -> Result<(), WriteError> {
    let picture = &estimate.picture;
    let colour = |channel: usize| -> Vec<f32> {
        picture
            .pixels()
            .iter()
            .map(|pixel| pixel.map_or(f32::NAN, |radiance| radiance[channel] as f32))
            .collect()
    };
    let channel = |name: &str, values| AnyChannel::new(name, FlatSamples::F32(values));
    let mut channels: Vec<_> = (0..3).map(|i| channel(COLOURS[i], colour(i))).collect();
    if let Some(variance) = &estimate.variance {
        let variance = |i: usize| variance.iter().map(|pixel| pixel[i] as f32).collect();
        channels.extend((0..3).map(|i| channel(VARIANCES[i], variance(i))));
    }
    let mut attributes = LayerAttributes::default();
    if let Some(spp) = estimate.spp.and_then(|spp| i32::try_from(spp).ok()) {
        attributes.other.insert(Text::from(SPP), AttributeValue::I32(spp));
    }
    let (width, height) = picture.size();
    let layer = Layer::new(
        (usize::from(width), usize::from(height)),
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into_iter().collect()),
    );
    write_whole(path, |writer| {
        // The encoder seeks, so it works in memory.
        let mut bytes = std::io::Cursor::new(Vec::new());
        Image::from_layer(layer)
            .write()
            .to_buffered(&mut bytes)
            .map_err(|error| error.to_string())?;
        std::io::Write::write_all(writer, bytes.get_ref()).map_err(|error| error.to_string())
    })
}

/// Reads the first layer that has R, G and B.
pub fn read(path: &Path) -> Result<Estimate, ReadError> {
    let error = |cause: String| ReadError {
        path: path.to_owned(),
        cause,
    };
    let mut file = std::fs::File::open(path).map_err(|source| error(source.to_string()))?;
    if announced(&file).map_err(|source| error(source.to_string()))? > MAX_SAMPLES {
        return Err(error("it says that it has more than a GiB of samples".to_owned()));
    }
    file.rewind().map_err(|source| error(source.to_string()))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(BufReader::new(file))
        .map_err(|source| error(source.to_string()))?;
    let (layer, colours) = image
        .layer_data
        .iter()
        .find_map(|layer| channels(layer, COLOURS).map(|colours| (layer, colours)))
        .ok_or_else(|| error("no layer has the channels R, G and B".to_owned()))?;
    let side = |pixels: usize| u16::try_from(pixels).ok();
    let (Some(width), Some(height)) = (side(layer.size.x()), side(layer.size.y())) else {
        return Err(error(format!(
            "{}x{} is larger than 65535x65535",
            layer.size.x(),
            layer.size.y()
        )));
    };
    let pixels = colours
        .into_iter()
        .map(|pixel| pixel.iter().all(|c| c.is_finite()).then_some(pixel))
        .collect();
    let spp = match layer.attributes.other.get(&Text::from(SPP)) {
        Some(AttributeValue::I32(spp)) => u32::try_from(*spp).ok(),
        _ => None,
    };
    let variance = channels(layer, VARIANCES);
    Ok(Estimate {
        picture: Picture::new(width, height, pixels),
        variance,
        spp,
    })
}

/// Bytes of all samples, by the headers of the file's layers.
fn announced(file: &std::fs::File) -> Result<usize, exr::error::Error> {
    let layers = MetaData::read_from_buffered(BufReader::new(file), false)?.headers;
    let bytes = layers.iter().map(|layer| {
        let pixels = layer.layer_size.x().saturating_mul(layer.layer_size.y());
        pixels.saturating_mul(layer.channels.bytes_per_pixel)
    });
    Ok(bytes.fold(0, usize::saturating_add))
}

/// Three channels of a layer as one list of triples; `None` when one of them is missing.
fn channels(layer: &Layer<AnyChannels<FlatSamples>>, names: [&str; 3]) -> Option<Vec<[f64; 3]>> {
    let mut triples = vec![[0.0; 3]; layer.size.area()];
    for (index, name) in names.into_iter().enumerate() {
        let channel = layer
            .channel_data
            .list
            .iter()
            .find(|channel| channel.name == *name)?;
        if channel.sample_data.len() != triples.len() {
            return None; // A subsampled channel.
        }
        for (triple, value) in triples.iter_mut().zip(channel.sample_data.values_as_f32()) {
            triple[index] = f64::from(value);
        }
    }
    Some(triples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate() -> Estimate {
        let pixels = vec![Some([0.25, 12.5, 0.0]), None, Some([3.0, 2.0, 1.0])];
        let variance = vec![[0.5, 0.25, 0.125], [0.0; 3], [1.0, 2.0, 4.0]];
        Estimate {
            picture: Picture::new(3, 1, pixels),
            variance: Some(variance),
            spp: Some(64),
        }
    }

    #[test]
    fn everything_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reference.exr");
        write(&path, &estimate()).unwrap();
        assert_eq!(read(&path).unwrap(), estimate());

        let plain = Estimate {
            variance: None,
            spp: None,
            ..estimate()
        };
        write(&path, &plain).unwrap();
        assert_eq!(read(&path).unwrap(), plain);
    }

    #[test]
    fn what_is_no_picture_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.exr");
        for bytes in [
            &b""[..],
            b"not a picture",
            &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0, 0xff],
        ] {
            std::fs::write(&path, bytes).unwrap();
            let message = read(&path).unwrap_err().to_string();
            assert!(
                message.contains("broken.exr") && message.contains("OpenEXR"),
                "{message}"
            );
        }
        assert!(
            read(&folder.path().join("missing.exr"))
                .unwrap_err()
                .to_string()
                .contains("missing.exr")
        );
    }

    #[test]
    fn a_header_that_announces_more_than_memory_holds_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("huge.exr");
        write(&path, &estimate()).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let window = b"dataWindow\0box2i\0\x10\0\0\0";
        let at = bytes
            .windows(window.len())
            .position(|place| place == window)
            .unwrap()
            + window.len();
        for corner in [at + 8, at + 12] {
            bytes[corner..corner + 4].copy_from_slice(&0x3000_0000_i32.to_le_bytes());
        }
        std::fs::write(&path, bytes).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains("more than a GiB"), "{message}");
    }

    #[test]
    fn a_picture_without_colours_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let channel = AnyChannel::new("Z", FlatSamples::F32(vec![1.0; 4]));
        let channels = AnyChannels::sort(std::iter::once(channel).collect());
        let layer = Layer::new(
            (2, 2),
            LayerAttributes::default(),
            Encoding::UNCOMPRESSED,
            channels,
        );
        Image::from_layer(layer).write().to_file(&path).unwrap();
        assert!(
            read(&path)
                .unwrap_err()
                .to_string()
                .contains("no layer has the channels")
        );
    }
}
