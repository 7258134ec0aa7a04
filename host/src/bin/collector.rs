//! The collector alone, for cores that are started elsewhere: other QEMUs, other hosts, real boards.

use std::error::Error;
use std::net::{Ipv4Addr, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use host::collector::{self, CollectError};
use host::firmware::board::Board;
use host::fleet::session::{Route, Session};
use host::platform::console::{self, in_full, note, say};
use host::platform::interrupt;
use host::render::options::PictureOptions;
use host::render::{Finished, Job, RenderError, boot_blocks};

/// Collects a picture from cores that are started elsewhere.
///
/// Writes each core's boot block into a folder, to be loaded into the core's memory before it starts, and waits for the
/// cores to call. `cargo xtask qemu-run ELF --boot FILE` starts such a core.
#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    picture: PictureOptions,
    /// Board of the cores
    #[arg(long, value_enum, default_value_t)]
    board: Board,
    /// UDP port to listen on
    #[arg(long, value_name = "N", default_value_t = wire::DEFAULT_PORT)]
    port: u16,
    /// Folder for the boot blocks, core-0.boot and so on [default: boot in the folder for the results]
    #[arg(long, value_name = "DIR")]
    boot_dir: Option<PathBuf>,
    /// This host's IPv4 address as the cores see it; QEMU's user-mode network shows the loopback as 10.0.2.2
    #[arg(long, value_name = "A.B.C.D", default_value = "10.0.2.2")]
    host_address: Ipv4Addr,
    /// IPv4 address of core 0, core 1 having the next, and so on [default: each core is alone in QEMU's user-mode network]
    #[arg(long, value_name = "A.B.C.D")]
    first_address: Option<Ipv4Addr>,
}

fn main() -> ExitCode {
    let arguments = match console::arguments() {
        Ok(arguments) => arguments,
        Err(code) => return code,
    };
    match interrupt::watch() {
        Err(error) => fail(&error, ExitCode::FAILURE),
        Ok(interrupted) => match run(&arguments, interrupted) {
            Ok(finished) => match say(finished.summary) {
                Ok(()) => ExitCode::SUCCESS,
                Err(error) => error.end(),
            },
            Err(error @ RenderError::Interrupted(_)) => fail(&error, ExitCode::from(interrupt::EXIT_CODE)),
            Err(error) => fail(&error, ExitCode::FAILURE),
        },
    }
}

fn fail(error: &dyn Error, code: ExitCode) -> ExitCode {
    note(format!("error: {}", in_full(error)));
    code
}

fn run(arguments: &Arguments, interrupted: &std::sync::atomic::AtomicBool) -> Result<Finished, RenderError> {
    let job = Job::new(&arguments.picture)?;
    let socket: UdpSocket = collector::bind(Ipv4Addr::UNSPECIFIED, arguments.port)?;
    let port = socket.local_addr().map_err(CollectError::Socket)?.port();
    let session = job.session();
    let folder = arguments
        .boot_dir
        .clone()
        .unwrap_or_else(|| job.out().join("boot"));
    job.clear()?;
    write_boot_blocks(&folder, &session, &route(arguments, port))?;
    let (recipe, last) = (job.recipe().describe(), session.cores - 1);
    note(format!(
        "boot blocks: {}, core-0.boot to core-{last}.boot, for an image with {recipe}",
        folder.display()
    ));
    note(format!("waiting for {} cores on UDP port {port}", session.cores));
    job.collect_elsewhere(&session, &socket, arguments.board, interrupted)
}

fn route(arguments: &Arguments, port: u16) -> Route {
    let collector = arguments.host_address.octets();
    match arguments.first_address {
        Some(first) => Route {
            collector,
            port,
            first_address: first.octets(),
            shared: true,
        },
        None => Route {
            collector,
            ..Route::qemu(port)
        },
    }
}

fn write_boot_blocks(folder: &Path, session: &Session, route: &Route) -> Result<(), RenderError> {
    let failed = |cause| RenderError::Out {
        path: folder.to_owned(),
        cause,
    };
    std::fs::create_dir_all(folder).map_err(failed)?;
    for (core, block) in boot_blocks(session, route)?.iter().enumerate() {
        std::fs::write(folder.join(format!("core-{core}.boot")), block).map_err(failed)?;
    }
    Ok(())
}
