//! `cargo xtask bench scaling`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use host::bench::scaling::{self, Experiment};
use host::platform::console::say;
use host::platform::workspace;
use host::render::options::Size;

use crate::SetUp;

/// Arguments of `bench scaling`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scene file [default: scenes/cornell.toml of the checkout]
    scene: Option<PathBuf>,
    /// Numbers of cores [default: 1,2,4,8,16,32,64,136; with --quick 1,2,4]
    #[arg(long, value_name = "N,..", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    cores: Vec<u16>,
    /// Width and height in pixels [default: 480x360, which has 79 units for each of 136 cores]
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// A tiny picture and no energy, to see whether all works; its figures say little
    #[arg(long, conflicts_with = "size")]
    quick: bool,
    /// Write all figures as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

const FEW_CORES: [u16; 3] = [1, 2, 4];

pub(crate) fn run(arguments: &Arguments, interrupted: &AtomicBool) -> anyhow::Result<ExitCode> {
    let (experiment, usual): (fn(_, _, _) -> _, &[u16]) = if arguments.quick {
        (Experiment::quick, &FEW_CORES)
    } else {
        (Experiment::full, &scaling::published::FIGURE_4)
    };
    let cores = if arguments.cores.is_empty() {
        usual.to_vec()
    } else {
        arguments.cores.clone()
    };
    let scene = workspace::scene(arguments.scene.as_deref())?;
    let mut experiment: Experiment = experiment(scene, cores, arguments.set_up.install());
    experiment.size = arguments.size.unwrap_or(experiment.size);
    let outcome = scaling::measure(&experiment, interrupted)?;
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&outcome)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    say(scaling::table(&outcome))?;
    Ok(ExitCode::SUCCESS)
}
