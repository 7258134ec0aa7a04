//! Cycles from end to end: functions that are counted by hand run in QEMU with the plugin, and cost what was counted.

use std::fs;
use std::path::Path;

use cycles::flow::Flow;
use cycles::{Cycles, file};
use host::firmware::board::Board;
use host::firmware::plugin::{self, Recorder};
use host::firmware::symbols::functions;
use host::fleet::run_recorded;
use host::render::report::Report;
use whole_system::{qemu, said, test_image, xtask};

use crate::profile::instead_of_qemu;

/// A function of `firmware/images/sequences.rs`, its cycles on an ARM9E-S, and those on a Cortex-M3: at least, likely, at most.
type Counted = (&'static str, u64, [u64; 3]);

/// Instruction by instruction, in the function's order. P is what a jump of the Cortex-M3 takes: 1, 2 or 3 cycles.
const COUNTED: [Counted; 11] = [
    // 1 + 3; 1 + (1 + P)
    ("sum", 4, [3, 4, 5]),
    // 1 + 10 + 9 * 3 + 1 + 3; 1 + 10 + 9 * (1 + P) + 1 + (1 + P)
    ("repeated", 42, [32, 42, 52]),
    // 1 + 1 + 1 + (1 late) 1 + 1 + 3; 1 + 2 + 1 + 1 + (1 + P)
    ("byte_across_branch", 8, [7, 8, 9]),
    // 1 + 1 + 1 + (1 late) 1 + 1 + 3; 1 + (0 0 1) + 1 + (0 0 1) + 2 + 1 + (1 + P)
    ("conditional_loads", 8, [7, 8, 11]),
    // 1 + 4 + (2 + 2) + 4 + 3 * 3 + 1 + 3; 1 + 4 + 4 * (0 1 1) + (2 * 2 + 2) + 4 + 3 * (1 + P) + 1 + (1 + P)
    ("alternating_load", 26, [24, 32, 36]),
    // 4 + 1 + (4 + 4); (1 + 4) + 1 + (1 + 4 + P)
    ("saved_registers", 13, [12, 13, 14]),
    // 3 + (1 late) 1 + 1 + 3; (1 + 3) + 1 + (1 + P)
    ("loaded_registers", 8, [7, 8, 9]),
    // 1 + (1 late) 1 + 1 + 3; 2 + 1 + (1 + P)
    ("copied_word", 6, [5, 6, 7]),
    // 3 + 3 + (1 late) 1 + 1 + 3; (3 4 5) + (4 6 7) + 1 + (1 + P)
    ("long_products", 11, [10, 14, 17]),
    // 2 + 3; 1 + (1 + P)
    ("register_shift", 5, [3, 4, 5]),
    // 2 + 3 + 2 + 3 + (2 + 4); (1 + 2) + (1 + P) + 1 + (1 + P) + (1 + 2 + P)
    ("nested_call", 16, [12, 15, 18]),
];

fn flows(board: Board) -> Vec<Flow> {
    let elf = test_image(board, "sequences", None);
    let folder = tempfile::tempdir().expect("a folder");
    let entry = |&(name, ..): &Counted| match functions(&elf, &format!("sequences::{name}")).as_deref() {
        Ok(&[only]) => only,
        other => panic!("{name}: {other:?}"),
    };
    let recorder = Recorder {
        plugin: plugin::ready(&qemu()).unwrap_or_else(|error| panic!("{error}")),
        entries: COUNTED.iter().map(entry).collect(),
        each: true,
        file: folder.path().join("flow"),
    };
    let output = run_recorded(&qemu(), board, &elf, &recorder).expect("QEMU starts");
    assert!(output.status.success(), "{}", said(&output));
    let recording = file::read(&recorder.file).unwrap_or_else(|error| panic!("{error}"));
    recording.segments
}

#[test]
fn what_was_counted_by_hand_is_what_the_meter_counts() {
    for board in Board::ALL {
        let flows = flows(board);
        assert_eq!(flows.len(), COUNTED.len(), "{board}");
        for ((name, on_arm9, on_cortex_m3), flow) in COUNTED.iter().zip(&flows) {
            assert_eq!(
                (flow.calls(), flow.interruption()),
                (1, None),
                "{name} on {board}"
            );
            let Cycles { low, likely, high } = cycles::cycles(flow, 0);
            let expected = match board {
                Board::Versatilepb => [*on_arm9; 3],
                Board::Mps2An385 => *on_cortex_m3,
            };
            assert_eq!([low, likely, high], expected, "{name} on {board}: {flow:#x?}");
        }
    }
}

/// What a render with cycles says that cannot count them.
fn failed(path: &str, out: &Path, flags: &[&str]) -> String {
    let mut command = xtask(&[
        "render",
        "--no-install",
        "--cycles",
        "--reference",
        "none",
        "--out",
    ]);
    command.arg(out).args(flags).env("PATH", path);
    let output = command.output().expect("it starts");
    assert!(!output.status.success(), "{}", said(&output));
    said(&output)
}

#[test]
fn a_qemu_without_our_plugin_interface_is_named_before_anything_is_rendered() {
    for (complaint, remedy) in [
        ("-plugin: invalid option", "built without support for plugins"),
        (
            "plugin requires API version 1, but this QEMU supports only a minimum version of 3",
            "take QEMU 7.2",
        ),
    ] {
        let (folder, path) = instead_of_qemu(&format!("echo 'qemu-system-arm: {complaint}' >&2; exit 1"));
        let out = folder.path().join("out");
        let error = failed(&path, &out, &["--size", "16x12", "--spp", "4", "--cores", "1"]);
        assert!(
            error.contains(remedy) && !out.join("report.json").exists(),
            "{error}"
        );
    }
}

/// The other core completes the picture, which is kept. But what the dead one has spent on it nobody knows.
#[test]
fn a_core_that_dies_while_it_is_counted_leaves_a_picture_and_no_figure() {
    let qemu = qemu();
    let qemu = qemu.display();
    let dies = format!(
        "case \"$*\" in *core-1.boot*) exec timeout --signal KILL 0.3 '{qemu}' \"$@\";; esac; exec '{qemu}' \"$@\""
    );
    let (folder, path) = instead_of_qemu(&dies);
    let out = folder.path().join("out");
    let error = failed(&path, &out, &["--size", "64x48", "--spp", "64", "--cores", "2"]);
    assert!(error.contains("core 1 left no record of its cycles"), "{error}");
    let report = report(&out);
    assert!(
        report.complete && report.cost.cycles_per_sample.is_none(),
        "{report:?}"
    );
}

/// What a render of a small picture counts, on so many cores.
fn counted(path: &str, cores: &str) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    let flags = "--no-install --cycles --reference none --size 32x24 --spp 8 --cores";
    let mut command = xtask(&["render"]);
    command
        .args(flags.split(' '))
        .arg(cores)
        .arg("--out")
        .arg(folder.path());
    let output = command.env("PATH", path).output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    report(folder.path())
        .cost
        .cycles_per_sample
        .expect("they were counted")
}

fn report(out: &Path) -> Report {
    serde_json::from_slice(&fs::read(out.join("report.json")).expect("a report")).expect("JSON")
}

/// The second core of the last render comes when all is done and nobody tells it so: its record is empty, and there.
#[test]
fn the_cycles_of_a_picture_do_not_depend_on_its_cores() {
    let qemu = qemu();
    let qemu = qemu.display();
    let late = format!("case \"$*\" in *core-1.boot*) sleep 4;; esac; exec '{qemu}' \"$@\"");
    let (_folder, late) = instead_of_qemu(&late);
    let path = std::env::var("PATH").expect("a PATH");
    let one = counted(&path, "1");
    for two in [counted(&path, "2"), counted(&late, "2")] {
        assert!((two / one - 1.0).abs() < 1e-3, "{one} and {two}");
    }
}
