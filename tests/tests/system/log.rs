//! The cores' log: away when nobody asked for it, and when somebody did, all that the level says, from the right core and place.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use host::firmware::Level;
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::{Board, ITCM_BUDGET};
use host::firmware::{Image, Recipe, build};
use host::render::options::RenderOptions;
use host::render::render;
use object::{Object, ObjectSection, ObjectSymbol};
use serde_json::Value;
use tracer::profile::Precise;
use tracer::scene::Capabilities;
use whole_system::{cornell, film_by, plan, repository, toolchain};

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: RenderOptions,
}

fn image(board: Board, recipe: Recipe, log: Option<Level>) -> Image {
    build(&toolchain(), board, &Recipe { log, ..recipe }).unwrap()
}

/// The largest image whose paths only meet light, and the default's.
fn recipes(profile: Arithmetic) -> [Recipe; 2] {
    let default = Recipe::by_default(profile, &cornell());
    let paths = Recipe {
        needs: Capabilities::PATHS,
        ..default
    };
    [paths, default]
}

/// What an image has of `defmt`: sections, and symbols.
fn remains(image: &Image) -> [usize; 2] {
    let bytes = std::fs::read(&image.elf).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let is_of_it = |name: object::Result<&str>| name.unwrap().to_lowercase().contains("defmt");
    let sections = file.sections().filter(|section| is_of_it(section.name()));
    let symbols = file.symbols().filter(|symbol| is_of_it(symbol.name()));
    [sections.count(), symbols.count()]
}

#[test]
fn an_image_without_a_log_has_nothing_of_it_and_one_with_it_fits() {
    for board in Board::ALL {
        for recipe in Arithmetic::ALL.into_iter().flat_map(recipes) {
            let what = format!("{board}, {}", recipe.describe());
            let [without, with] = [None, Some(Level::Trace)].map(|log| image(board, recipe, log));
            assert_eq!(remains(&without), [0, 0], "{what}");
            assert!(remains(&with).iter().all(|&found| found > 0), "{what}");
            let [quiet, talkative] = [&without, &with].map(|image| image.size.itcm_bytes);
            println!("{what}: {quiet} bytes of code memory, {talkative} with a log at its most talkative");
            assert!(talkative <= ITCM_BUDGET, "{what}");
        }
    }
}

/// One line of the fleet's log.
#[derive(Debug)]
struct Line {
    seconds: f64,
    core: usize,
    level: String,
    text: String,
    place: String,
}

/// As in `    0.001234  core 2  DEBUG  text   (file:line)`.
fn read(line: &str) -> Option<Line> {
    let (seconds, rest) = line.trim_start().split_once("  core ")?;
    let (core, rest) = rest.split_once("  ")?;
    let (level, rest) = rest.split_once("  ")?;
    let (text, place) = rest.trim_start().rsplit_once("   (")?;
    Some(Line {
        seconds: seconds.parse().ok()?,
        core: core.parse().ok()?,
        level: level.trim().to_owned(),
        text: text.to_owned(),
        place: place.strip_suffix(')')?.to_owned(),
    })
}

/// Renders the Cornell box with these flags: the report, and the log.
fn rendered(flags: &str, out: &Path) -> (Value, Vec<Line>) {
    let scene = repository("scenes/cornell.toml");
    let words = ["render", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let options = Flags::parse_from(words.into_iter().chain(flags.split_whitespace())).options;
    render(&options, &AtomicBool::new(false)).unwrap();
    let report = std::fs::read(out.join("report.json")).unwrap();
    let log = std::fs::read_to_string(out.join("cores/fleet.log")).unwrap();
    let lines = log
        .lines()
        .map(|line| read(line).unwrap_or_else(|| panic!("{line}")));
    (serde_json::from_slice(&report).unwrap(), lines.collect())
}

/// The unit that a line says is done.
fn done(line: &Line) -> Option<u32> {
    let text = line.text.strip_prefix("unit ")?;
    text.split_once(" is done")?.0.parse().ok()
}

#[test]
fn a_fleet_s_log_tells_of_every_unit_and_changes_no_pixel() {
    let out = tempfile::tempdir().unwrap();
    let flags = "--size 64x48 --spp 16 --reference none --cores 2 --board versatilepb,mps2-an385 --log debug";
    let (report, lines) = rendered(flags, out.path());
    let expected = film_by(Arithmetic::Precise, &cornell(), &plan::<Precise>(64, 48, 16)).sha256();
    assert_eq!(report["image_sha256"], expected);

    let cores = report["per_core"].as_array().unwrap();
    let of_core = |core| lines.iter().filter(move |line| line.core == core);
    assert_eq!(
        lines.iter().map(|line| line.core).collect::<HashSet<_>>(),
        (0..cores.len()).collect()
    );
    for core in 0..cores.len() {
        assert!(of_core(core).is_sorted_by_key(|line| line.seconds), "core {core}");
        for words in ["with profile precise", "told to stop", "bytes of stack used"] {
            assert!(
                of_core(core).any(|line| line.text.contains(words)),
                "core {core}: {words}"
            );
        }
    }
    // A unit may have been done twice, but not without saying so, and not without anybody having done it.
    let units: u64 = cores.iter().map(|core| core["units"].as_u64().unwrap()).sum();
    let all: HashSet<u32> = lines.iter().filter_map(done).collect();
    assert_eq!(all.len() as u64, units);

    let levels: HashSet<&str> = lines.iter().map(|line| line.level.as_str()).collect();
    assert!(
        levels.contains("INFO") && levels.contains("DEBUG") && !levels.contains("TRACE"),
        "{levels:?}"
    );

    let mut places: BTreeMap<&str, &Line> = BTreeMap::new();
    places.extend(lines.iter().map(|line| (line.place.as_str(), line)));
    for (place, line) in places {
        let (file, number) = place.rsplit_once(':').unwrap();
        let source = std::fs::read_to_string(repository(file)).unwrap();
        let written = source.lines().nth(number.parse::<usize>().unwrap() - 1).unwrap();
        let call = format!("{}!(", line.level.to_lowercase());
        assert!(written.contains(&call), "{place} is `{written}`, not a {call}");
    }
}

#[test]
fn a_higher_level_says_less() {
    let out = tempfile::tempdir().unwrap();
    let flags = "--size 32x24 --spp 4 --reference none --cores 1 --log info";
    let (_, lines) = rendered(flags, out.path());
    assert!(!lines.is_empty());
    assert!(lines.iter().all(|line| line.level == "INFO"), "{lines:?}");
}
