//! One core under a debugger: what `cargo xtask gdb` does.
//!
//! The core is one of a real session: it has the boot block that a render would give it, and once it runs it finds a collector
//! that leases it work. What it renders is counted and thrown away. QEMU is no part of the terminal's process group, so that
//! Ctrl-C stops the core and not its emulator.

use std::ffi::OsString;
use std::io;
use std::net::{Ipv4Addr, TcpListener, UdpSocket};
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use super::folder::clear_cores;
use super::options::PictureOptions;
use super::{Job, Kind, RenderError};
use crate::collector::{self, CollectError};
use crate::firmware::board::Board;
use crate::firmware::{self, FirmwareError, Image};
use crate::fleet::session::{Route, Session};
use crate::fleet::{Core, QemuFleet, bound_to_this_process};
use crate::platform::console::note;
use crate::platform::setup::{self, Install, SetupError, Wanted};

/// What `cargo xtask gdb` takes.
#[derive(Clone, Debug, clap::Args)]
pub struct DebugOptions {
    /// The core that is started
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true)]
    pub core: u16,
    /// Board of the core
    #[arg(long, value_enum, default_value_t)]
    pub board: Board,
    /// The picture.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Say what is missing on this machine, and stop instead of installing it
    #[arg(long)]
    pub no_install: bool,
    /// More words for the debugger, which takes them when the core stands at `main`
    #[arg(last = true, value_name = "GDB-ARGS")]
    pub gdb: Vec<OsString>,
}

/// Starts one core, stopped, with a debugger that takes it to `main`; returns when the debugger ends, and ends the core.
pub fn debug(options: &DebugOptions) -> Result<ExitStatus, RenderError> {
    let job = Job::new(&options.picture)?;
    job.check_core(options.core)?;
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        gdb: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, Install::unless(options.no_install))?;
    let (Some(qemu), Some(gdb), Some(toolchain)) = (&tools.qemu, &tools.gdb, &tools.firmware) else {
        return Err(SetupError::StillMissing("one of QEMU, gdb and a compiler".to_owned()).into());
    };
    let Image { elf, .. } = job.image(toolchain, options.board, Kind::default())?;
    let port = free_port().map_err(|cause| RenderError::Debugger {
        program: gdb.clone(),
        cause,
    })?;
    let mut debugger = debugger(
        gdb,
        port,
        &elf,
        firmware::entry(&elf).map_err(FirmwareError::from)?,
    );
    debugger.args(&options.gdb);

    let socket = collector::bind(Ipv4Addr::LOCALHOST, 0)?;
    let route = Route::qemu(socket.local_addr().map_err(CollectError::Socket)?.port());
    let (session, number) = (job.session(), options.core);
    let boot_block = session.boot_block(number, &route).map_err(RenderError::TooLong)?;
    let core = Core {
        debugger: Some(port),
        ..Core::new(number, options.board, &elf, boot_block)
    };
    let folder = job.out().join("gdb");
    clear_cores(&folder).map_err(|cause| RenderError::Out {
        path: folder.clone(),
        cause,
    })?;
    let fleet = QemuFleet::start(qemu, &[core], &folder)?.debugged();
    let console = folder.join(format!("core-{number}.log"));
    note(format!("the core's console: {}", console.display()));
    attend(&session, &socket, fleet, debugger)
}

/// Runs the debugger in the foreground, and a collector beside it until it ends.
fn attend(
    session: &Session,
    socket: &UdpSocket,
    mut fleet: QemuFleet,
    mut debugger: Command,
) -> Result<ExitStatus, RenderError> {
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        let collection =
            scope.spawn(|| collector::collect(session, socket, &mut fleet, None, &ended, &mut drop));
        let status = debugger.status();
        ended.store(true, Ordering::Relaxed);
        match collection.join() {
            Ok(collection) => collection.map(drop)?,
            Err(panic) => std::panic::resume_unwind(panic),
        }
        status.map_err(|cause| RenderError::Debugger {
            program: debugger.get_program().into(),
            cause,
        })
    })
}

/// The debugger's command line: it goes to `entry` by itself, and does then what further words say.
fn debugger(gdb: &Path, port: u16, elf: &Path, entry: &str) -> Command {
    let mut command = bound_to_this_process(gdb);
    command.arg("--quiet").arg(elf);
    for order in [
        // Nobody would want to keep the core when they quit.
        "set confirm off",
        &format!("target remote 127.0.0.1:{port}"),
        &format!("tbreak {entry}"),
        "continue",
    ] {
        command.args(["-ex", order]);
    }
    command
}

/// A TCP port that nobody listens on.
fn free_port() -> io::Result<u16> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    Ok(listener.local_addr()?.port())
}
