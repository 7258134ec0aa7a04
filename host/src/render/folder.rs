//! The folder for results: one render at a time has it, and what it holds is of one render.
//!
//! A new set of results is written beside the old one and takes its place when it is whole. Where the folder cannot take it, the
//! set goes elsewhere: what took hours to render is not lost to a full disk.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use etcetera::base_strategy::{BaseStrategy, Xdg};
use tempfile::TempDir;

use super::RenderError;
use crate::platform::console::note;
use crate::platform::file::{HALF_WRITTEN, OUR_FOLDER, WriteError, sync_folder};
use crate::platform::interrupt::LastAct;

/// What a render writes. The report comes last: where there is one, the files beside it are those that it is about.
const RESULTS: [&str; 5] = [
    PICTURE,
    "image.png",
    "reference.exr",
    "difference.png",
    "report.json",
];
/// The result that is worth most.
const PICTURE: &str = "image.exr";
/// Folders in which a fleet's files are, and the boot blocks of cores from elsewhere.
const OF_CORES: [&str; 2] = ["cores", "boot"];
/// Endings of the files of a core.
const OF_CORE: [&str; 6] = ["boot", "log", "defmt", "pid", "pcap", "flow"];

/// A folder that no other render writes to.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// Held by the system for as long as this process lives.
    lock: File,
}

/// What has become of results.
#[derive(Debug)]
pub(super) enum Written<T> {
    /// They are where they should be.
    Here(T),
    /// They are not.
    Elsewhere {
        /// Why, and what else there is to say of it.
        why: String,
        /// Where they are.
        folder: PathBuf,
    },
}

impl Folder {
    /// Makes the folder if need be, and sees to it that nobody else writes there.
    pub(super) fn open(path: PathBuf) -> Result<Self, RenderError> {
        let out = |cause| RenderError::Out {
            path: path.clone(),
            cause,
        };
        fs::create_dir_all(&path).map_err(out)?;
        let lock = lock(&path).map_err(out)?;
        let lock = lock.ok_or_else(|| RenderError::Busy(path.clone()))?;
        tempfile::tempfile_in(&path).map_err(out)?;
        Ok(Self { path, lock })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Removes what earlier runs left of their cores, and of files that they did not finish. For a run that is about to start.
    pub(super) fn clear(&self) -> Result<(), RenderError> {
        let clear = || -> io::Result<()> {
            remove(&self.path, |name| {
                name.starts_with(HALF_WRITTEN) || is_core_s(name, &["pcap"])
            })?;
            OF_CORES
                .iter()
                .try_for_each(|folder| clear_cores(&self.path.join(folder)))
        };
        clear().map_err(|cause| RenderError::Out {
            path: self.path.clone(),
            cause,
        })
    }

    /// Writes a new set of results by `write`, which is given the folder for it and writes the most precious first. Results of the old set
    /// that the new one lacks are removed. Where all of that fails, the set goes to the first of `places` that takes it.
    pub(super) fn replace<T>(
        &self,
        places: &[PathBuf],
        write: impl Fn(&Path) -> Result<T, WriteError>,
    ) -> Result<Written<T>, WriteError> {
        let failed = match self.replace_here(&write) {
            Ok(value) => return Ok(Written::Here(value)),
            Err(failed) => failed,
        };
        let (mut why, mut part) = (failed.to_string(), None);
        for place in places {
            let written = self.fresh(place).and_then(|folder| match write(folder.path()) {
                Ok(_) => Ok(folder.keep()),
                Err(error) => {
                    if folder.path().join(PICTURE).is_file() {
                        part = part.take().or(Some(folder.keep()));
                    }
                    Err(error)
                }
            });
            match written {
                Ok(folder) => return Ok(Written::Elsewhere { why, folder }),
                Err(error) => why = format!("{why}\n{error}"),
            }
        }
        let cause = format!("{}\n{why}", failed.cause);
        part.map(|folder| Written::Elsewhere { why, folder })
            .ok_or(WriteError { cause, ..failed })
    }

    fn replace_here<T>(&self, write: impl Fn(&Path) -> Result<T, WriteError>) -> Result<T, WriteError> {
        let failed = |cause: io::Error| WriteError {
            path: self.path.clone(),
            cause: cause.to_string(),
        };
        let _lock = self.lock_again().map_err(failed)?;
        let staged = tempfile::Builder::new()
            .prefix(HALF_WRITTEN)
            .tempdir_in(&self.path)
            .map_err(failed)?;
        let half = staged.path().to_owned();
        let _removes = LastAct::new(move || drop(fs::remove_dir_all(&half)));
        let value = write(staged.path()).map_err(|error| WriteError {
            path: self.path.join(error.path.file_name().unwrap_or_default()),
            cause: error.cause,
        })?;
        self.put(staged.path()).map_err(failed)?;
        Ok(value)
    }

    /// Gives the files in `staged` the places of the old ones.
    fn put(&self, staged: &Path) -> io::Result<()> {
        let is_new = |name: &str| staged.join(name).exists();
        // Without its report an old set does not pass for a whole one.
        let old = RESULTS.into_iter().rev();
        for name in old.filter(|name| *name == "report.json" || !is_new(name)) {
            absent_is_fine(fs::remove_file(self.path.join(name)))?;
        }
        for name in RESULTS.into_iter().filter(|name| is_new(name)) {
            fs::rename(staged.join(name), self.path.join(name))?;
        }
        sync_folder(&self.path)
    }

    /// Makes the folder anew where somebody has removed it, unless that somebody is a render who has it now.
    fn lock_again(&self) -> io::Result<Option<File>> {
        let held = self.lock.metadata()?;
        let is_same = |there: fs::Metadata| (there.dev(), there.ino()) == (held.dev(), held.ino());
        if fs::metadata(&self.path).is_ok_and(is_same) {
            return Ok(None);
        }
        fs::create_dir_all(&self.path)?;
        let busy = || io::Error::other("it was removed, and another render has made it anew");
        lock(&self.path)?.ok_or_else(busy).map(Some)
    }

    /// A new folder in `place`, named after this one.
    fn fresh(&self, place: &Path) -> Result<TempDir, WriteError> {
        let name = self.path.file_name().unwrap_or_default();
        let mut prefix = name.to_owned();
        prefix.push("-");
        let make = || {
            fs::create_dir_all(place)?;
            tempfile::Builder::new().prefix(&prefix).tempdir_in(place)
        };
        make().map_err(|cause| WriteError {
            path: place.to_owned(),
            cause: cause.to_string(),
        })
    }
}

/// Where results go that their folder does not take: among the user's files, else among temporary ones.
pub(super) fn places() -> Vec<PathBuf> {
    let state = Xdg::new().ok().and_then(|user| user.state_dir());
    let state = state.map(|state| state.join(OUR_FOLDER));
    state.into_iter().chain([std::env::temp_dir()]).collect()
}

/// Removes the files of cores from their folder, and the folder if that was all.
pub(super) fn clear_cores(folder: &Path) -> io::Result<()> {
    remove(folder, |name| name == "fleet.log" || is_core_s(name, &OF_CORE))?;
    match fs::remove_dir(folder) {
        Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
        result => absent_is_fine(result),
    }
}

/// Whether a file is of a core: `core-`, its number, and such an ending, before which there may be the number of its life.
fn is_core_s(name: &str, endings: &[&str]) -> bool {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let Some((numbers, ending)) = name.strip_prefix("core-").and_then(|name| name.rsplit_once('.')) else {
        return false;
    };
    endings.contains(&ending) && numbers.split('.').count() < 3 && numbers.split('.').all(is_number)
}

/// Removes what is in a folder under the names that are ours.
fn remove(folder: &Path, is_ours: impl Fn(&str) -> bool) -> io::Result<()> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    for entry in entries {
        let entry = entry?;
        if !entry.file_name().to_str().is_some_and(&is_ours) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Locks a folder; nothing if another process has it. The system lets go of a lock whose process has ended, however it did.
fn lock(folder: &Path) -> io::Result<Option<File>> {
    let file = File::open(folder)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(cause)) => {
            let name = folder.display();
            note(format!(
                "warning: {name} cannot be locked ({cause}): see to it that no other render writes there"
            ));
            Ok(Some(file))
        }
    }
}

fn absent_is_fine(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::collections::BTreeSet;

    use super::*;

    fn names(folder: &Path) -> BTreeSet<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let name = |entry: io::Result<fs::DirEntry>| entry.expect("a file").file_name();
        entries
            .map(|entry| name(entry).into_string().expect("UTF-8"))
            .collect()
    }

    fn put(folder: &Path, names: &[&str]) {
        fs::create_dir_all(folder).expect("a folder");
        for name in names {
            fs::write(folder.join(name), name).expect("a file");
        }
    }

    /// A set of results of these names, each of whose files holds `text`.
    fn set(text: &str, names: &[&str]) -> impl Fn(&Path) -> Result<(), WriteError> {
        move |folder| {
            names.iter().try_for_each(|name| {
                let path = folder.join(name);
                fs::write(&path, text).map_err(|cause| WriteError {
                    path,
                    cause: cause.to_string(),
                })
            })
        }
    }

    /// The same set as from a disk that gets full after `room` files, the first time.
    fn full_at_first<'a>(
        room: usize,
        text: &'a str,
        names: &'a [&'a str],
    ) -> impl Fn(&Path) -> Result<(), WriteError> + 'a {
        let is_first = Cell::new(true);
        move |folder| {
            if !is_first.replace(false) {
                return set(text, names)(folder);
            }
            set(text, &names[..room])(folder)?;
            Err(WriteError {
                path: folder.join(names[room]),
                cause: io::Error::from(ErrorKind::StorageFull).to_string(),
            })
        }
    }

    fn holds(folder: &Path, name: &str) -> String {
        fs::read_to_string(folder.join(name)).expect("a file")
    }

    #[test]
    fn one_render_at_a_time_has_a_folder_and_leaves_it_when_it_ends() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path().join("out");
        let first = Folder::open(path.clone()).expect("nobody has it");
        let refused = Folder::open(path.clone()).expect_err("it is taken").to_string();
        assert!(
            refused.contains(path.to_str().expect("UTF-8")) && refused.contains("--out"),
            "{refused}"
        );
        drop(first);
        Folder::open(path).expect("it is free");
    }

    #[test]
    fn a_new_set_takes_the_place_of_the_old_one_and_of_nothing_else() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path();
        put(path, &RESULTS);
        put(path, &["notes.txt", "image-old.png"]);
        let folder = Folder::open(path.to_owned()).expect("a folder");
        let new = ["image.exr", "image.png", "report.json"];
        let written = folder.replace(&[], set("new", &new)).expect("it is written");
        assert!(matches!(written, Written::Here(())));
        assert_eq!(
            names(path),
            [&new[..], &["notes.txt", "image-old.png"]]
                .concat()
                .into_iter()
                .map(str::to_owned)
                .collect()
        );
        assert!(new.iter().all(|name| holds(path, name) == "new"));
    }

    #[test]
    fn a_full_disk_leaves_the_old_set_as_it_was_and_the_new_one_elsewhere() {
        let place = tempfile::tempdir().expect("a folder");
        let (path, other) = (place.path().join("out"), place.path().join("other"));
        put(&path, &RESULTS);
        let folder = Folder::open(path.clone()).expect("a folder");
        let places = [place.path().join("out/report.json/no-folder"), other.clone()];
        let written = folder.replace(&places, full_at_first(1, "new", &RESULTS));
        let Ok(Written::Elsewhere { why, folder }) = written else {
            panic!("{written:?}");
        };
        assert!(folder.starts_with(&other), "{}", folder.display());
        assert!(why.contains("out/image.png: no storage space"), "{why}");
        assert!(RESULTS.iter().all(|name| holds(&folder, name) == "new"));
        assert!(RESULTS.iter().all(|name| holds(&path, name) == *name));
        assert_eq!(names(&path).len(), RESULTS.len());
    }

    /// The picture is worth keeping alone; but where nothing could be kept, it is not said that something was.
    #[test]
    fn of_a_set_that_fits_nowhere_the_picture_is_kept() {
        let place = tempfile::tempdir().expect("a folder");
        let (path, other) = (place.path().join("out"), place.path().join("other"));
        let folder = Folder::open(path.clone()).expect("a folder");
        let always_full = |room: usize| move |folder: &Path| full_at_first(room, "new", &RESULTS)(folder);
        let written = folder.replace(std::slice::from_ref(&other), always_full(1));
        let Ok(Written::Elsewhere { why, folder: kept }) = written else {
            panic!("{written:?}");
        };
        assert_eq!(names(&kept), BTreeSet::from([PICTURE.to_owned()]));
        assert_eq!(why.matches("no storage space").count(), 2, "{why}");

        let failed = folder.replace(std::slice::from_ref(&other), always_full(0));
        let message = failed.expect_err("nothing fits").to_string();
        assert_eq!(message.matches("no storage space").count(), 3, "{message}");
        assert!(names(&path).is_empty() && names(&other).len() == 1);
    }

    #[test]
    fn a_folder_that_was_removed_is_made_anew_unless_another_render_has_done_so() {
        let place = tempfile::tempdir().expect("a folder");
        let (path, other) = (place.path().join("out"), place.path().join("other"));
        let folder = Folder::open(path.clone()).expect("a folder");
        fs::remove_dir_all(&path).expect("it is there");
        let written = folder.replace(&[], set("new", &RESULTS)).expect("it is written");
        assert!(matches!(written, Written::Here(())));
        assert_eq!(names(&path).len(), RESULTS.len());

        fs::remove_dir_all(&path).expect("it is there");
        let _others = Folder::open(path.clone()).expect("nobody has the new one");
        let written = folder.replace(std::slice::from_ref(&other), set("new", &RESULTS));
        assert!(matches!(written, Ok(Written::Elsewhere { .. })), "{written:?}");
        assert!(names(&path).is_empty());
    }

    #[test]
    fn what_earlier_runs_left_of_their_cores_goes_and_nothing_else() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path();
        let users = [
            "core-1.txt",
            "core-.log",
            "core-x.log",
            "fleet.log.bak",
            "core-1.2.3.log",
        ];
        put(path, &RESULTS);
        put(
            path,
            &[
                "core-0.pcap",
                "core-12.3.pcap",
                "core-0.log",
                "notes.pcap",
                ".half-written-image",
            ],
        );
        put(&path.join(".half-written-x"), &["image.exr"]);
        put(
            &path.join("cores"),
            &[
                "fleet.log",
                "core-0.boot",
                "core-7.log",
                "core-7.defmt",
                "core-7.pid",
            ],
        );
        put(&path.join("boot"), &["core-0.boot"]);
        put(&path.join("boot"), &users);
        Folder::open(path.to_owned())
            .expect("a folder")
            .clear()
            .expect("it is cleared");
        let kept: BTreeSet<String> = [&RESULTS[..], &["core-0.log", "notes.pcap", "boot"]]
            .concat()
            .into_iter()
            .map(str::to_owned)
            .collect();
        assert_eq!(names(path), kept);
        assert_eq!(
            names(&path.join("boot")),
            users.into_iter().map(str::to_owned).collect()
        );
    }
}
