//! QEMU's plugin that records a core's flow of execution: built when it is wanted, and tried before a core is started with it.

use std::env;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use cycles::flow::Isa;

use super::board::{Board, with_path};
use crate::platform::console::patiently;
use crate::platform::interrupt;
use crate::platform::workspace::{self, NoWorkspace};

/// The package of the plugin, and the library that it becomes.
const PACKAGE: &str = "cycles-plugin";
const LIBRARY: &str = "libcycles_plugin.so";
/// What the plugin says of itself when it is only to be tried.
const READY: &str = "cycles-plugin: ready";

/// Why nothing can be recorded.
#[derive(Debug, thiserror::Error)]
pub enum PluginError {
    /// There are no sources to build it from.
    #[error(transparent)]
    Sources(#[from] NoWorkspace),
    /// A program could not be started.
    #[error("cannot start {}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// The build failed.
    #[error("the plugin that counts cycles did not build:\n{0}")]
    Build(String),
    /// This QEMU takes no plugins.
    #[error(
        "{} was built without support for plugins, by which cycles are counted: take Debian's QEMU (apt-get install qemu-system-arm), or \
         one configured with --enable-plugins", .0.display()
    )]
    Unsupported(PathBuf),
    /// This QEMU's interface is another.
    #[error(
        "{} no longer serves version 1 of the interface for plugins, which the project's plugin is made for: take QEMU 7.2 of Debian 12. \
         It says: {said}", qemu.display()
    )]
    Interface {
        /// The emulator.
        qemu: PathBuf,
        /// What it says.
        said: String,
    },
    /// It does not load for another reason.
    #[error("{} does not load {}: {said}", qemu.display(), library.display())]
    Load {
        /// The emulator.
        qemu: PathBuf,
        /// The plugin.
        library: PathBuf,
        /// What was said.
        said: String,
    },
}

/// What is to be recorded of a core, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorder {
    /// The plugin's file.
    pub plugin: PathBuf,
    /// The addresses of the functions in which recording is on.
    pub entries: Vec<u32>,
    /// Whether each call of one is a flow of its own.
    pub each: bool,
    /// The file that the recording is written to when QEMU ends.
    pub file: PathBuf,
}

impl Recorder {
    /// The words that make QEMU record a core of this board.
    pub fn words(&self, board: Board) -> [OsString; 2] {
        let mut option = with_path("file=", &self.plugin);
        let isa = match board.isa() {
            Isa::Arm => "arm",
            Isa::Thumb => "thumb",
        };
        // Code is all that is below data: an image in soft float has more of it than a core.
        option.push(format!(",isa={isa},code_end={:#x}", board.dtcm().start));
        for entry in &self.entries {
            option.push(format!(",entry={entry:#x}"));
        }
        if self.each {
            option.push(",each=on");
        }
        option.push(with_path(",out=", &self.file));
        ["-plugin".into(), option]
    }
}

/// Builds the plugin, and has QEMU load it. Gives its file.
pub fn ready(qemu: &Path) -> Result<PathBuf, PluginError> {
    let library = build()?;
    let mut option = with_path("", &library);
    option.push(",probe=on");
    let mut command = Command::new(qemu);
    command.args(["-M", "none", "-nographic", "-plugin"]).arg(option);
    let output = interrupt::output(&mut command).map_err(|cause| PluginError::Start {
        program: qemu.to_owned(),
        cause,
    })?;
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    judge(qemu, &library, said)?;
    Ok(library)
}

/// What QEMU's words mean.
fn judge(qemu: &Path, library: &Path, said: String) -> Result<(), PluginError> {
    let qemu = qemu.to_owned();
    if said.contains(READY) {
        Ok(())
    } else if said.contains("invalid option") || said.contains("plugin interface not enabled") {
        Err(PluginError::Unsupported(qemu))
    } else if said.contains("requires API version") {
        Err(PluginError::Interface { qemu, said })
    } else {
        Err(PluginError::Load {
            qemu,
            library: library.to_owned(),
            said,
        })
    }
}

fn build() -> Result<PathBuf, PluginError> {
    let root = workspace::root()?;
    // The cargo that runs this program, whose builds are those of the plugin's library.
    let cargo = PathBuf::from(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let mut command = Command::new(&cargo);
    command
        .current_dir(&root)
        .args(["build", "--quiet", "--locked", "--release", "--package", PACKAGE]);
    let output = patiently("building QEMU's plugin", || interrupt::output(&mut command));
    let output = output.map_err(|cause| PluginError::Start {
        program: cargo,
        cause,
    })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
        return Err(PluginError::Build(said));
    }
    let target = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    Ok(root.join(target).join("release").join(LIBRARY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_qemu_says_of_a_plugin_is_understood() {
        let judged = |said: &str| {
            judge(Path::new("qemu"), Path::new("x.so"), said.to_owned()).map_err(|error| error.to_string())
        };
        assert_eq!(
            judged("cycles-plugin: ready\nqemu: Could not load plugin"),
            Ok(())
        );
        let without = judged("qemu: -plugin: invalid option").expect_err("no support");
        assert!(without.contains("--enable-plugins"), "{without}");
        let newer = "qemu: Could not load plugin x.so: plugin requires API version 1, but this QEMU supports only a minimum version of 2";
        let newer = judged(newer).expect_err("another interface");
        assert!(
            newer.contains("version 1") && newer.contains("minimum version of 2"),
            "{newer}"
        );
        let other = judged("x.so: cannot open shared object file").expect_err("no file");
        assert!(other.contains("cannot open shared object file"), "{other}");
    }

    #[test]
    fn paths_reach_the_plugin_with_their_commas() {
        let recorder = Recorder {
            plugin: "a,b.so".into(),
            entries: vec![0x100, 0x200],
            each: true,
            file: "out,1".into(),
        };
        let [_, option] = recorder.words(Board::Mps2An385);
        assert_eq!(
            option.to_str(),
            Some("file=a,,b.so,isa=thumb,code_end=0x20000000,entry=0x100,entry=0x200,each=on,out=out,,1")
        );
    }
}
