//! `cargo xtask profile`: accounts that add up, files that are read again, and clear words where there is no profile.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use host::profile::Cost;
use host::profile::run::{FORMAT, Named, Run};
use tempfile::TempDir;
use whole_system::{qemu, repository, said, script, xtask};

/// Small pictures are profiled.
fn profile(arguments: &[&str]) -> Command {
    let mut command = xtask(&["profile", "--no-install", "--size", "16x12", "--spp", "4"]);
    command.args(arguments);
    command
}

fn output(mut command: Command) -> (bool, String) {
    let output: Output = command.output().expect("it starts");
    (output.status.success(), said(&output))
}

fn succeeded(command: Command) -> String {
    let (success, text) = output(command);
    assert!(success, "{text}");
    text
}

fn failed(command: Command) -> String {
    let (success, text) = output(command);
    assert!(!success, "{text}");
    text
}

/// A folder with a program that stands for QEMU, and the PATH that finds it first.
pub(crate) fn instead_of_qemu(does: &str) -> (TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    script(&folder.path().join("qemu-system-arm"), does);
    let path = env::var("PATH").expect("a PATH");
    let path = format!("{}:{path}", folder.path().display());
    (folder, path)
}

fn sum(costs: impl Iterator<Item = Cost>) -> Cost {
    costs.fold(Cost::default(), |mut sum, cost| {
        sum += cost;
        sum
    })
}

fn named(costs: &[Named]) -> Cost {
    sum(costs.iter().map(|named| named.cost))
}

/// Every account is of the same cycles, and of the instructions that a render without a plugin counts.
fn check_accounts(run: &Run, instructions_per_sample: f64) {
    assert_eq!((run.samples, run.format), (16 * 12 * 4, FORMAT));
    assert!(run.rays > run.samples);
    assert_eq!(sum(run.functions.iter().map(|function| function.own)), run.total);
    assert_eq!((named(&run.classes), named(&run.lines)), (run.total, run.total));
    assert!((run.cycles_at_least..=run.cycles_at_most).contains(&run.total.cycles));
    // All that ran was called by the function that renders a unit.
    let most = run
        .functions
        .iter()
        .map(|function| function.inclusive_cycles)
        .max();
    assert_eq!(most, Some(run.total.cycles));
    // A core's clock counts in ticks of 41.7 instructions, and what calls the function besides.
    let ratio = instructions_per_sample / run.instructions_per_sample;
    assert!((1.0..1.01).contains(&ratio), "{ratio}");
}

/// What a render without a plugin counts.
fn instructions_per_sample(board: &str, out: &Path) -> f64 {
    let mut render = xtask(&[
        "render",
        "--no-install",
        "--size",
        "16x12",
        "--spp",
        "4",
        "--cores",
        "1",
    ]);
    render
        .args(["--reference", "none", "--board", board, "--out"])
        .arg(out);
    succeeded(render);
    let report = fs::read(out.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
    report["cost"]["instructions_per_sample"]
        .as_f64()
        .expect("a figure")
}

#[test]
fn accounts_add_up_and_a_run_is_compared_with_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    for board in ["versatilepb", "mps2-an385"] {
        let (json, svg) = (file(board), file("stacks.svg"));
        let arguments = [
            "--board",
            board,
            "--json",
            &json,
            "--flame-graph",
            &svg,
            "--lines",
            "3",
            "--blocks",
            "2",
        ];
        let text = succeeded(profile(&arguments));
        let run = Run::read(Path::new(&json)).expect("the run");
        check_accounts(&run, instructions_per_sample(board, &folder.path().join("out")));
        // The dearest blocks are of the arithmetic: no product, no profile.
        assert_eq!(run.blocks.len(), 2);
        let words: Vec<&str> = run.blocks[0]
            .instructions
            .iter()
            .map(|instruction| instruction.text.as_str())
            .collect();
        assert!(
            words
                .iter()
                .any(|text| text.starts_with("smull") || text.starts_with("umull")),
            "{words:?}"
        );
        assert!(text.contains(words[0]), "{text}");
        let drawing = fs::read_to_string(&svg).expect("a drawing");
        assert!(drawing.starts_with("<svg") && drawing.contains("Integrator&gt;::sample"));

        // A core executes the same each time, to the instruction.
        let text = succeeded(profile(&["--board", board, "--compare", &json]));
        let (_, changes) = text.split_once("changes, a sample:").expect("changes");
        assert_eq!(
            (changes.matches("+0.00 %").count(), changes.matches('%').count()),
            (2, 2),
            "{text}"
        );
    }
    // Another board's, another profile's.
    let error = failed(profile(&["--compare", &file("mps2-an385"), "--profile", "paper"]));
    for difference in [
        "board mps2-an385 and not versatilepb",
        "profile precise and not paper",
    ] {
        assert!(error.contains(difference), "{error}");
    }
}

#[test]
fn what_is_no_run_of_this_version_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.json");
    let path = file.to_str().expect("UTF-8");
    for (text, expected) in [
        ("{\"format\": 99}", "in format 99, and this version"),
        ("[1, 2]", "is no run that"),
    ] {
        fs::write(&file, text).expect("a file");
        let error = failed(profile(&["--compare", path]));
        assert!(error.contains(expected), "{error}");
    }
    let error = failed(profile(&["--compare", "no/such.json"]));
    assert!(error.contains("cannot read no/such.json"), "{error}");
}

#[test]
fn a_qemu_that_takes_no_plugin_is_named_as_the_cause() {
    for (complaint, remedy) in [
        (
            "qemu-system-arm: -plugin: invalid option",
            "built without support for plugins",
        ),
        (
            "Could not load plugin x.so: plugin requires API version 1, but this QEMU supports only a minimum version of 2",
            "no longer serves version 1 of the interface",
        ),
    ] {
        let (_folder, path) = instead_of_qemu(&format!("echo '{complaint}' >&2; exit 1"));
        let mut command = profile(&[]);
        command.env("PATH", path);
        let error = failed(command);
        assert!(error.contains(remedy), "{error}");
    }
}

#[test]
fn a_core_that_dies_while_it_is_profiled_leaves_no_figure() {
    let qemu = qemu();
    let does = format!("exec timeout --signal KILL 0.5 '{}' \"$@\"", qemu.display());
    let (folder, path) = instead_of_qemu(&does);
    let json = folder.path().join("run.json");
    // Minutes of work.
    let mut command = xtask(&[
        "profile",
        "--no-install",
        "--size",
        "256x192",
        "--spp",
        "64",
        "--json",
    ]);
    command.arg(&json).env("PATH", path);
    let error = failed(command);
    assert!(error.contains("the core ended while it was recorded"), "{error}");
    assert!(!error.contains("cycles  ") && !json.exists(), "{error}");
}

#[test]
fn a_scene_with_nothing_in_it_is_not_profiled() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("nothing.toml");
    let cornell = fs::read_to_string(repository("scenes/cornell.toml")).expect("a scene");
    let (camera, _) = cornell.split_once("[[sphere]]").expect("spheres");
    fs::write(&scene, camera).expect("a file");
    let error = failed(profile(&[scene.to_str().expect("UTF-8")]));
    assert!(error.contains("the scene is empty"), "{error}");
}
