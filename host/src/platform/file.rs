//! Files that appear whole or not at all, also where the machine goes down meanwhile.

use std::fs::{File, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use crate::platform::interrupt::LastAct;

/// What files are called that are not finished.
pub const HALF_WRITTEN: &str = ".half-written-";

/// What our folders among the user's are called.
pub(crate) const OUR_FOLDER: &str = "fixed-point-path-tracer";

/// A result that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}; give another --out or make room", path.display())]
pub struct WriteError {
    /// The file that is not there now, or is there as it was before.
    pub path: PathBuf,
    /// What the system or the encoder said.
    pub cause: String,
}

/// Writes the file at `path` through `write`: first beside it under a temporary name, then renamed over it.
///
/// The folder must exist. Whoever looks at `path`, also after a crash of the machine, sees the old file or the new one: the
/// new one's bytes are on the disk before its name is.
pub fn write_whole<E: ToString>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> Result<(), E>,
) -> Result<(), WriteError> {
    let error = |cause: String| WriteError {
        path: path.to_owned(),
        cause,
    };
    let system = |source: io::Error| error(source.to_string());
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    // The permissions any other new file would get; the umask still applies.
    let mut file = tempfile::Builder::new()
        .prefix(HALF_WRITTEN)
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(folder)
        .map_err(system)?;
    let temporary = file.path().to_owned();
    // If it is there no more, it has got its name.
    let _removes = LastAct::new(move || drop(std::fs::remove_file(&temporary)));
    let mut writer = BufWriter::new(file.as_file_mut());
    write(&mut writer).map_err(|cause| error(cause.to_string()))?;
    writer.flush().map_err(system)?;
    drop(writer);
    file.as_file().sync_all().map_err(system)?;
    file.persist(path).map_err(|failed| system(failed.error))?;
    sync_folder(folder).map_err(system)
}

/// Sees to it that the names in a folder are on the disk.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        // Some file systems cannot do that with folders, and have nothing to offer instead.
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        write_whole(&path, |writer| writer.write_all(b"old")).unwrap();
        let failure = write_whole(&path, |writer| {
            writer.write_all(b"ne").unwrap();
            Err("the encoder gave up")
        });
        assert!(failure.unwrap_err().to_string().contains("the encoder gave up"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            1,
            "the temporary file stayed behind"
        );
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("image.png");
        let message = write_whole(&path, |writer| writer.write_all(b"x"))
            .unwrap_err()
            .to_string();
        assert!(message.contains("missing/image.png"), "{message}");
        assert!(message.contains("--out"), "{message}");
    }

    #[test]
    fn others_may_read_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        write_whole(&path, |writer| writer.write_all(b"x")).unwrap();
        let plain = folder.path().join("plain");
        std::fs::write(&plain, b"x").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }
}
