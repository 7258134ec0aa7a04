//! A render of which one core's packets are recorded: what `cargo xtask trace` does.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::options::{Backend, RenderOptions};
use super::{Capture, Finished, Job, RenderError};
use crate::fleet::capture::Tally;
use crate::fleet::{RESTARTS, capture_of};

/// What `cargo xtask trace` takes.
#[derive(Clone, Debug, clap::Args)]
pub struct TraceOptions {
    /// The core whose packets are recorded
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true)]
    pub core: u16,
    /// The render.
    #[command(flatten)]
    pub render: RenderOptions,
}

/// A render that was recorded.
#[derive(Debug)]
pub struct Traced {
    /// What was recorded, for people: of a fleet that failed the packets are worth a look, too.
    pub packets: Vec<String>,
    /// How the render ended.
    pub end: Result<Finished, RenderError>,
}

/// Renders a picture, and records a core's packets in `core-N.pcap` among the results. A core that was started again has a file
/// for each of its lives: `core-N.pcap`, `core-N.2.pcap` and so on.
pub fn trace(options: &TraceOptions, interrupted: &AtomicBool) -> Result<Traced, RenderError> {
    let job = Job::new(&options.render.picture)?;
    job.check_core(options.core)?;
    if options.render.backend != Backend::Qemu {
        return Err(RenderError::NoNetwork);
    }
    let capture = Capture {
        core: options.core,
        file: job.out().join(format!("core-{}.pcap", options.core)),
    };
    let lives = (0..=RESTARTS).map(|restarts| capture_of(&capture.file, restarts));
    let files: Vec<PathBuf> = lives.collect();
    let mut end = job.render(&options.render, Some(&capture), interrupted);
    let mut packets = Vec::new();
    for file in files.iter().filter(|file| file.exists()) {
        match Tally::of(file) {
            Ok(tally) => packets.push(describe(options.core, file, &tally)),
            Err(error) => end = end.and_then(|_| Err(error.into())),
        }
    }
    Ok(Traced { packets, end })
}

fn describe(core: u16, file: &Path, tally: &Tally) -> String {
    let file = file.display();
    let port = tally.port.unwrap_or(wire::DEFAULT_PORT);
    format!(
        "packets of core {core}: {file}\n{tally}\n\
         to look at them: wireshark -X lua_script:docs/sdp.lua -d udp.port=={port},spinnaker {file}",
    )
}
