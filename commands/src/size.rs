//! `cargo xtask size`: what an image takes of a core's code memory, and with its scene of data memory (boot block, data, stacks).

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::Board;
use host::firmware::footprint::{self, Footprint};
use host::firmware::{self, Recipe, growth};
use host::fleet::session::boot_block_len;
use host::platform::console::say;
use host::platform::setup::{self, Toolchain, Wanted};
use host::platform::workspace;
use host::scene::{Scene, compile};

use crate::SetUp;

/// Arguments of `size`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene that the images are for [default: scenes/cornell.toml of the checkout]
    scene: Option<PathBuf>,
    /// Write the table as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Say what has changed since a table was written as JSON, in all and by function
    #[arg(long, value_name = "FILE")]
    compare: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&workspace::scene(arguments.scene.as_deref())?)?;
    let before = arguments.compare.as_deref().map(footprint::read).transpose()?;
    let tools = setup::ensure(
        Wanted {
            firmware: true,
            ..Wanted::default()
        },
        arguments.set_up.install(),
    )?;
    let rows = measure(&tools.firmware.context("set-up gave no compiler")?, &scene)?;
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&rows)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    say(footprint::table(&rows))?;
    if let Some(before) = before {
        say(format!("\n{}", growth::table(&before, &rows)?))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Builds and measures the images for a scene; fails where one is over the budget.
pub(crate) fn measure(toolchain: &Toolchain, scene: &Scene) -> anyhow::Result<Vec<Footprint>> {
    let footprint = |(board, profile): (Board, Arithmetic)| {
        // The boot block's length does not depend on the size of the picture.
        let boot_block = boot_block_len(&compile(scene, 4, 3, profile.integrator()));
        let image = firmware::build(toolchain, board, &Recipe::by_default(profile, scene))?;
        let footprint = Footprint::of(board, profile, &scene.name, &image, boot_block)?;
        ensure!(
            footprint.is_within_budget(),
            "an image is over the budget:\n{}",
            footprint::table(&[footprint])
        );
        Ok(footprint)
    };
    let both = Board::ALL
        .into_iter()
        .flat_map(|board| Arithmetic::ALL.map(|profile| (board, profile)));
    both.map(footprint).collect()
}
