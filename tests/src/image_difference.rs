//! Verdicts on pictures that leave evidence: picture, reference, difference and p-values, in `target/image-diff/`.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use host::firmware;
use host::image::openexr;
use host::image::picture::{Estimate, Picture};
use host::oracle::compare::{Comparison, FALSE_ALARM, compare};
use host::oracle::difference;
use host::oracle::equivalence::{self, Equivalence, Test};
use host::oracle::lockstep::Paired;

/// Failures that a message lists; the file with the p-values has all of them.
const LISTED: usize = 5;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Whether `picture` is the double's of `paired` within the bounds of [`equivalence`]. If not, says where and by how much, and where
/// the evidence is: in the folder of this name.
///
/// # Panics
/// If the pictures have other sizes or holes, or the evidence cannot be written.
pub fn equivalent(name: &str, picture: &Picture, paired: &Paired) -> Result<Equivalence, String> {
    let found = equivalence::test(picture, paired).unwrap_or_else(|error| panic!("{error}"));
    if found.passes() {
        return Ok(found);
    }
    let Test {
        difference, bound, ..
    } = found.picture;
    let mut said = format!(
        "{name}: the mean is off by {:+.3} % of its bound",
        100.0 * difference / bound
    );
    let failed: Vec<_> = found.failed().collect();
    let _ = write!(
        said,
        ", {} of {} tiles are beyond theirs",
        failed.len(),
        found.tiles.len()
    );
    for tile in failed.iter().take(LISTED) {
        let test = &tile.test;
        let _ = write!(
            said,
            "; ({}, {}) {}: {:+.5} +- {:.5} of {:.5}",
            tile.x, tile.y, CHANNELS[tile.channel], test.difference, test.standard_error, test.bound
        );
    }
    let mut values = String::from("x,y,channel,difference,standard error,bound,p\n");
    for tile in &found.tiles {
        let test = &tile.test;
        let _ = writeln!(
            values,
            "{},{},{},{:e},{:e},{:e},{:e}",
            tile.x,
            tile.y,
            CHANNELS[tile.channel],
            test.difference,
            test.standard_error,
            test.bound,
            test.p_value()
        );
    }
    // On the map of tiles, the noise is the pair's.
    let image = Estimate {
        picture: picture.clone(),
        variance: Some(paired.variance.clone()),
        spp: None,
    };
    let exact = Estimate {
        picture: paired.double.picture.clone(),
        variance: None,
        spp: None,
    };
    let comparison = compare(&image, &exact).unwrap_or_else(|error| panic!("{error}"));
    Err(with_evidence(said, name, &image, &exact, &comparison, &values))
}

/// Whether noise explains all that sets `image` apart from `reference`: no tile and no pixel further off than chance allows, and their
/// p-values uniform. If not, says where, and where the evidence is. A picture without error fails once in a hundred times by its tiles,
/// its pixels, and the histogram of its p-values, each.
///
/// # Panics
/// If the pictures cannot be compared, have less than 1,024 samples a pixel, or the evidence cannot be written.
pub fn explained_by_noise(name: &str, image: &Estimate, reference: &Estimate) -> Result<Comparison, String> {
    let found = compare(image, reference).unwrap_or_else(|error| panic!("{error}"));
    let pixels = found.pixels.as_ref().expect("enough samples for pixels");
    let uniformity = found.uniformity.as_ref().expect("enough pixels");
    let tiles: Vec<_> = found.tiles.failed().collect();
    if tiles.is_empty() && pixels.failed.is_empty() && uniformity.p_value >= FALSE_ALARM {
        return Ok(found);
    }
    let mut said = format!(
        "{name}: noise does not explain {} of {} tile tests and {} of {} pixel tests; a histogram of p-values like this has p {:.1e}",
        tiles.len(),
        found.tiles.tested(),
        pixels.failed.len(),
        pixels.tested,
        uniformity.p_value
    );
    for (tile, channel) in tiles.iter().take(LISTED) {
        let _ = write!(
            said,
            "; tile ({}, {}) {}: z {:+.2}",
            tile.x, tile.y, CHANNELS[*channel], tile.z[*channel]
        );
    }
    for pixel in pixels.failed.iter().take(LISTED) {
        let _ = write!(
            said,
            "; pixel ({}, {}) {}: z {:+.2}",
            pixel.x, pixel.y, CHANNELS[pixel.channel], pixel.z
        );
    }
    let mut values = String::from("p from,pixels\n");
    for (bin, count) in uniformity.histogram.iter().enumerate() {
        let _ = writeln!(
            values,
            "{},{count}",
            bin as f64 / uniformity.histogram.len() as f64
        );
    }
    values.push_str("x,y,channel,z of the tile\n");
    for tile in &found.tiles.tiles {
        for (channel, z) in CHANNELS.iter().zip(tile.z) {
            let _ = writeln!(values, "{},{},{channel},{z}", tile.x, tile.y);
        }
    }
    Err(with_evidence(said, name, image, reference, &found, &values))
}

/// Writes the evidence and adds to what is said where it is.
fn with_evidence(
    said: String,
    name: &str,
    image: &Estimate,
    reference: &Estimate,
    comparison: &Comparison,
    p_values: &str,
) -> String {
    let folder = folder(name);
    let written = || -> Result<(), Box<dyn std::error::Error>> {
        fs::create_dir_all(&folder)?;
        for (file, estimate) in [("picture", image), ("reference", reference)] {
            openexr::write(&folder.join(format!("{file}.exr")), estimate)?;
            estimate.picture.write_png(&folder.join(format!("{file}.png")))?;
        }
        let path = folder.join("difference.png");
        difference::write(&path, name, &image.picture, &reference.picture, comparison)?;
        fs::write(folder.join("p-values.csv"), p_values)?;
        Ok(())
    };
    written().unwrap_or_else(|error| panic!("{said}; and the evidence cannot be written: {error}"));
    format!(
        "{said}; picture, reference, difference and p-values are in {}",
        folder.display()
    )
}

fn folder(name: &str) -> PathBuf {
    let firmware = firmware::target_folder().expect("tests run in the checkout");
    firmware.with_file_name("image-diff").join(name)
}
