//! `report.json`: what a render did, what it cost, and how wrong it is.
//!
//! The keys are an interface: other programs read them. A figure that was not measured is null, never zero.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::collector::Packets;
use crate::firmware::board::Board;
use crate::firmware::{self, ImageSize};
use crate::image::picture::{Estimate, Picture};
use crate::oracle::compare::{CompareError, Comparison, Tiles, compare};
use crate::oracle::lockstep::Paired;
use crate::platform::file::{WriteError, write_whole};

/// The whole report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// Width and height in pixels.
    pub size: [u16; 2],
    /// Samples per pixel asked for.
    pub spp: u32,
    /// Cores asked for.
    pub cores: u32,
    /// The board they ran on; null for the native backend.
    pub board: Option<String>,
    /// The images they ran; none where the cores were no emulated ones of this host.
    #[serde(default)]
    pub images: Vec<Image>,
    /// `qemu` or `native`.
    pub backend: String,
    /// Arithmetic profile.
    pub profile: String,
    /// `path` or `next-event`.
    #[serde(default)]
    pub integrator: String,
    /// `independent` or `kronecker`.
    #[serde(default)]
    pub sampler: String,
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// `leased`, `sequential` or `stochastic`.
    pub pixels: String,
    /// Seed of the render.
    pub seed: u64,
    /// Self-intersection epsilon, in the scene's unit of length.
    pub epsilon: f64,
    /// SHA-256 of the film's integer sums and counts.
    pub image_sha256: String,
    /// Samples in the film.
    pub samples: u64,
    /// Pixels of the film without a sample.
    pub missing_pixels: usize,
    /// Sums of units' pixels that were greater than a packet holds and are counted as the greatest that it does: the picture is too
    /// dark there.
    #[serde(default)]
    pub saturated_sums: u64,
    /// Whether every unit came in; false for the picture that an aborted render leaves.
    pub complete: bool,
    /// From the first core's start to the last unit's arrival.
    pub wall_seconds: f64,
    /// Peak resident memory of the host process and all cores' processes together.
    pub peak_memory_bytes: Option<u64>,
    /// What went over the wire.
    pub packets: Packets,
    /// What a sample costs on the emulated core.
    pub cost: Cost,
    /// What `cost`'s cycles may be wrong by, where they were counted.
    #[serde(default)]
    pub blind_spots: Vec<BlindSpot>,
    /// How far the picture is from the reference.
    pub error: ErrorFigures,
    /// How far arithmetic alone took it: against the same tracer in double precision with the same random numbers.
    pub lockstep_error: Option<LockstepError>,
    /// The cores, one by one.
    pub per_core: Vec<Core>,
}

/// A board's image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// The board.
    pub board: String,
    /// The version of the compiler that made it, where it says so.
    #[serde(default)]
    pub compiler: Option<String>,
    /// How much of a core's memory it takes.
    #[serde(flatten)]
    pub size: ImageSize,
}

impl From<&(Board, firmware::Image)> for Image {
    fn from((board, image): &(Board, firmware::Image)) -> Self {
        Self {
            board: board.name().to_owned(),
            compiler: image.compiler.clone(),
            size: image.size.clone(),
        }
    }
}

/// Cost on the emulated core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Instructions executed inside rendering, counted.
    pub instructions_per_sample: Option<f64>,
    /// Cycles, where they were to be counted: of an ARM9E-S or of a Cortex-M3.
    pub cycles_per_sample: Option<f64>,
    /// The least that they may be, by what the model does not see.
    pub cycles_per_sample_low: Option<f64>,
    /// The most.
    pub cycles_per_sample_high: Option<f64>,
    /// Rays traced.
    pub rays_per_sample: Option<f64>,
}

/// Something that the processor's model does not see, and the worst that it can do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlindSpot {
    /// What it is.
    pub what: String,
    /// The share of the cycles by which they may be too many.
    pub less: f64,
    /// The share by which they may be too few.
    pub more: f64,
}

/// Error against the reference. The figures are defined in [`crate::oracle::compare`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorFigures {
    /// (mean - reference mean) / reference mean over all channels, signed.
    pub bias: Option<f64>,
    /// Upper bound of the standard error of `bias`.
    pub bias_standard_error: Option<f64>,
    /// The picture's part of it: upper bound of the standard error of its mean, relative to the reference's.
    #[serde(default)]
    pub standard_error: Option<f64>,
    /// The reference's part of it.
    #[serde(default)]
    pub reference_standard_error: Option<f64>,
    /// Over the 8x8 tiles, the median of the reference's standard error over the picture's.
    #[serde(default)]
    pub reference_tile_noise_share: Option<f64>,
    /// Noise-corrected root of the mean squared error, linear radiance. Null unless both sides' noise is known.
    pub rmse: Option<f64>,
    /// The largest `rmse` that the noise leaves room for: two standard errors up.
    pub rmse_at_most: Option<f64>,
    /// The square of `rmse` before it was cut off at zero.
    pub squared_error: Option<f64>,
    /// Its standard error.
    pub squared_error_standard_error: Option<f64>,
    /// Peak signal to noise on the display, noise and all.
    pub psnr_db: Option<f64>,
    /// Bias of the 8x8 tile that has most, signed.
    pub max_tile_bias: Option<f64>,
    /// Upper bound of the standard error of `max_tile_bias`.
    pub max_tile_bias_standard_error: Option<f64>,
    /// Mean linear radiance of the picture.
    pub mean: Option<[f64; 3]>,
    /// Mean linear radiance of the reference over the same pixels.
    pub reference_mean: Option<[f64; 3]>,
    /// Samples per pixel of the reference.
    pub reference_spp: Option<u32>,
    /// The test of every tile against its confidence interval. Null unless both sides' noise is known.
    pub tiles: Option<TileTest>,
    /// The chi-squared test of the pixels' p-values: how likely their unevenness is without any error. Null below 1,024
    /// samples per pixel.
    pub uniformity_p_value: Option<f64>,
}

/// The tile test in figures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileTest {
    /// Tests made: tiles times channels.
    pub tested: usize,
    /// What a z-score must stay within, Šidák-corrected.
    pub threshold_z: f64,
    /// The z-score of the largest magnitude, signed; null where a difference meets no noise at all.
    pub max_z: Option<f64>,
    /// Tests beyond the threshold.
    pub failed: usize,
}

/// Error against the lockstep oracle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LockstepError {
    /// As in [`ErrorFigures::bias`].
    pub bias: Option<f64>,
    /// Upper bound of the standard error of `bias`: paths that rounding sends another way are noise, and no others.
    pub bias_standard_error: Option<f64>,
    /// Root of the mean squared difference; with the same random numbers there is little noise to correct for.
    pub rmse: f64,
    /// The largest difference of any channel of any pixel.
    pub max_abs: f64,
}

/// One core's account.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Core {
    /// Its number.
    pub core: u16,
    /// Its board, as it says itself: in a fleet of several.
    pub board: Option<String>,
    /// Units that it was first to deliver.
    pub units: u64,
    /// Ticks of its 24 MHz clock spent rendering.
    pub ticks: Option<u64>,
    /// Most stack it ever used.
    pub stack_bytes: Option<u32>,
    /// Stack it has.
    pub stack_size: Option<u32>,
    /// Packets that it did not take for its own.
    pub rejected: Option<u32>,
    /// Times it was started again after it had failed.
    pub restarts: usize,
    /// The last thing that went wrong with it, if anything: how it ended, or why it was started again.
    pub fault: Option<String>,
}

impl ErrorFigures {
    /// The report's share of a comparison with a reference of `reference_spp` samples per pixel.
    ///
    /// `noise_known` says that both sides had a variance; without it, what rests on it is not a measurement.
    pub fn new(comparison: &Comparison, reference_spp: Option<u32>, noise_known: bool) -> Self {
        let known = |value: f64| noise_known.then_some(value);
        let worst = comparison.tiles.most_biased();
        Self {
            bias: comparison.bias,
            bias_standard_error: comparison.bias_standard_error.filter(|_| noise_known),
            standard_error: comparison.standard_error,
            reference_standard_error: comparison.reference_standard_error,
            reference_tile_noise_share: comparison.noise_share.map(|share| share.tile),
            rmse: known(comparison.rmse),
            rmse_at_most: known(comparison.squared_error.rmse_at_most()),
            squared_error: known(comparison.squared_error.corrected),
            squared_error_standard_error: known(comparison.squared_error.standard_error),
            psnr_db: comparison.psnr_db,
            max_tile_bias: worst.map(|tile| tile.bias),
            max_tile_bias_standard_error: worst.and_then(|tile| known(tile.bias_noise)),
            mean: Some(comparison.mean),
            reference_mean: Some(comparison.reference_mean),
            reference_spp,
            tiles: noise_known.then(|| TileTest::new(&comparison.tiles)),
            uniformity_p_value: comparison.uniformity.as_ref().and_then(|u| known(u.p_value)),
        }
    }
}

impl LockstepError {
    /// How far `picture` is from its double.
    pub fn between(picture: &Picture, paired: &Paired) -> Result<Self, CompareError> {
        let (noisy, double) = paired.difference();
        let noisy = Estimate {
            picture: picture.clone(),
            ..noisy
        };
        let exact = Estimate {
            variance: None,
            ..noisy.clone()
        };
        let (plain, noisy) = (compare(&exact, &double)?, compare(&noisy, &double)?);
        Ok(Self {
            bias: plain.bias,
            bias_standard_error: noisy.bias_standard_error,
            rmse: plain.rmse,
            max_abs: plain.max_abs,
        })
    }
}

impl TileTest {
    fn new(tiles: &Tiles) -> Self {
        Self {
            tested: tiles.tested(),
            threshold_z: tiles.threshold_z,
            max_z: Some(tiles.max_z()).filter(|z| z.is_finite()),
            failed: tiles.failed().count(),
        }
    }
}

impl Report {
    /// Writes the report to `path`.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_whole(path, |writer| {
            serde_json::to_writer_pretty(&mut *writer, self).map_err(|error| error.to_string())?;
            std::io::Write::write_all(writer, b"\n").map_err(|error| error.to_string())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn report() -> Report {
        Report {
            scene: "cornell".to_owned(),
            size: [64, 48],
            spp: 16,
            cores: 2,
            board: Some("versatilepb".to_owned()),
            images: Vec::new(),
            backend: "qemu".to_owned(),
            profile: "precise".to_owned(),
            integrator: "path".to_owned(),
            sampler: "independent".to_owned(),
            termination: "roulette".to_owned(),
            pixels: "leased".to_owned(),
            seed: 1,
            epsilon: 0.000244140625,
            image_sha256: "00".to_owned(),
            samples: 49152,
            missing_pixels: 0,
            saturated_sums: 0,
            complete: true,
            wall_seconds: 1.5,
            peak_memory_bytes: None,
            packets: Packets {
                received: 192,
                ..Packets::default()
            },
            cost: Cost::default(),
            blind_spots: vec![BlindSpot {
                what: "refills".to_owned(),
                less: 0.02,
                more: 0.01,
            }],
            error: ErrorFigures::default(),
            lockstep_error: None,
            per_core: vec![Core {
                core: 1,
                units: 96,
                ..Core::default()
            }],
        }
    }

    #[test]
    fn every_key_of_the_contract_is_there_even_when_nothing_was_measured() {
        let json: Value = serde_json::to_value(report()).unwrap();
        for key in [
            "scene",
            "size",
            "spp",
            "cores",
            "board",
            "backend",
            "profile",
            "image_sha256",
            "samples",
            "wall_seconds",
        ] {
            assert!(json.get(key).is_some_and(|value| !value.is_null()), "{key}");
        }
        for key in ["received", "duplicate", "rejected", "lost"] {
            assert!(json["packets"][key].is_u64(), "{key}");
        }
        for key in ["instructions_per_sample", "cycles_per_sample"] {
            assert_eq!(json["cost"].get(key), Some(&Value::Null), "{key}");
        }
        for key in [
            "bias",
            "rmse",
            "psnr_db",
            "max_tile_bias",
            "mean",
            "reference_mean",
            "reference_spp",
            "standard_error",
            "reference_standard_error",
            "reference_tile_noise_share",
        ] {
            assert_eq!(json["error"].get(key), Some(&Value::Null), "{key}");
        }
        assert_eq!(json["size"], serde_json::json!([64, 48]));
    }

    fn flat(level: f64, variance: Option<f64>) -> Estimate {
        let picture = Picture::new(8, 8, vec![Some([level; 3]); 64]);
        Estimate {
            picture,
            variance: variance.map(|v| vec![[v; 3]; 64]),
            spp: Some(4),
        }
    }

    #[test]
    fn a_comparison_fills_the_error_in() {
        let comparison = compare(&flat(0.55, Some(1e-4)), &flat(0.5, Some(1e-4))).unwrap();
        let error = ErrorFigures::new(&comparison, Some(1024), true);
        assert!((error.bias.unwrap() - 0.1).abs() < 1e-12);
        assert!((error.max_tile_bias.unwrap() - 0.1).abs() < 1e-12);
        assert!((error.rmse.unwrap() - (0.05f64.powi(2) - 2e-4).sqrt()).abs() < 1e-12);
        let tiles = error.tiles.unwrap();
        assert_eq!((tiles.tested, tiles.failed), (3, 3));
    }

    #[test]
    fn without_noise_figures_that_rest_on_it_are_null_and_nothing_is_infinite() {
        let comparison = compare(&flat(0.55, None), &flat(0.5, None)).unwrap();
        let error = ErrorFigures::new(&comparison, None, false);
        assert!((error.bias.unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(
            (error.rmse, error.tiles, error.bias_standard_error),
            (None, None, None)
        );
        assert_eq!(
            ErrorFigures::new(&comparison, None, true).tiles.unwrap().max_z,
            None
        );
    }

    #[test]
    fn lockstep_errors_are_plain_differences() {
        let exact = |pixels| Estimate {
            picture: Picture::new(2, 1, pixels),
            variance: None,
            spp: Some(4),
        };
        let picture = exact(vec![Some([0.5, 0.5, 0.5]), Some([1.0, 1.0, 1.3])]);
        let paired = Paired {
            picture: picture.clone(),
            double: exact(vec![Some([0.5, 0.5, 0.5]), Some([1.0, 1.0, 1.0])]),
            variance: vec![[0.0; 3], [0.0, 0.0, 0.09]],
        };
        let error = LockstepError::between(&picture.picture, &paired).unwrap();
        assert!((error.max_abs - 0.3).abs() < 1e-12);
        assert!((error.rmse - (0.09f64 / 6.0).sqrt()).abs() < 1e-12);
        assert!((error.bias.unwrap() - 0.3 / 4.5).abs() < 1e-12);
        // The only sum that is uncertain is 4.5, by 0.3.
        assert!((error.bias_standard_error.unwrap() - 0.3 / 4.5).abs() < 1e-12);
    }

    #[test]
    fn a_written_report_reads_back_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        report().write(&path).unwrap();
        let back: Report = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(back, report());
    }

    /// Else fuzzing would start from files that are refused at once.
    #[test]
    fn the_reports_that_fuzzing_starts_from_are_read() {
        let folder = crate::platform::workspace::file("fuzz/corpus/report").unwrap();
        let files: Vec<_> = std::fs::read_dir(folder).unwrap().collect();
        assert!(!files.is_empty());
        for file in files {
            let path = file.unwrap().path();
            let read = serde_json::from_slice::<Report>(&std::fs::read(&path).unwrap());
            assert!(read.is_ok(), "{}: {read:?}", path.display());
        }
    }
}
