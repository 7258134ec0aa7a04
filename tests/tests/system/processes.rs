//! The programs as processes: signals reach them, cores end with them, exit codes pass through them, cores from elsewhere join.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::Board;
use host::firmware::{self, Recipe};
use host::fleet::NativeFleet;
use serde_json::Value;
use tempfile::TempDir;
use whole_system::{cornell, program, repository, said, script, toolchain, xtask};

/// A picture that takes an emulated core a moment.
const SMALL: [&str; 6] = ["--size", "64x48", "--spp", "16", "--reference", "none"];
/// A picture that takes two emulated cores so long that something can happen to them meanwhile.
const LONG: [&str; 8] = [
    "--size",
    "128x96",
    "--spp",
    "512",
    "--reference",
    "none",
    "--cores",
    "2",
];

fn render(out: &Path, arguments: &[&[&str]]) -> Command {
    let mut command = xtask(&["render"]);
    command.args(arguments.concat()).arg("--out").arg(out);
    command
}

fn report(out: &Path) -> Value {
    let text = fs::read(out.join("report.json")).expect("a report");
    serde_json::from_slice(&text).expect("JSON")
}

/// Renders, which must succeed, and returns the report.
fn rendered(arguments: &[&[&str]]) -> Value {
    let out = tempfile::tempdir().expect("a folder");
    let output = render(out.path(), arguments).output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    report(out.path())
}

/// By the shell's own `kill`: the program of that name is not on every machine.
fn signal(name: &str, process: &str) {
    let status = Command::new("sh")
        .args(["-c", "kill -s \"$1\" \"$2\"", "sh", name, process])
        .status()
        .expect("sh starts");
    assert!(status.success(), "there is no process {process}");
}

pub(crate) fn wait_for(what: &str, mut happened: impl FnMut() -> bool) {
    let start = Instant::now();
    while !happened() {
        assert!(
            start.elapsed() < Duration::from_secs(300),
            "{what} does not happen"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A long render whose two cores are at work.
struct Running {
    child: std::process::Child,
    out: TempDir,
    cores: [String; 2],
}

impl Running {
    fn start(more: &[&str]) -> Self {
        let out = tempfile::tempdir().expect("a folder");
        let child = render(out.path(), &[&LONG, more]).spawn().expect("it starts");
        let file = |core| out.path().join(format!("cores/core-{core}.pid"));
        let process = |core| {
            fs::read_to_string(file(core))
                .unwrap_or_default()
                .trim()
                .to_owned()
        };
        wait_for("the start of the cores", || {
            !process(0).is_empty() && !process(1).is_empty()
        });
        let cores = [process(0), process(1)];
        // They boot in a few tenths of a second and then work for many.
        std::thread::sleep(Duration::from_secs(2));
        Self { child, out, cores }
    }

    fn end(self) -> (Output, TempDir) {
        (self.child.wait_with_output().expect("its output"), self.out)
    }
}

fn is_running(process: &str) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    status
        .lines()
        .any(|line| line.starts_with("State:") && !line.contains("zombie"))
}

#[test]
fn cores_that_hang_end_it_for_a_user_who_says_how_long_to_wait() {
    let running = Running::start(&["--patience", "2"]);
    for core in &running.cores {
        signal("STOP", core);
    }
    let start = Instant::now();
    let cores = running.cores.clone();
    let (output, _) = running.end();
    assert!(start.elapsed() < Duration::from_secs(6));
    assert!(
        said(&output).contains("no core says anything any more"),
        "{}",
        said(&output)
    );
    assert!(!cores.iter().any(|core| is_running(core)));
}

#[test]
fn an_interruption_keeps_the_picture_and_ends_the_cores() {
    let running = Running::start(&[]);
    signal("INT", &running.child.id().to_string());
    let cores = running.cores.clone();
    let (output, out) = running.end();
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(out.path().join("image.png").is_file());
    assert!(!cores.iter().any(|core| is_running(core)));
}

/// Interrupts a command, which must end within a second, with 130; returns what it said.
fn interrupted(child: std::process::Child) -> String {
    let start = Instant::now();
    signal("INT", &child.id().to_string());
    let output = child.wait_with_output().expect("its output");
    let took = start.elapsed();
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(took < Duration::from_secs(1), "{took:?}");
    said(&output)
}

/// The reference would take hours; the picture is there already.
#[test]
fn an_interruption_ends_a_comparison_and_says_where_the_picture_is() {
    let out = tempfile::tempdir().expect("a folder");
    let long = [
        "--reference-spp",
        "1048576",
        "--size",
        "64x48",
        "--spp",
        "4",
        "--backend",
        "native",
    ];
    let child = render(out.path(), &[&long]).spawn().expect("it starts");
    wait_for("the report", || out.path().join("report.json").is_file());
    // The comparison follows.
    std::thread::sleep(Duration::from_millis(200));
    let said = interrupted(child);
    for words in ["interrupted", "image.png", "not compared"] {
        assert!(said.contains(words), "{words} in: {said}");
    }
    let files = fs::read_dir(out.path()).expect("the folder");
    let names: Vec<_> = files.map(|file| file.expect("a file").file_name()).collect();
    assert!(names.iter().any(|name| name == "image.png") && names.iter().all(|name| name != "reference.exr"));
}

#[test]
fn an_interruption_ends_what_only_computes() {
    for command in [
        &["verify", "--exhaustive"][..],
        &["bench", "generators", "--picture", "/dev/null"],
    ] {
        let child = xtask(command).spawn().expect("it starts");
        std::thread::sleep(Duration::from_millis(500));
        assert!(interrupted(child).contains("nothing was written"), "{command:?}");
    }
}

/// Set-up finds nothing but what would install the emulator, and that takes its time.
#[test]
fn an_interruption_ends_set_up() {
    let programs = tempfile::tempdir().expect("a folder");
    let started = programs.path().join("started");
    for name in ["apt-get", "env", "sudo"] {
        let does = format!("echo $$ > '{}'\nexec /bin/sleep 60", started.display());
        script(&programs.path().join(name), &does);
    }
    let mut command = xtask(&["qemu-run", "Cargo.toml", "--board", "versatilepb"]);
    let child = command.env("PATH", programs.path()).spawn().expect("it starts");
    let process = || fs::read_to_string(&started).unwrap_or_default().trim().to_owned();
    wait_for("the installation", || !process().is_empty());
    interrupted(child);
    wait_for("the end of the installation", || !is_running(&process()));
}

/// The compiler's own processes end, too.
#[test]
fn an_interruption_ends_a_build() {
    let target = tempfile::tempdir().expect("a folder");
    let mut command = xtask(&["size", "--no-install"]);
    command.env("CARGO_TARGET_DIR", target.path());
    let child = command.spawn().expect("it starts");
    let building = target.path().join("firmware").join("armv5te-none-eabi");
    wait_for("the build", || building.is_dir());
    interrupted(child);
    let uses_it = |process: &str| {
        let line = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&line).contains(&*target.path().to_string_lossy())
    };
    wait_for("the end of the build", || {
        let processes = fs::read_dir("/proc").expect("Linux");
        !processes
            .flatten()
            .any(|entry| uses_it(&entry.file_name().to_string_lossy()))
    });
}

#[test]
fn no_core_outlives_a_host_that_is_killed() {
    let running = Running::start(&[]);
    signal("KILL", &running.child.id().to_string());
    let cores = running.cores.clone();
    running.end();
    wait_for("the end of the cores", || {
        !cores.iter().any(|core| is_running(core))
    });
}

#[test]
fn the_collector_takes_cores_that_are_started_elsewhere() {
    let recipe = Recipe::by_default(Arithmetic::Precise, &cornell());
    let image = firmware::build(&toolchain(), Board::Versatilepb, &recipe).expect("an image");
    let elf = image.elf.to_str().expect("UTF-8");
    let out = tempfile::tempdir().expect("a folder");

    let mut collector = Command::new(program("collector"));
    collector
        .args(SMALL)
        .args(["--cores", "2", "--port", "0", "--out"])
        .arg(out.path());
    collector
        .current_dir(repository("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let collector = collector.spawn().expect("it starts");
    let boot = |core| out.path().join(format!("boot/core-{core}.boot"));
    wait_for("the boot blocks", || boot(1).is_file());
    let cores = [0, 1].map(|core| {
        let block = boot(core);
        xtask(&["qemu-run", elf, "--boot", block.to_str().expect("UTF-8")])
            .spawn()
            .expect("it starts")
    });
    let output = collector.wait_with_output().expect("its output");
    assert!(output.status.success(), "{}", said(&output));
    for core in cores {
        let output = core.wait_with_output().expect("its output");
        assert!(
            output.status.success(),
            "told to stop, a core ends well: {}",
            said(&output)
        );
    }
    let native = rendered(&[&SMALL, &["--backend", "native"]]);
    assert_eq!(report(out.path())["image_sha256"], native["image_sha256"]);

    let unbooted = xtask(&["qemu-run", elf]).output().expect("it starts");
    assert_eq!(
        unbooted.status.code(),
        Some(2),
        "the core's own exit code: {}",
        said(&unbooted)
    );
    assert!(said(&unbooted).contains("bad boot block"), "{}", said(&unbooted));
}

/// Hours of work do not go with a folder, and a folder that was only removed is made anew. The cores begin when it is gone.
#[test]
fn a_picture_whose_folder_is_gone_when_it_is_done_is_kept() {
    for in_the_way in [false, true] {
        let place = tempfile::tempdir().expect("a folder");
        let [out, state, boot] = ["out", "state", "boot"].map(|name| place.path().join(name));
        let mut collector = Command::new(program("collector"));
        collector.args(SMALL).args(["--cores", "1", "--port", "0"]);
        collector
            .args(["--host-address", "127.0.0.1", "--boot-dir"])
            .arg(&boot);
        collector.arg("--out").arg(&out).env("XDG_STATE_HOME", &state);
        collector.current_dir(repository("."));
        collector.stdout(Stdio::piped()).stderr(Stdio::piped());
        let collector = collector.spawn().expect("it starts");
        let block = || fs::read(boot.join("core-0.boot")).unwrap_or_default();
        wait_for("the boot block", || !block().is_empty());
        fs::remove_dir_all(&out).expect("it is there");
        if in_the_way {
            fs::write(&out, "").expect("a file");
        }
        let profile = Arithmetic::Precise;
        let _core = NativeFleet::start(&[block()], profile, profile.sampler()).expect("a thread");
        let output = collector.wait_with_output().expect("its output");
        let said = said(&output);
        let kept = if in_the_way {
            assert_eq!(output.status.code(), Some(1), "{said}");
            let (_, kept) = said.split_once("the results are in ").expect("where they are");
            kept.split_once(" instead").expect("where they are").0.into()
        } else {
            assert!(output.status.success(), "{said}");
            out
        };
        let report = fs::read_to_string(kept.join("report.json")).expect("a report");
        assert!(report.contains("\"complete\": true"), "{report}");
        assert!(kept.join("image.png").is_file() && kept.join("image.exr").is_file());
        assert!(kept.starts_with(if in_the_way { &state } else { place.path() }));
    }
}

/// With the variables that `cargo xtask toolchain` prints, plain cargo is enough.
#[test]
fn cargo_run_in_a_board_s_folder_runs_an_image() {
    let printed = xtask(&["toolchain", "--no-install"]).output().expect("it starts");
    assert!(printed.status.success(), "{}", said(&printed));
    let exports = String::from_utf8(printed.stdout).expect("UTF-8");
    for board in Board::ALL {
        let script = format!("{exports}\nexec cargo run --locked --profile firmware --example clock_test");
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(script);
        shell.current_dir(repository("firmware").join(board.name()));
        // The images of the other tests, which need not be built again.
        shell.env(
            "CARGO_TARGET_DIR",
            firmware::target_folder().expect("a target folder"),
        );
        let output = shell.output().expect("it starts");
        assert!(
            // How many it counts, within what reading the clock takes, is the image's own to judge.
            output.status.success() && said(&output).contains(", expected: 576000"),
            "{board}: {}",
            said(&output)
        );
    }
}
