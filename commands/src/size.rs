//! `cargo xtask size`: what an image takes of a core's code memory, and with its scene of data memory (boot block, data, stacks).

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::{Board, DTCM_BUDGET, ITCM_BUDGET};
use host::firmware::{self, Capability, ImageSize, Recipe};
use host::fleet::session::boot_block_len;
use host::platform::console::say;
use host::platform::setup::{self, Toolchain, Wanted};
use host::platform::workspace;
use host::scene::{Scene, compile};
use serde::Serialize;

use crate::SetUp;

/// Arguments of `size`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene that the images are for [default: scenes/cornell.toml of the checkout]
    scene: Option<PathBuf>,
    /// Write the table as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

/// One image.
#[derive(Serialize)]
pub(crate) struct Row {
    board: &'static str,
    scene: String,
    profile: &'static str,
    #[serde(flatten)]
    size: ImageSize,
    /// Code memory that the tracer takes, with its arithmetic, and the frame around it.
    tracer_bytes: u64,
    frame_bytes: u64,
}

impl Row {
    fn data(&self) -> u64 {
        self.size.dtcm_bytes + self.size.stack_bytes
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&workspace::scene(arguments.scene.as_deref())?)?;
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
    say(table(&rows))?;
    Ok(ExitCode::SUCCESS)
}

/// Builds and measures the images for a scene; fails where one is over the budget.
pub(crate) fn measure(toolchain: &Toolchain, scene: &Scene) -> anyhow::Result<Vec<Row>> {
    // The image does not depend on the size of the picture, nor does the boot block's length.
    let compiled = compile(scene, 4, 3);
    let boot_block = boot_block_len(&compiled);
    let row = |(board, profile): (Board, Arithmetic)| {
        let image = firmware::build(
            toolchain,
            board,
            &Recipe {
                profile,
                needs: compiled.needs.with(Capability::Roulette),
                log: None,
            },
        )?;
        let tracer_bytes = firmware::tracer_bytes(&image.elf)?;
        let row = Row {
            board: board.name(),
            scene: scene.name.clone(),
            profile: profile.name(),
            tracer_bytes,
            frame_bytes: image.size.itcm_bytes - tracer_bytes,
            size: image.size.with_boot_block(boot_block),
        };
        ensure!(
            row.size.itcm_bytes <= ITCM_BUDGET && row.data() <= DTCM_BUDGET,
            "an image is over the budget:\n{}",
            table(&[row])
        );
        Ok(row)
    };
    let both = Board::ALL
        .into_iter()
        .flat_map(|board| Arithmetic::ALL.map(|profile| (board, profile)));
    both.map(row).collect()
}

/// The rows for people.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut lines = vec![format!(
        "{:12} {:10} {:8} {:>32} {:>22}",
        "board", "scene", "profile", "code memory (tracer + frame)", "data memory (stacks)"
    )];
    lines.extend(rows.iter().map(|row| {
        let stack = row.size.stack_bytes;
        format!(
            "{:12} {:10} {:8} {:>32} {:>22}",
            row.board,
            row.scene,
            row.profile,
            format!(
                "{} ({} + {})",
                row.size.itcm_bytes, row.tracer_bytes, row.frame_bytes
            ),
            format!("{} ({stack})", row.data())
        )
    }));
    lines.push(format!("{:32} {ITCM_BUDGET:>32} {DTCM_BUDGET:>22}", "budget"));
    lines.join("\n")
}
