//! `cargo xtask fuzz`: everything that is read from outside, against libFuzzer.

mod seeds;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::thread;

use anyhow::{Context, bail};
use clap::ValueEnum;
use host::firmware;
use host::platform::console::say;
use host::platform::interrupt;
use host::platform::setup::{self, Wanted};
use host::platform::workspace;

use crate::SetUp;
use crate::step::{cargo, shown, succeed};

/// Arguments of `fuzz`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The target to run, and to watch [default: all, two at a time]
    #[arg(value_enum)]
    target: Option<Target>,
    /// How long a target runs
    #[arg(long, value_name = "N", default_value_t = SECONDS)]
    seconds: u32,
    #[command(flatten)]
    set_up: SetUp,
}

/// How long a target runs unless it is said.
const SECONDS: u32 = 4;

/// Linux's folder in memory, for the targets whose readers want a file: a disk takes longer than they do.
const MEMORY: &str = "/dev/shm";

/// What is fuzzed: a program each, in `fuzz/targets`.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Target {
    /// Packets and boot blocks
    Wire,
    /// Scene texts
    SceneText,
    /// Scenes and cameras as cores read them
    SceneBlob,
    /// report.json and proof.json
    Report,
    /// OpenEXR files
    Picture,
    /// Recorded packets
    Capture,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let wanted = Wanted {
        cxx: true,
        ..Wanted::default()
    };
    setup::ensure(wanted, arguments.set_up.install())?;
    build()?;
    match arguments.target {
        Some(target) => shown(Folders::new()?.command(target, arguments.seconds)?)?,
        None => all(arguments.seconds)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Lints and builds the targets, and builds our own crates with what tells libFuzzer the ways they go.
fn build() -> anyhow::Result<()> {
    succeed(cargo(&[
        "clippy",
        "--release",
        "--package",
        "fuzz",
        "--",
        "--deny",
        "warnings",
    ])?)?;
    let mut command = cargo(&["build", "--release", "--package", "fuzz"])?;
    command.env("RUSTC_WORKSPACE_WRAPPER", workspace::root()?.join("fuzz/rustc"));
    succeed(command)
}

/// Runs all targets, two at a time.
fn all(seconds: u32) -> anyhow::Result<()> {
    let folders = &Folders::new()?;
    for pair in Target::value_variants().chunks(2) {
        thread::scope(|scope| {
            let runs: Vec<_> = pair
                .iter()
                .map(|&target| scope.spawn(move || folders.run(target, seconds)))
                .collect();
            let results = runs.into_iter().map(|run| run.join().expect("it does not panic"));
            results.collect::<anyhow::Result<Vec<()>>>().map(|_| ())
        })?;
    }
    Ok(())
}

/// Where things are.
struct Folders {
    root: PathBuf,
    /// The programs.
    programs: PathBuf,
    /// What fuzzing makes: seeds, and what it finds.
    made: PathBuf,
}

impl Folders {
    /// Writes the seeds.
    fn new() -> anyhow::Result<Self> {
        let firmware = firmware::target_folder()?;
        let target = firmware.parent().context("there is no target folder")?;
        let made = target.join("fuzz");
        seeds::write(&made.join("seeds"))?;
        Ok(Self {
            root: workspace::root()?,
            programs: target.join("release"),
            made,
        })
    }

    /// libFuzzer keeps what it finds in the first folder and reads the others.
    fn command(&self, target: Target, seconds: u32) -> anyhow::Result<Command> {
        let name = name(target);
        let [found, failing] = ["found", "failing"].map(|folder| self.made.join(folder).join(&name));
        fs::create_dir_all(&found)?;
        fs::create_dir_all(&failing)?;
        let mut command = Command::new(self.programs.join(format!("fuzz-{name}")));
        command.arg(format!("-max_total_time={seconds}"));
        command.args(["-timeout=20", "-max_len=8192"]);
        if Path::new(MEMORY).is_dir() {
            command.env("TMPDIR", MEMORY);
        }
        command.arg(option("-artifact_prefix=", &failing.join("")));
        command.arg(found);
        command.args(self.seeds(target, &name).into_iter().filter(|path| path.is_dir()));
        Ok(command)
    }

    fn seeds(&self, target: Target, name: &str) -> Vec<PathBuf> {
        let mut folders = vec![self.root.join("fuzz/corpus").join(name)];
        if let Target::SceneText = target {
            folders.extend(seeds::SCENES.map(|scenes| self.root.join(scenes)));
        } else {
            folders.push(self.made.join("seeds").join(name));
        }
        folders
    }

    /// Runs one target and says how many inputs it has seen.
    fn run(&self, target: Target, seconds: u32) -> anyhow::Result<()> {
        let name = name(target);
        let mut command = self.command(target, seconds)?;
        let output = interrupt::output(&mut command).with_context(|| format!("cannot start fuzz-{name}"))?;
        let said = String::from_utf8_lossy(&output.stderr);
        // But for its lines on each way that was new.
        let lines = said.lines().filter(|line| !line.starts_with('#'));
        let said = lines.collect::<Vec<_>>().join("\n");
        if !output.status.success() {
            bail!(
                "the target {name} has found an input that it fails on ({}):\n{}\nto see it again: {} FILE; once it is \
                 mended, keep the file in fuzz/corpus/{name}",
                output.status,
                said,
                self.programs.join(format!("fuzz-{name}")).display(),
            );
        }
        // "Done 123 runs in 11 second(s)"
        let inputs = said
            .lines()
            .find_map(|line| line.strip_prefix("Done ")?.split(' ').next());
        let inputs: u64 = inputs
            .and_then(|word| word.parse().ok())
            .with_context(|| format!("fuzz-{name} does not say what it did:\n{said}"))?;
        say(format!("  {name:12} {inputs:>10} inputs in {seconds} s"))?;
        Ok(())
    }
}

/// The target's name on the command line, as those of its program and its folders.
fn name(target: Target) -> String {
    let value = target.to_possible_value().expect("none is hidden");
    value.get_name().to_owned()
}

fn option(name: &str, path: &Path) -> std::ffi::OsString {
    let mut option = std::ffi::OsString::from(name);
    option.push(path);
    option
}
