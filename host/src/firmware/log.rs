//! Cores' logs: `defmt`'s frames, made readable with what the image's ELF file says of them.
//!
//! A frame holds numbers only; texts, places and the meaning of the numbers are in the ELF. Frames end with a zero byte and have no
//! other, so whatever happens to one of them, the next is found.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fmt, fs, io};

use defmt_decoder::{Frame, Table};

use super::recipe::Level;
use crate::platform::workspace;

/// Why an image's log cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The ELF could not be read.
    #[error("cannot read {}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// The ELF says nothing of a log.
    #[error("{} was built without a log: build it with --log", path.display())]
    Without {
        /// The file.
        path: PathBuf,
    },
    /// What it says makes no sense.
    #[error("the log of {} cannot be decoded: {cause}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
}

/// What the frames of an image mean.
#[derive(Debug)]
pub struct Dictionary {
    table: Table,
    places: BTreeMap<u64, String>,
}

impl Dictionary {
    /// The dictionary in an ELF file.
    pub fn load(elf: &Path) -> Result<Self, LogError> {
        let path = || elf.to_owned();
        let unusable = |cause: &dyn fmt::Display| LogError::Table {
            path: path(),
            cause: cause.to_string(),
        };
        let bytes = fs::read(elf).map_err(|cause| LogError::File { path: path(), cause })?;
        let table = Table::parse(&bytes).map_err(|cause| unusable(&cause))?;
        let table = table.ok_or_else(|| LogError::Without { path: path() })?;
        let locations = table.get_locations(&bytes).map_err(|cause| unusable(&cause))?;
        let place = |(frame, location): (u64, defmt_decoder::Location)| {
            let file = workspace::source(&location.file);
            let file = file.unwrap_or(&location.file).display();
            (frame, format!("{file}:{}", location.line))
        };
        let places = locations.into_iter().map(place).collect();
        Ok(Self { table, places })
    }

    /// A frame's line; none where it is not a frame of this image's.
    fn line(&self, frame: &[u8]) -> Option<Line> {
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(frame);
        decoder.received(&[0]);
        let frame = decoder.decode().ok()?;
        Some(Line {
            time: frame.display_timestamp()?.to_string(),
            level: level_of(&frame)?,
            text: frame.display_message().to_string(),
            place: self.places.get(&frame.index()).cloned(),
        })
    }
}

/// One line of a core's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Seconds since the core's start, by its own clock.
    pub time: String,
    /// How grave it is.
    pub level: Level,
    /// What it says.
    pub text: String,
    /// File and line of the source, where the ELF has them.
    pub place: Option<String>,
}

/// What comes out of a core's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A line.
    Line(Line),
    /// So many bytes that are no frame: one was cut short, or damaged.
    Garbled(usize),
}

impl Entry {
    /// How grave it is. A frame that is lost is worth a warning.
    pub fn level(&self) -> Level {
        match self {
            Self::Line(line) => line.level,
            Self::Garbled(_) => Level::Warn,
        }
    }

    /// The entry as a line of the fleet's log.
    pub fn of_core(&self, core: u16) -> String {
        let level = self.level().name().to_uppercase();
        let (time, text, place) = match self {
            Self::Line(line) => (line.time.as_str(), line.text.clone(), line.place.as_deref()),
            Self::Garbled(bytes) => ("-", format!("{bytes} bytes here are no line of a log"), None),
        };
        let place = place.map(|place| format!("   ({place})")).unwrap_or_default();
        format!("{time:>12}  core {core}  {level:5}  {text}{place}")
    }
}

/// A core's log on its way: bytes in as they come, entries out as they are complete.
#[derive(Debug, Default)]
pub struct Stream {
    /// What has come of a frame that has not ended.
    rest: Vec<u8>,
}

impl Stream {
    /// The entries that end in `bytes`.
    pub fn take(&mut self, bytes: &[u8], dictionary: &Dictionary) -> Vec<Entry> {
        self.rest.extend_from_slice(bytes);
        let Some(end) = self.rest.iter().rposition(|&byte| byte == 0) else {
            return Vec::new();
        };
        let rest = self.rest.split_off(end + 1);
        let whole = std::mem::replace(&mut self.rest, rest);
        let frames = whole.split(|&byte| byte == 0).filter(|frame| !frame.is_empty());
        let entry = |frame: &[u8]| match dictionary.line(frame) {
            Some(line) => Entry::Line(line),
            None => Entry::Garbled(frame.len()),
        };
        frames.map(entry).collect()
    }

    /// What is left when no more bytes come: of a core that ended in the middle of a frame.
    pub fn end(&mut self) -> Option<Entry> {
        let left = std::mem::take(&mut self.rest).len();
        (left > 0).then_some(Entry::Garbled(left))
    }
}

/// The level of a frame; none where it is no line of a log.
fn level_of(frame: &Frame<'_>) -> Option<Level> {
    let name = frame.level()?;
    let mut all = <Level as clap::ValueEnum>::value_variants().iter();
    all.find(|level| level.name() == name.as_str()).copied()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An image with two lines, one of them with a number.
    pub(crate) fn dictionary() -> Dictionary {
        let entry = |tag: &str, text: &str| serde_json::json!({ "string": { "tag": tag, "string": text }, "raw_symbol": text });
        let table = serde_json::json!({
            "timestamp": entry("Timestamp", "{=u64:us}"),
            "entries": { "1": entry("Debug", "unit {=u32}"), "2": entry("Error", "gone"), "3": entry("Prim", "{=u8}") },
            "bitflags": {},
            "encoding": "Rzcobs",
        });
        Dictionary {
            table: serde_json::from_value(table).expect("a table"),
            places: [(1, "worker.rs:7".to_owned())].into(),
        }
    }

    /// A frame as a core sends it.
    pub(crate) fn frame(index: u16, micros: u64, arguments: &[u8]) -> Vec<u8> {
        let parts = [&index.to_le_bytes()[..], &micros.to_le_bytes(), arguments];
        [&[0], &rzcobs::encode(&parts.concat())[..], &[0]].concat()
    }

    fn unit(number: u32) -> Vec<u8> {
        frame(1, 1_234_000 + u64::from(number), &number.to_le_bytes())
    }

    fn said(entries: &[Entry]) -> Vec<String> {
        entries.iter().map(|entry| entry.of_core(2)).collect()
    }

    #[test]
    fn a_line_has_time_core_level_text_and_place() {
        let entries = Stream::default().take(&[unit(5), frame(2, 7, &[])].concat(), &dictionary());
        assert_eq!(
            said(&entries),
            [
                "    1.234005  core 2  DEBUG  unit 5   (worker.rs:7)",
                "    0.000007  core 2  ERROR  gone"
            ]
        );
        assert!(Level::Error < Level::Warn && entries[1].level() == Level::Error);
    }

    #[test]
    fn frames_may_come_in_pieces() {
        let (dictionary, mut stream) = (dictionary(), Stream::default());
        let bytes = [unit(1), unit(256), unit(0)].concat();
        let entries: Vec<Entry> = bytes
            .chunks(3)
            .flat_map(|piece| stream.take(piece, &dictionary))
            .collect();
        assert_eq!(entries, Stream::default().take(&bytes, &dictionary));
        assert_eq!(entries.len(), 3);
        assert_eq!(stream.end(), None);
    }

    #[test]
    fn a_frame_that_is_cut_short_is_told_and_the_next_is_read() {
        let (dictionary, mut stream) = (dictionary(), Stream::default());
        let cut = unit(0x0102_0304);
        // The core was killed in mid-frame, and started again.
        let bytes = [&unit(1)[..], &cut[..cut.len() - 4], &unit(2)].concat();
        let entries = stream.take(&bytes, &dictionary);
        assert!(
            matches!(entries[..], [Entry::Line(_), Entry::Garbled(bytes), Entry::Line(_)] if bytes == cut.len() - 5)
        );
        assert!(
            said(&entries)[1].contains("core 2  WARN "),
            "{:?}",
            said(&entries)
        );
        // It was not started again.
        assert_eq!(stream.take(&cut[..4], &dictionary), []);
        assert_eq!(stream.end(), Some(Entry::Garbled(3)));
    }

    #[test]
    fn frames_of_no_line_are_garbled() {
        let bytes = [frame(9, 0, &[]), frame(3, 0, &[1]), frame(2, 0, &[])].concat();
        let entries = Stream::default().take(&bytes, &dictionary());
        assert!(matches!(
            entries[..],
            [Entry::Garbled(_), Entry::Garbled(_), Entry::Line(_)]
        ));
    }

    proptest::proptest! {
        /// Whatever comes before it, a frame is read.
        #[test]
        fn garbage_does_not_end_the_decoding(garbage in proptest::collection::vec(0..=255u8, 1..300)) {
            let bytes = [&garbage[..], &unit(42)].concat();
            let entries = Stream::default().take(&bytes, &dictionary());
            let last = said(&entries).pop().expect("an entry");
            proptest::prop_assert!(last.contains("unit 42"), "{last}");
            let zeros = garbage.iter().all(|&byte| byte == 0);
            proptest::prop_assert_eq!(entries.len() == 1, zeros);
        }
    }
}
