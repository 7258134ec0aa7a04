//! `cargo xtask verify shortcuts`

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use host::oracle::shortcuts;
use host::platform::console::{bar, say};
use host::platform::workspace;
use host::scene::{Integrator, Scene, compile};

/// Arguments of `verify shortcuts`.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Scene files [default: those of scenes/ and tests/scenes/]
    scenes: Vec<PathBuf>,
    /// Rays in all: half of them of scene files, half of random scenes
    #[arg(long, value_name = "N", default_value = "100000000", value_parser = clap::value_parser!(u64).range(1..))]
    rays: u64,
    /// Random scenes
    #[arg(long, value_name = "N", default_value = "500")]
    random: usize,
    /// Where random scenes and rays begin
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let mut scenes = Vec::new();
    for file in files(arguments)? {
        scenes.push((file.display().to_string(), Scene::load(&file)?));
    }
    let named = scenes.len();
    ensure!(
        named > 0,
        "there is no scene file; name one, e.g. scenes/cornell.toml"
    );
    let drawn = shortcuts::random_scenes(arguments.seed).take(arguments.random);
    scenes.extend(drawn.map(|scene| (format!("random scene {}", scene.name), scene)));
    let half = arguments.rays.div_ceil(2);
    let bar = bar("comparing with the plain loop");
    bar.set_length(scenes.len() as u64);
    let (mut rays, mut rooms, mut coarse) = (0, 0, 0);
    for (index, (name, scene)) in scenes.iter().enumerate() {
        let compiled = compile(scene, 64, 48, Integrator::Path);
        let share = if index < named {
            half / named as u64
        } else {
            half / arguments.random as u64
        };
        rays += shortcuts::compare(&compiled, share.max(1), arguments.seed)
            .with_context(|| format!("{name}: {scene:?}"))?;
        rooms += u64::from(compiled.is_room());
        coarse += u64::from(compiled.has_coarse_solids());
        bar.inc(1);
    }
    bar.finish_and_clear();
    say(format!(
        "{rays} rays of {} scenes meet what they meet when every primitive is asked; {rooms} of the scenes are a proved room, \
         and {coarse} have solids that are looked at roughly first",
        scenes.len()
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// The scene files that are named, or all of the repository.
fn files(arguments: &Arguments) -> anyhow::Result<Vec<PathBuf>> {
    if !arguments.scenes.is_empty() {
        return Ok(arguments.scenes.clone());
    }
    let mut files = Vec::new();
    for folder in ["scenes", "tests/scenes"] {
        let folder = workspace::file(folder)?;
        let entries =
            std::fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?;
        for entry in entries {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}
