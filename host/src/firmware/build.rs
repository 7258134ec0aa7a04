//! Builds of images, by cargo.

use std::env;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use tracer::scene::{Capabilities, Capability};

use super::arithmetic::Arithmetic;
use super::board::Board;
use super::elf::{ElfError, ImageSize, compiler, measure};
use super::recipe::{Level, Recipe};
use crate::platform::file::write_whole;
use crate::platform::interrupt;
use crate::platform::setup::Toolchain;
use crate::platform::workspace::{self, NoWorkspace};

/// A finished image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// The ELF file.
    pub elf: PathBuf,
    /// How much memory it takes.
    pub size: ImageSize,
    /// The version of the compiler that made it, where it says so.
    pub compiler: Option<String>,
}

/// Why there is no image.
#[derive(Debug, thiserror::Error)]
pub enum FirmwareError {
    /// There are no sources to build it from.
    #[error(transparent)]
    Sources(#[from] NoWorkspace),
    /// A file could not be read or written.
    #[error("firmware: {} cannot be read or written", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// The build failed.
    #[error("firmware: the build for {board}, profile {profile} and needs `{needs}` failed:\n{output}")]
    Build {
        /// The board.
        board: Board,
        /// The profile.
        profile: Arithmetic,
        /// The needs.
        needs: String,
        /// What the compiler or the linker said.
        output: String,
    },
    /// The build of an example failed.
    #[error("firmware: the build of {names} for {board} failed:\n{output}")]
    Example {
        /// The board.
        board: Board,
        /// The examples.
        names: String,
        /// What the compiler or the linker said.
        output: String,
    },
    /// The ELF could not be read.
    #[error(transparent)]
    Elf(#[from] ElfError),
    /// There is floating point in the image.
    #[error(
        "firmware: {} contains floating-point routines ({}); an f32 or f64 has got into code that runs on the core. \
         Look for one in firmware/ and fixedmath/, and use fixedmath's types instead",
        path.display(), symbols.join(", ")
    )]
    Float {
        /// The image.
        path: PathBuf,
        /// The routines.
        symbols: Vec<String>,
    },
}

/// The image, one of each board's examples, whose tracer has one choice of another kind.
const CHOICE: &str = "choice";

/// Builds a board's image for `recipe` and checks it.
pub fn build(toolchain: &Toolchain, board: Board, recipe: &Recipe) -> Result<Image, FirmwareError> {
    let folder = target_folder()?;
    let images = folder.join("images");
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |cause| FirmwareError::File { path, cause }
    };
    fs::create_dir_all(&images).map_err(failed(&images))?;
    // Another build for another scene must not replace the ELF between the compiler and the copy.
    let lock_path = images.join(".lock");
    let lock = File::create(&lock_path).map_err(failed(&lock_path))?;
    lock.lock().map_err(failed(&lock_path))?;
    let mut command = cargo(toolchain, board, "build", recipe)?;
    let mut built = folder.join(board.target()).join("firmware").join(board.name());
    if let Some(format) = recipe.soft_float {
        command.args(["--example", format.example()]);
        built = example(board, format.example())?;
    }
    if let Some(choice) = recipe.choice {
        command
            .args(["--example", CHOICE])
            .env("TRACER_CHOICE", choice.word());
        built = example(board, CHOICE)?;
    }
    let output = interrupt::output(&mut command).map_err(failed(&toolchain.compiler.cargo))?;
    if !output.status.success() {
        return Err(FirmwareError::Build {
            board,
            profile: recipe.profile,
            needs: recipe.words(),
            output: String::from_utf8_lossy(&output.stderr).trim_end().to_owned(),
        });
    }
    let elf = images.join(recipe.file_name(board));
    let bytes = fs::read(&built).map_err(failed(&built))?;
    drop(lock);
    // An emulator or a debugger may just be reading the image that is there.
    write_whole(&elf, |file| file.write_all(&bytes))
        .map_err(|error| failed(&elf)(io::Error::other(error.cause)))?;
    let size = measure(board, &bytes).map_err(|fault| fault.of(&elf))?;
    if size.float_symbols.is_empty() || recipe.soft_float.is_some() {
        let compiler = compiler(&bytes);
        Ok(Image { elf, size, compiler })
    } else {
        Err(FirmwareError::Float {
            path: elf,
            symbols: size.float_symbols,
        })
    }
}

/// Builds examples of a board's crate, which need no scene, with a log if they shall have one, and says where their ELF files are.
pub fn build_examples(
    toolchain: &Toolchain,
    board: Board,
    names: &[String],
    log: Option<Level>,
) -> Result<Vec<PathBuf>, FirmwareError> {
    let recipe = Recipe {
        profile: Arithmetic::Precise,
        needs: Capabilities::PATHS,
        log,
        soft_float: None,
        choice: None,
    };
    let mut command = cargo(toolchain, board, "build", &recipe)?;
    for name in names {
        command.args(["--example", name]);
    }
    let output = interrupt::output(&mut command).map_err(|cause| FirmwareError::File {
        path: toolchain.compiler.cargo.clone(),
        cause,
    })?;
    if !output.status.success() {
        return Err(FirmwareError::Example {
            board,
            names: names.join(", "),
            output: String::from_utf8_lossy(&output.stderr).trim_end().to_owned(),
        });
    }
    let examples = names.iter().map(|name| example(board, name));
    Ok(examples.collect::<Result<_, _>>()?)
}

/// Where an example of a board's crate is, once it is built.
pub fn example(board: Board, name: &str) -> Result<PathBuf, NoWorkspace> {
    let folder = target_folder()?.join(board.target());
    Ok(folder.join("firmware").join("examples").join(name))
}

/// A cargo command line on a board's crate: `build`, or `clippy`.
pub fn cargo(
    toolchain: &Toolchain,
    board: Board,
    verb: &str,
    recipe: &Recipe,
) -> Result<Command, NoWorkspace> {
    let mut command = cargo_for(toolchain, verb, board.name(), board.target())?;
    command
        .env("TRACER_PROFILE", recipe.profile.name())
        .env("TRACER_NEEDS", recipe.words());
    // What is built to be measured has memory enough, and its tracer in the board's own package.
    let must_fit = recipe.soft_float.is_none() && recipe.choice.is_none();
    if must_fit && board.target().starts_with(ARMV5TE) && recipe.needs.has(Capability::Lights) {
        command.args(short_instructions());
        if recipe.log.is_some() || LARGE.into_iter().any(|need| recipe.needs.has(need)) {
            // A twelfth more cycles, for 800 to 1,600 bytes less. All other crates stay as they are, and are not built once more.
            let level = |package| format!("--config=profile.firmware.package.{package}.opt-level=2");
            command.args(["fixedmath", "runtime", "tracer", "versatilepb"].map(level));
        }
    }
    if let Some(level) = recipe.log {
        command.args(["--features", "log"]).env("DEFMT_LOG", level.name());
        // A line's place is that of a variable, of which less than full debug information says nothing.
        for package in ["node", "runtime"] {
            let setting = format!("profile.firmware.package.{package}.debug=\"full\"");
            command.args(["--config", &setting]);
        }
    }
    Ok(command)
}

/// A cargo command line on any crate of ours for any processor, whose `core` is built along.
pub fn cargo_for(
    toolchain: &Toolchain,
    verb: &str,
    package: &str,
    target: &str,
) -> Result<Command, NoWorkspace> {
    let mut command = Command::new(&toolchain.compiler.cargo);
    command
        .current_dir(workspace::root()?)
        .args([verb, "--locked", "--profile", "firmware"])
        .args(["--package", package, "--target", target])
        .args(["-Zbuild-std=core", "--target-dir"])
        .arg(target_folder()?)
        .envs(environment(toolchain, target))
        // Flags meant for the host's programs are not for a board's.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTUP_TOOLCHAIN");
    Ok(command)
}

/// What the names of targets begin with that run A32 and Thumb.
const ARMV5TE: &str = "armv5te";

/// What an image that looks for light has no room for, optimised as others are. With all else it fits, as a test sees to.
const LARGE: [Capability; 4] = [
    Capability::TwoSided,
    Capability::Vast,
    Capability::ManyLights,
    Capability::BallLights,
];

/// Crates of which nothing takes time but what is generic, and that is compiled in `runtime`. Nothing that a tracer calls is here: the
/// model of cycles knows A32 code.
const SMALL: [&str; 7] = [
    "core",
    "defmt",
    "heapless",
    "node",
    "smoltcp",
    "versatilepb",
    "wire",
];

/// Arguments that have the [`SMALL`] crates compiled to Thumb: two thirds of the bytes.
fn short_instructions() -> Vec<String> {
    let flags = SMALL.map(|package| {
        format!("--config=profile.firmware.package.{package}.rustflags=[\"-Ctarget-feature=+thumb-mode\"]")
    });
    [vec!["-Zprofile-rustflags".to_owned()], flags.to_vec()].concat()
}

/// The variables by which cargo finds the toolchain for a processor.
pub fn environment(toolchain: &Toolchain, target: &str) -> [(String, OsString); 4] {
    [
        ("RUSTC".to_owned(), toolchain.compiler.rustc.clone().into()),
        // What lets a stable compiler build its own library.
        ("RUSTC_BOOTSTRAP".to_owned(), "1".into()),
        (variable_of(target, "LINKER"), toolchain.linker.clone().into()),
        // Cargo's subcommands must be of the same toolchain.
        ("PATH".to_owned(), path_from(toolchain.compiler.cargo.parent())),
    ]
}

/// Where cargo looks for a target's own linker and the like.
fn variable_of(target: &str, what: &str) -> String {
    let target = target.replace('-', "_").to_uppercase();
    format!("CARGO_TARGET_{target}_{what}")
}

/// PATH with another folder before all others.
fn path_from(first: Option<&Path>) -> OsString {
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = first
        .map(Path::to_owned)
        .into_iter()
        .chain(env::split_paths(&path));
    // A folder that cannot be in a PATH was not found by one.
    env::join_paths(folders).unwrap_or(path)
}

/// Where firmware is built: a folder of its own, so that host builds and it do not wait for each other.
pub fn target_folder() -> Result<PathBuf, NoWorkspace> {
    let target = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    Ok(workspace::root()?.join(target).join("firmware"))
}
