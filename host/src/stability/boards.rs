//! Whether every board draws the hard scenes to the bit as the host does.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use tracer::profile::{Paper, Precise};

use super::part::{HARD_SCENES, plan, scene_files};
use super::{Effort, Error, Findings, Part, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::firmware::board::Board;
use crate::oracle::direct;
use crate::render::options::RenderOptions;
use crate::render::render;
use crate::scene::{Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "boards",
    about: "the hard scenes on emulated boards, to the bit: builds some eighty images",
    measure,
};

const SIZE: [u16; 2] = [16, 12];
const SPP: u32 = 16;

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: RenderOptions,
}

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let mut files = scene_files(&[HARD_SCENES])?;
    if effort.is_quick() {
        files.truncate(2);
    }
    effort.expect((files.len() * Arithmetic::ALL.len() * Board::ALL.len()) as u64);
    let units = format!("{}x{} pixels of {SPP} samples.", SIZE[0], SIZE[1]);
    let mut head = vec!["scene"];
    let names: Vec<String> = Arithmetic::ALL
        .iter()
        .flat_map(|arithmetic| Board::ALL.map(|board| format!("`{arithmetic}`, {board}")))
        .collect();
    head.extend(names.iter().map(String::as_str));
    let mut table = Table::new("The same bits as on the host", units, &head);
    let mut faults = Vec::new();
    for file in files {
        let scene = Scene::load(&file)?;
        let mut row = vec![format!("`{}`", scene.name)];
        for arithmetic in Arithmetic::ALL {
            let expected = on_host(&scene, arithmetic);
            for board in Board::ALL {
                let is_same = on_board(&file, arithmetic, board)? == expected;
                row.push(if is_same { "yes" } else { "no" }.to_owned());
                if !is_same {
                    faults.push(format!(
                        "{} by {arithmetic} on {board} is another picture",
                        scene.name
                    ));
                }
                effort.done(1);
            }
        }
        table.push(row);
    }
    Ok(Findings {
        tables: vec![table],
        faults,
        ..Findings::default()
    })
}

fn on_host(scene: &Scene, arithmetic: Arithmetic) -> String {
    let compiled = compile(scene, SIZE[0], SIZE[1], Integrator::Path);
    let plan = plan(arithmetic, &compiled, SIZE, SPP);
    let film = match arithmetic {
        Arithmetic::Precise => direct::film::<Precise>(&compiled, &plan),
        Arithmetic::Paper => direct::film::<Paper>(&compiled, &plan),
    };
    film.sha256()
}

fn on_board(file: &Path, arithmetic: Arithmetic, board: Board) -> Result<String, Error> {
    let out = tempfile::tempdir()?;
    let size = format!("{}x{}", SIZE[0], SIZE[1]);
    let flags = [
        "--size",
        &size,
        "--spp",
        &SPP.to_string(),
        "--cores",
        "1",
        "--reference",
        "none",
        "--profile",
        arithmetic.name(),
        "--board",
        board.name(),
    ]
    .map(str::to_owned);
    let places = [file, Path::new("--out"), out.path()].map(|path| path.as_os_str().to_owned());
    let words = std::iter::once("render".into())
        .chain(places)
        .chain(flags.map(Into::into));
    let options = Flags::try_parse_from(words)?.options;
    Ok(render(&options, &AtomicBool::new(false))?.report.image_sha256)
}
