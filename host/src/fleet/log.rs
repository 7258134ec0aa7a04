//! The fleet's log: what every core logged, in one file that people can read while the cores work.
//!
//! A core's frames arrive in a file of its own. All of these are looked into a few times a second, one after the other: lines of one
//! core are in order, and lines of different cores as close as those looks. Each core's time is by its own clock.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::core::Core;
use super::{FleetError, unusable};
use crate::firmware::Level;
use crate::firmware::log::{Dictionary, Entry, Stream};

/// Time between two looks into the cores' files.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// One core's frames.
#[derive(Debug)]
struct Source {
    core: u16,
    frames: File,
    stream: Stream,
    dictionary: Arc<Dictionary>,
}

impl Source {
    /// What has come since the last look.
    fn look(&mut self) -> io::Result<Vec<Entry>> {
        let mut bytes = Vec::new();
        self.frames.read_to_end(&mut bytes)?;
        Ok(self.stream.take(&bytes, &self.dictionary))
    }
}

/// The log of all cores that have one.
#[derive(Debug)]
pub(super) struct FleetLog {
    path: PathBuf,
    file: File,
    sources: Vec<Source>,
    dictionaries: HashMap<PathBuf, Arc<Dictionary>>,
    looked: Instant,
}

impl FleetLog {
    /// An empty log.
    pub(super) fn create(path: PathBuf) -> Result<Self, FleetError> {
        Ok(Self {
            file: File::create(&path).map_err(unusable(&path))?,
            path,
            sources: Vec::new(),
            dictionaries: HashMap::new(),
            looked: Instant::now(),
        })
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a core whose frames will be added to the file `frames`, which it empties.
    pub(super) fn add(&mut self, core: &Core, frames: &Path) -> Result<(), FleetError> {
        let empty = || fs::write(frames, []).and_then(|()| File::open(frames));
        let dictionary = match self.dictionaries.get(&core.elf) {
            Some(known) => Arc::clone(known),
            None => Arc::new(Dictionary::load(&core.elf)?),
        };
        self.dictionaries
            .insert(core.elf.clone(), Arc::clone(&dictionary));
        self.sources.push(Source {
            core: core.number,
            frames: empty().map_err(unusable(frames))?,
            stream: Stream::default(),
            dictionary,
        });
        Ok(())
    }

    /// Writes down what has come since the last look, if that was a while ago. Returns what users should see at once: warnings and
    /// errors.
    pub(super) fn look(&mut self) -> Vec<String> {
        if self.looked.elapsed() < LOOK_EVERY {
            return Vec::new();
        }
        self.looked = Instant::now();
        self.write(Source::look)
    }

    /// Writes down all that is left when no core runs any more, and returns the same.
    pub(super) fn end(&mut self) -> Vec<String> {
        self.write(|source| {
            let mut entries = source.look()?;
            entries.extend(source.stream.end());
            Ok(entries)
        })
    }

    /// A log that cannot be written is no reason to lose a picture: it ends, and says so.
    fn write(&mut self, look: impl Fn(&mut Source) -> io::Result<Vec<Entry>>) -> Vec<String> {
        self.try_to_write(look).unwrap_or_else(|error| {
            self.sources.clear();
            vec![format!("{}: {error}; the log ends here", self.path.display())]
        })
    }

    fn try_to_write(
        &mut self,
        look: impl Fn(&mut Source) -> io::Result<Vec<Entry>>,
    ) -> io::Result<Vec<String>> {
        let (mut text, mut grave) = (String::new(), Vec::new());
        for source in &mut self.sources {
            for entry in look(source)? {
                let line = entry.of_core(source.core);
                text.push_str(&line);
                text.push('\n');
                if entry.level() <= Level::Warn {
                    grave.push(line);
                }
            }
        }
        self.file.write_all(text.as_bytes())?;
        Ok(grave)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::firmware::board::Board;
    use crate::firmware::log::tests::{dictionary, frame};

    fn core(number: u16, elf: &Path) -> Core {
        Core::new(number, Board::Versatilepb, elf, Vec::new())
    }

    #[test]
    fn lines_of_all_cores_are_written_down_and_the_grave_ones_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let mut log = FleetLog::create(path("fleet.log")).expect("a log");
        log.dictionaries.insert(path("image.elf"), Arc::new(dictionary()));
        let files = [path("core-0.defmt"), path("core-1.defmt")];
        for (number, frames) in (0..).zip(&files) {
            log.add(&core(number, &path("image.elf")), frames)
                .expect("a core");
        }
        let send = |core: usize, bytes: &[u8]| {
            let file = File::options().append(true).open(&files[core]);
            file.and_then(|mut file| file.write_all(bytes))
                .expect("room for a frame");
        };
        let later = |log: &mut FleetLog| {
            let ago = Instant::now().checked_sub(LOOK_EVERY);
            log.looked = ago.expect("a machine that is up for longer");
            log.look()
        };

        send(0, &frame(1, 1_000_000, &[7, 0, 0, 0]));
        send(1, &frame(2, 2_000_000, &[]));
        assert_eq!(later(&mut log), ["    2.000000  core 1  ERROR  gone"]);
        assert_eq!(log.look(), [""; 0], "too soon to look again");

        let cut = frame(1, 3_000_000, &[8, 0, 0, 0]);
        send(0, &cut[..cut.len() - 1]);
        assert_eq!(later(&mut log), [""; 0], "it may go on");
        let grave = log.end();
        assert!(
            grave.len() == 1 && grave[0].contains("core 0  WARN "),
            "{grave:?}"
        );
        let text = fs::read_to_string(log.path()).expect("a log");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "    1.000000  core 0  DEBUG  unit 7   (worker.rs:7)");
        assert_eq!(
            lines[1..],
            ["    2.000000  core 1  ERROR  gone", grave[0].as_str()]
        );
    }

    #[test]
    fn an_image_that_is_none_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let frames = folder.path().join("core-0.defmt");
        let mut log = FleetLog::create(folder.path().join("fleet.log")).expect("a log");
        let error = log
            .add(&core(0, Path::new("no-such-image.elf")), &frames)
            .expect_err("no image");
        assert!(error.to_string().contains("no-such-image.elf"), "{error}");
        let shell = crate::platform::setup::program("sh").expect("a shell, which is an ELF, but has no log");
        let error = log.add(&core(0, &shell), &frames).expect_err("no log");
        assert!(error.to_string().contains("--log"), "{error}");
    }
}
