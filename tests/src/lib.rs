//! What the whole-system tests share: the standard scene, its picture without a fleet in between, and the programs.

mod image_difference;

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use host::firmware;
use host::firmware::Level;
use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::Board;
use host::image::film::Film;
use host::image::picture::Estimate;
use host::oracle::direct;
use host::oracle::lockstep::{self, Paired};
use host::oracle::reference::{self, Job, Rendered};
use host::platform::setup::{self, Install, Toolchain, Wanted};
use host::platform::workspace;
use host::scene::{Integrator, Scene, compile};
use tempfile::TempDir;
use tracer::profile::Profile;
use tracer::unit::{Plan, Termination};

pub use image_difference::{equivalent, explained_by_noise};

/// Writes a program of a test: a script for `sh`. Another process writes it, because a program that any thread has open for writing while
/// another starts a process cannot be run until that has run its own.
///
/// # Panics
/// If it cannot be written.
pub fn script(path: &Path, text: &str) {
    let write = r#"printf '#!/bin/sh\n%s\n' "$2" > "$1" && chmod +x "$1""#;
    let status = Command::new("sh")
        .args(["-c", write, "sh"])
        .arg(path)
        .arg(text)
        .status();
    assert!(status.expect("a shell").success(), "{}", path.display());
}

/// A file of the repository.
///
/// # Panics
/// If the test does not run in it.
pub fn repository(path: &str) -> PathBuf {
    let root = workspace::root().unwrap_or_else(|error| panic!("{error}"));
    root.join(path)
}

/// The nine-sphere Cornell box.
///
/// # Panics
/// If the scene file has a fault.
pub fn cornell() -> Scene {
    Scene::load(&repository("scenes/cornell.toml")).expect("the standard scene is in order")
}

/// A plan with `P`'s own epsilon, roulette and seed 1.
pub fn plan<P: Profile>(width: u16, height: u16, spp: u32) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: spp.min(64) as u16,
        seed: 1,
        termination: Termination::Roulette,
        epsilon: P::EPSILON,
    }
}

/// The film that any fleet must end with, rendered unit by unit in this process.
pub fn film<P: Profile>(scene: &Scene, plan: &Plan) -> Film {
    let compiled = compile(scene, plan.width, plan.height, Integrator::Path);
    direct::film::<P>(&compiled, plan)
}

/// The film that any fleet must end with by `profile`'s own integrator and sampler.
pub fn film_by(profile: Arithmetic, scene: &Scene, plan: &Plan) -> Film {
    let compiled = compile(scene, plan.width, plan.height, profile.integrator());
    direct::film_as(profile, profile.sampler(), &compiled, plan)
}

/// `P`'s picture and its double's, sample by sample, with their noise.
pub fn pair<P: Profile<Random: Clone>>(scene: &Scene, plan: &Plan) -> Paired {
    lockstep::render::<P>(
        &compile(scene, plan.width, plan.height, Integrator::Path),
        plan,
        |_| (),
    )
}

/// `P`'s picture by paths as the film has it, with the noise of its samples.
pub fn estimate<P: Profile<Random: Clone>>(scene: &Scene, plan: &Plan) -> Estimate {
    estimate_by::<P>(scene, plan, Integrator::Path)
}

/// `P`'s picture by this integrator as the film has it, with the noise of its samples.
pub fn estimate_by<P: Profile<Random: Clone>>(
    scene: &Scene,
    plan: &Plan,
    integrator: Integrator,
) -> Estimate {
    let compiled = compile(scene, plan.width, plan.height, integrator);
    Estimate {
        picture: direct::film::<P>(&compiled, plan).picture(),
        ..lockstep::render::<P>(&compiled, plan, |_| ()).picture
    }
}

/// The independent reference of `scene`, with roulette.
pub fn reference(scene: &Scene, width: u16, height: u16, spp: u32) -> Rendered {
    let job = Job {
        width,
        height,
        spp,
        termination: reference::Termination::Roulette,
        seed: 1,
    };
    reference::render(scene, &job, |_| ())
}

/// The firmware's compiler, which must be there.
///
/// # Panics
/// If it is missing.
pub fn toolchain() -> Toolchain {
    let wanted = Wanted {
        firmware: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, Install::Forbidden).unwrap_or_else(|error| panic!("{error}"));
    tools.firmware.expect("set-up gives what is wanted")
}

/// The emulator, which must be there.
///
/// # Panics
/// If it is missing.
pub fn qemu() -> PathBuf {
    let wanted = Wanted {
        qemu: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, Install::Forbidden).unwrap_or_else(|error| panic!("{error}"));
    tools.qemu.expect("set-up gives what is wanted")
}

/// GNU's compiler of C++, which must be there.
///
/// # Panics
/// If it is missing.
pub fn gxx() -> PathBuf {
    let wanted = Wanted {
        gxx: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, Install::Forbidden).unwrap_or_else(|error| panic!("{error}"));
    tools.gxx.expect("set-up gives what is wanted")
}

/// A folder of a name that nobody expects: with a comma, which ends a value on QEMU's command line, and bytes that are no UTF-8.
///
/// # Panics
/// If there is no room for it.
pub fn oddly_named_folder() -> TempDir {
    let name = OsStr::from_bytes(b"-a, %d\n\xff\xfe ");
    let folder = tempfile::Builder::new().prefix(name).tempdir();
    folder.expect("a folder")
}

/// The linker of a machine without rustup, which must be there.
///
/// # Panics
/// If it is missing.
pub fn system_linker() -> PathBuf {
    let wanted = Wanted {
        system_linker: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, Install::Forbidden).unwrap_or_else(|error| panic!("{error}"));
    tools.system_linker.expect("set-up gives what is wanted")
}

/// One of the images that test a board, built, with a log if it shall have one.
///
/// # Panics
/// If it does not build.
pub fn test_image(board: Board, name: &str, log: Option<Level>) -> PathBuf {
    let elfs = firmware::build_examples(&toolchain(), board, &[name.to_owned()], log);
    elfs.unwrap_or_else(|error| panic!("{error}")).remove(0)
}

/// One of the workspace's programs, built as users build it.
///
/// # Panics
/// If it does not build.
pub fn program(name: &str) -> PathBuf {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    let folder = BUILT.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args([
            "build",
            "--quiet",
            "--release",
            "--package",
            "commands",
            "--package",
            "xtask",
            "--package",
            "host",
        ]);
        let status = cargo.current_dir(repository(".")).status().expect("cargo starts");
        assert!(status.success(), "the programs do not build");
        let firmware = firmware::target_folder().expect("tests run in the checkout");
        firmware
            .parent()
            .expect("it is in the target folder")
            .join("release")
    });
    folder.join(name)
}

/// A command of the project's, as `cargo xtask` starts it; what it says is kept.
pub fn xtask(arguments: &[&str]) -> Command {
    let mut command = Command::new(program("commands"));
    command.args(arguments).current_dir(repository("."));
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// What a program said, in whichever way.
pub fn said(output: &Output) -> String {
    let text = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    text.concat()
}
