//! Fleets of emulated cores, from the outside: what the command leaves in its folder, whatever happens to the cores.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
use host::firmware::arithmetic::Arithmetic;
use host::render::options::RenderOptions;
use host::render::{Finished, RenderError, render};
use host::scene::{MAX_SPHERES, Scene};
use serde_json::Value;
use tempfile::TempDir;
use tracer::profile::{Paper, Precise};
use whole_system::{cornell, film, film_by, plan, repository, script};

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: RenderOptions,
}

/// A render's folder, and how the render ended.
struct Done {
    out: TempDir,
    end: Result<Finished, RenderError>,
}

impl Done {
    fn report(&self) -> Value {
        if let Err(error) = &self.end {
            panic!("{error}");
        }
        read_report(self.out.path())
    }

    fn sha256(&self) -> String {
        self.report()["image_sha256"].as_str().unwrap().to_owned()
    }
}

fn read_report(out: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap()
}

fn options(out: &Path, flags: &str) -> RenderOptions {
    let scene = repository("scenes/cornell.toml");
    let words = [
        "render",
        scene.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--reference",
        "none",
    ];
    Flags::parse_from(words.into_iter().chain(flags.split_whitespace())).options
}

/// Renders the Cornell box with these flags; `meanwhile` is called with the folder once the fleet has been started.
fn run(flags: &str, meanwhile: impl FnOnce(&Path)) -> Done {
    let out = tempfile::tempdir().unwrap();
    let options = options(out.path(), flags);
    let end = thread::scope(|scope| {
        let job = scope.spawn(|| render(&options, &AtomicBool::new(false)));
        meanwhile(out.path());
        job.join().unwrap()
    });
    Done { out, end }
}

fn plain(flags: &str) -> Done {
    run(flags, |_| ())
}

/// Waits until core `core` has been started, and then until it has had time to work.
fn process_of(out: &Path, core: usize) -> String {
    let file = out.join(format!("cores/core-{core}.pid"));
    let start = Instant::now();
    loop {
        match std::fs::read_to_string(&file) {
            Ok(id) if id.ends_with('\n') => return id.trim().to_owned(),
            _ => assert!(
                start.elapsed() < Duration::from_secs(600),
                "{} does not appear",
                file.display()
            ),
        }
        thread::sleep(Duration::from_millis(20));
    }
}

/// By the shell's own `kill`: the program of that name is not on every machine.
fn kill(process: &str) {
    let status = Command::new("sh")
        .args(["-c", "kill -KILL \"$1\"", "sh", process])
        .status()
        .unwrap();
    assert!(status.success(), "kill {process}");
}

#[test]
fn every_fleet_ends_with_the_same_picture() {
    let expected = film_by(Arithmetic::Precise, &cornell(), &plan::<Precise>(64, 48, 16)).sha256();
    for flags in [
        "--cores 1",
        "--cores 2",
        "--cores 4",
        "--cores 4",
        "--backend native --cores 3",
        "--pixels sequential",
    ] {
        let found = plain(&format!("--size 64x48 --spp 16 {flags}")).sha256();
        assert_eq!(found, expected, "{flags}");
    }
    let other = plain("--size 64x48 --spp 16 --seed 2").sha256();
    assert_ne!(other, expected);
}

#[test]
fn paper_runs_on_the_emulated_core_as_on_the_host() {
    let expected = film::<Paper>(&cornell(), &plan::<Paper>(32, 24, 8)).sha256();
    assert_eq!(
        plain("--size 32x24 --spp 8 --profile paper --cores 2").sha256(),
        expected
    );
}

#[test]
fn odd_sizes_and_last_passes_are_covered() {
    let expected = film_by(Arithmetic::Precise, &cornell(), &plan::<Precise>(33, 25, 68)).sha256();
    assert_eq!(plain("--size 33x25 --spp 68 --cores 2").sha256(), expected);
}

/// As many spheres as a scene may have: boot block, decoded scene and stack have room for them.
#[test]
fn the_largest_scene_fits_a_core() {
    let mut text = String::from(
        "format = 1\n[camera]\nposition = [0, 0, 30]\ndirection = [0, 0, -1]\nplane_height = 0.8\n",
    );
    text += "[[sphere]]\nname = \"room\"\nhollow = true\ncentre = [0, 0, 0]\nradius = 50\nemission = [1, 1, 1]\ndiffuse = [0.5, 0.5, 0.5]\n";
    for i in 0..255 {
        let (x, y) = (f64::from(i % 17) * 1.3 - 10.4, f64::from(i / 17) * 1.3 - 9.1);
        // A material of its own for each is the most that a scene can take.
        let green = 0.3 + f64::from(i) / 1000.0;
        text += &format!(
            "[[sphere]]\nname = \"ball {i}\"\ncentre = [{x}, {y}, 0]\nradius = 0.6\ndiffuse = [0.3, {green}, 0.9]\n"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("many.toml");
    std::fs::write(&file, &text).unwrap();
    let scene = Scene::load(&file).unwrap();
    assert_eq!(scene.spheres.len(), MAX_SPHERES);
    let expected = film_by(Arithmetic::Precise, &scene, &plan::<Precise>(32, 24, 8)).sha256();
    let words = "render --size 32x24 --spp 8 --reference none --cores 1 --out";
    let words = words
        .split(' ')
        .chain([folder.path().to_str().unwrap(), file.to_str().unwrap()]);
    render(&Flags::parse_from(words).options, &AtomicBool::new(false)).unwrap();
    assert_eq!(read_report(folder.path())["image_sha256"], expected);
}

#[test]
fn stochastic_cores_bring_in_every_sample_they_were_asked_for() {
    let report = plain("--size 64x48 --spp 64 --pixels stochastic --cores 2").report();
    assert!(report["samples"].as_u64().unwrap() >= 64 * 48 * 64);
    assert_eq!(report["complete"], true);
}

/// The ceiling for the Cornell box with roulette, counted by the core's own clock.
#[test]
fn a_sample_costs_no_more_than_12_000_instructions() {
    let report = plain("--size 64x48 --spp 64").report();
    let cost = report["cost"]["instructions_per_sample"].as_f64().unwrap();
    println!("{cost:.1} instructions a sample");
    assert!(cost > 1000.0, "6.7 rays against nine spheres cannot cost {cost}");
    assert!(cost <= 12_000.0, "{cost}");
    assert_eq!(report["packets"]["lost"], 0);
}

#[test]
fn a_killed_core_costs_time_and_nothing_else() {
    let expected = film_by(Arithmetic::Precise, &cornell(), &plan::<Precise>(128, 96, 64)).sha256();
    let done = run("--size 128x96 --spp 64 --cores 3", |out| {
        let process = process_of(out, 1);
        thread::sleep(Duration::from_millis(1000));
        kill(&process);
    });
    assert_eq!(done.sha256(), expected);
    let report = done.report();
    let fault = report["per_core"][1]["fault"].as_str().unwrap();
    assert!(
        fault.contains("signal 9"),
        "it was killed while it worked: {fault}"
    );
    let restarts = &report["per_core"][1]["restarts"];
    assert_eq!(restarts, 0, "somebody wanted it dead");
}

#[test]
fn when_all_cores_are_gone_it_ends_soon_names_them_and_keeps_the_picture() {
    let mut killed = Instant::now();
    let done = run("--size 256x192 --spp 256 --cores 2", |out| {
        let processes = [process_of(out, 0), process_of(out, 1)];
        thread::sleep(Duration::from_millis(1500));
        processes.iter().for_each(|process| kill(process));
        killed = Instant::now();
    });
    assert!(
        killed.elapsed() < Duration::from_secs(10),
        "{:?}",
        killed.elapsed()
    );
    let message = done.end.as_ref().unwrap_err().to_string();
    for words in [
        "all cores have ended",
        "core 0",
        "core 1",
        "signal 9",
        "image.png",
    ] {
        assert!(message.contains(words), "{words} in: {message}");
    }
    let report = read_report(done.out.path());
    assert_eq!(report["complete"], false);
    assert!(report["samples"].as_u64().unwrap() > 0);
    assert!(done.out.path().join("image.png").exists());
}

/// The command as a user types it.
fn xtask(arguments: &[&str]) -> (bool, String) {
    let cargo = std::env::var_os("CARGO").map_or_else(|| PathBuf::from("cargo"), PathBuf::from);
    let output = Command::new(cargo)
        .arg("xtask")
        .args(arguments)
        .current_dir(repository("."))
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr]
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
        .concat();
    (output.status.success(), text)
}

#[test]
fn bad_flags_have_one_clear_error_each() {
    let taken = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for (arguments, words) in [
        (&["--spp", "0"][..], &["--spp", "multiple of 4"][..]),
        (&["--spp", "6"], &["--spp", "multiple of 4"]),
        (&["--size", "0x0"], &["--size", "0x0"]),
        (&["--cores", "0"], &["--cores", "0"]),
        (&["--out", "/proc/nowhere"], &["/proc/nowhere", "--out"]),
        (&["--port", port.as_str()], &[port.as_str(), "--port"]),
        (&["no-such-scene.toml"], &["no-such-scene.toml"]),
        (&["--log", "debug"], &["--log", "--backend native"]),
        (&["--board", "z80"], &["z80", "versatilepb, mps2-an385"]),
    ] {
        let (success, text) = xtask(&[&["render", "--backend", "native"], arguments].concat());
        assert!(!success, "{arguments:?}: {text}");
        for word in words {
            assert!(text.contains(word), "{arguments:?} should say {word}: {text}");
        }
        assert!(!text.contains("panicked"), "{text}");
    }
}

#[test]
fn without_its_programs_it_says_how_to_get_them_and_stops() {
    // Built by cargo, then run where apt-get is all that can be found.
    let (success, text) = xtask(&["--version"]);
    assert!(success, "{text}");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| repository("target"), PathBuf::from);
    let bare = tempfile::tempdir().unwrap();
    let apt = bare.path().join("apt-get");
    script(&apt, "exit 99");
    let output = Command::new(target.join("release/commands"))
        .args([
            "render",
            "--no-install",
            "--out",
            bare.path().join("out").to_str().unwrap(),
        ])
        .current_dir(repository("."))
        .env("PATH", bare.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success());
    for words in [
        "apt-get install",
        "qemu-system-arm",
        "Nothing was installed",
        "--no-install",
    ] {
        assert!(text.contains(words), "{words} in: {text}");
    }
}
