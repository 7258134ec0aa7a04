//! Every board draws the same picture, of every scene and by every profile.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use clap::Parser;
use host::bench::baseline::{self, Baseline};
use host::bench::samples::measure;
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::Board;
use host::render::options::RenderOptions;
use host::render::render;
use host::scene::Scene;
use tracer::profile::Precise;
use whole_system::{film_by, plan, repository};

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: RenderOptions,
}

/// The scenes of a folder.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let files = std::fs::read_dir(repository(folder)).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let mut scenes: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    assert!(scenes.len() > 1, "{scenes:?}");
    scenes.sort_unstable();
    scenes
}

/// The picture's hash that a fleet of one board gives.
fn sha256(scene: &Path, board: Board, out: &Path) -> String {
    let words = ["render", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let flags = "--size 20x16 --spp 8 --cores 1 --reference none --board";
    let options = Flags::parse_from(words.into_iter().chain(flags.split(' ')).chain([board.name()])).options;
    let finished = render(&options, &AtomicBool::new(false)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(finished.report.board.as_deref(), Some(board.name()));
    finished.report.image_sha256
}

#[test]
fn every_scene_is_the_same_picture_on_boards_and_on_the_host() {
    let out = tempfile::tempdir().unwrap();
    let all = scenes("scenes")
        .into_iter()
        .map(|path| (path, Board::ALL.to_vec()));
    // Those of tests in turn, because each takes an image of its own.
    let turns = scenes("tests/scenes")
        .into_iter()
        .zip(Board::ALL.into_iter().cycle());
    for (path, boards) in all.chain(turns.map(|(path, board)| (path, vec![board]))) {
        let scene = Scene::load(&path).unwrap();
        let expected = film_by(Arithmetic::Precise, &scene, &plan::<Precise>(20, 16, 8)).sha256();
        for board in boards {
            let found = sha256(&path, board, out.path());
            assert_eq!(found, expected, "{} on {board}", path.display());
            println!("{} on {board}: {found}", path.display());
        }
    }
}

/// The list itself fails where boards disagree.
#[test]
fn what_a_sample_costs_is_told_for_every_board_and_profile() {
    let series = baseline::series().unwrap();
    let rows = measure(&series, &AtomicBool::new(false)).unwrap_or_else(|error| panic!("{error}"));
    println!("{}", host::bench::samples::table(&rows));
    let (old, now) = (Baseline::load().unwrap(), Baseline::of(&rows).unwrap());
    if now.compiler != old.compiler {
        println!(
            "rustc {} made the images, and the baseline is of {}: not compared",
            now.compiler, old.compiler
        );
    }
    let risen = old.risen(&now);
    assert!(
        risen.is_empty(),
        "the tracer has become slower:\n{}\nIf that is meant, say why in the changelog, and put the new cycles in the same commit with \
         `cargo xtask bench trace --bless`",
        risen.join("\n")
    );
    // Each profile with each end of paths, and ours looking for light.
    assert_eq!(rows.len(), (2 * 2 + 1) * Board::ALL.len());
    let cost = |profile: Arithmetic, board| {
        let of = |row: &&host::bench::samples::Row| {
            (row.profile.as_str(), row.termination.as_str(), row.board) == (profile.name(), "roulette", board)
        };
        rows.iter()
            .find(of)
            .and_then(|row| row.instructions_per_sample)
            .expect("a cost")
    };
    for board in Board::ALL {
        // Ours is no less than five times as fast as the published choices, whatever the processor.
        assert!(
            5.0 * cost(Arithmetic::Precise, board) < cost(Arithmetic::Paper, board),
            "{board}"
        );
    }
    let json = serde_json::to_value(&rows[0]).unwrap();
    for key in [
        "board",
        "profile",
        "scene",
        "termination",
        "instructions_per_sample",
        "cycles_per_sample",
        "rays_per_sample",
        "bias",
        "rmse",
        "integrator",
        "variance_mean",
        "variance_median",
        "efficiency",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
    for row in &rows {
        let bounds = [
            row.cycles_per_sample_low,
            row.cycles_per_sample,
            row.cycles_per_sample_high,
        ];
        let [low, likely, high] = bounds.map(|bound| bound.expect("cycles were counted"));
        assert!(low <= likely && likely <= high && row.bias.is_some(), "{row:?}");
        // An ARM9E-S takes a cycle an instruction at least; what a Cortex-M3 folds costs it none.
        if row.board == Board::Versatilepb {
            assert!(Some(low) > row.instructions_per_sample, "{row:?}");
        }
    }
}
