//! `cargo xtask bench reference`

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use host::bench::reference::Contest;
use host::platform::console::{patiently, say};
use host::platform::setup::{self, Wanted};
use host::platform::workspace;
use host::render::options::Size;
use host::scene::Scene;

use crate::SetUp;

/// The reference's strata want batches of 4x4 in each of the 2x2 sub-pixels.
const BATCH: u32 = 64;

/// Arguments of `bench reference`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scene file [default: scenes/cornell.toml of the checkout]
    scene: Option<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "64x48")]
    size: Size,
    /// Samples per pixel in each of three rounds, of either renderer: a multiple of 64
    #[arg(long, value_name = "N", default_value = "1024", value_parser = samples)]
    spp: u32,
    /// Write the figures as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

fn samples(text: &str) -> Result<u32, String> {
    let samples = text.parse::<u32>().ok();
    let samples = samples.filter(|&spp| spp > 0 && spp.is_multiple_of(BATCH) && spp <= 1 << 20);
    samples.ok_or_else(|| "a multiple of 64 (batches of 4x4 in 2x2 sub-pixels) from 64 to 1048576".to_owned())
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&workspace::scene(arguments.scene.as_deref())?)?;
    scene.check_frame(arguments.size.width, arguments.size.height)?;
    let wanted = Wanted {
        gxx: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, arguments.set_up.install())?;
    let compiler = tools.gxx.context("set-up gave no g++")?;
    let contest = Contest {
        scene: &scene,
        size: arguments.size,
        spp: arguments.spp,
    };
    let outcome = patiently("both render", || contest.hold(&compiler))?;
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&outcome)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    say(outcome.table())?;
    outcome.suffices()?;
    Ok(ExitCode::SUCCESS)
}
