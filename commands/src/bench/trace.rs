//! `cargo xtask bench trace`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use host::bench::baseline::{self, Baseline};
use host::bench::samples::{self, Kinds, Series};
use host::firmware::board::Board;
use host::platform::console::say;
use host::platform::workspace;
use host::render::options::Size;

use crate::SetUp;

/// Arguments of `bench trace`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scene file [default: scenes/cornell.toml of the checkout]
    scene: Option<PathBuf>,
    /// Boards of the cores
    #[arg(long = "board", value_name = "BOARD,..", value_enum, value_delimiter = ',', default_values_t = Board::ALL)]
    boards: Vec<Board>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "64x48")]
    size: Size,
    /// Samples per pixel in all, a multiple of 4
    #[arg(long, value_name = "N", default_value = "64", value_parser = host::render::options::samples_per_pixel)]
    spp: u32,
    /// Samples per pixel of the reference in double precision, a multiple of 4
    #[arg(long, value_name = "N", default_value = "512", value_parser = host::render::options::samples_per_pixel)]
    reference_spp: u32,
    /// Samples per pixel by which noise is told
    #[arg(long, value_name = "N", default_value = "4096", value_parser = host::render::options::samples_per_pixel)]
    noise_spp: u32,
    /// Only the profiles as published, and ours looking for light with samples that keep apart
    #[arg(long)]
    few: bool,
    /// Number of cores
    #[arg(long, value_name = "N", default_value = "2", value_parser = clap::value_parser!(u16).range(1..=1024))]
    cores: u16,
    /// Put the cycles of a small Cornell box into tests/cycles.toml, above which a test lets none rise; measures nothing else
    #[arg(long, conflicts_with_all = ["scene", "boards", "size", "spp", "reference_spp", "noise_spp", "few", "cores", "json"])]
    bless: bool,
    /// Render with `precise`'s formulas in soft f32 and f64, too, in images that do not fit a core's memory: some minutes
    #[arg(long)]
    soft_float: bool,
    /// Write the list as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let series = Series {
        scene: workspace::scene(arguments.scene.as_deref())?,
        boards: arguments.boards.clone(),
        size: arguments.size,
        spp: arguments.spp,
        reference_spp: arguments.reference_spp,
        noise_spp: arguments.noise_spp,
        kinds: if arguments.few { Kinds::Few } else { Kinds::All },
        cores: arguments.cores,
        soft_float: arguments.soft_float,
        no_install: arguments.set_up.no_install,
    };
    let series = if arguments.bless {
        baseline::series()?
    } else {
        series
    };
    let rows = samples::measure(&series, interrupted)?;
    if arguments.bless {
        Baseline::of(&rows)?.store()?;
    }
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&rows)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    say(samples::table(&rows))?;
    Ok(ExitCode::SUCCESS)
}
