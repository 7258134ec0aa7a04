//! The cycles of a render: what was recorded of its cores' flows, and what that costs a sample.

use std::path::Path;

use cycles::blind_spot::add;
use cycles::file::{self, FileError};
use cycles::flow::{Flow, Recording};
use cycles::{BlindSpot, Cycles, blind_spots, cycles};

use super::report;
use crate::firmware::ElfError;
use crate::firmware::plugin::{self, PluginError, Recorder};
use crate::firmware::symbols::unit_renderer;
use crate::fleet::{Core, Fleet};

/// Why there are no cycles.
#[derive(Debug, thiserror::Error)]
pub enum CyclesError {
    /// There is nothing to record with.
    #[error(transparent)]
    Plugin(#[from] PluginError),
    /// It is not known where rendering begins in an image.
    #[error(transparent)]
    Image(#[from] ElfError),
    /// A core left no record.
    #[error(
        "core {core} left no record of its cycles, so there is no figure: {how}{said}\nRender again without counting cycles to see whether \
         it fails then, too"
    )]
    Died {
        /// The core.
        core: u16,
        /// How it ended.
        how: String,
        /// Its last lines.
        said: String,
    },
    /// What it left cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Something else ran among what was recorded.
    #[error(
        "core {core} met an exception between {before:#x} and {after:#x} while its cycles were counted, and what that cost nobody knows: \
         count them again"
    )]
    Interrupted {
        /// The core.
        core: u16,
        /// The instruction before.
        before: u32,
        /// The instruction after.
        after: u32,
    },
}

/// The cores whose flows are recorded.
#[derive(Clone, Debug)]
pub(super) struct Meter {
    cores: Vec<Core>,
    /// Cycles that an access to instruction memory takes longer.
    code_access: u32,
}

impl Meter {
    /// Has the flows of all cores recorded, in files of this folder.
    pub(super) fn attach(
        qemu: &Path,
        cores: &mut [Core],
        folder: &Path,
        code_access: u32,
    ) -> Result<Self, CyclesError> {
        let plugin = plugin::ready(qemu)?;
        for core in &mut *cores {
            core.recorder = Some(Recorder {
                plugin: plugin.clone(),
                entries: vec![unit_renderer(&core.elf)?],
                each: false,
                file: folder.join(format!("core-{}.flow", core.number)),
            });
        }
        let cores = cores.to_vec();
        Ok(Self { cores, code_access })
    }

    /// What was recorded, once the fleet has ended.
    pub(super) fn read(&self, fleet: &dyn Fleet) -> Result<Vec<Recording>, CyclesError> {
        let recorded = |core: &Core| {
            let recorder = core.recorder.as_ref()?;
            Some(read_core(core, &recorder.file, fleet))
        };
        self.cores.iter().filter_map(recorded).collect()
    }
}

fn read_core(core: &Core, file: &Path, fleet: &dyn Fleet) -> Result<Recording, CyclesError> {
    let number = core.number;
    if !file.exists() {
        let lines = fleet.last_output(number);
        return Err(CyclesError::Died {
            core: number,
            how: fleet.how_ended(number),
            said: lines.iter().map(|line| format!("\n    {line}")).collect(),
        });
    }
    let recording = file::read(file)?;
    if let Some((before, after)) = recording.segments.iter().find_map(Flow::interruption) {
        return Err(CyclesError::Interrupted {
            core: number,
            before,
            after,
        });
    }
    Ok(recording)
}

/// What the cycles may be wrong by, as shares of them.
pub(super) fn unseen(recordings: &[Recording]) -> Vec<report::BlindSpot> {
    let flows = || recordings.iter().flat_map(|recording| &recording.segments);
    let total = flows().map(|flow| cycles(flow, 0)).sum::<Cycles>().likely.max(1) as f64;
    let mut spots = Vec::new();
    for spot in flows().flat_map(blind_spots) {
        add(&mut spots, spot);
    }
    let share = |spot: BlindSpot| report::BlindSpot {
        what: spot.what.to_owned(),
        less: spot.less as f64 / total,
        more: spot.more as f64 / total,
    };
    spots.into_iter().map(share).collect()
}

/// Cycles of one sample: of so many samples in so many units. A unit that was rendered twice counts once.
pub(super) fn per_sample(
    meter: &Meter,
    recordings: &[Recording],
    units: u64,
    samples: u64,
) -> Option<[f64; 3]> {
    let calls: u64 = recordings.iter().map(Recording::calls).sum();
    if calls == 0 || samples == 0 {
        return None;
    }
    let flows = recordings.iter().flat_map(|recording| &recording.segments);
    let Cycles { low, likely, high } = flows.map(|flow| cycles(flow, meter.code_access)).sum();
    let once = units as f64 / calls as f64;
    Some([low, likely, high].map(|cycles| cycles as f64 * once / samples as f64))
}
