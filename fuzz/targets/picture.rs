//! OpenEXR files, as `--reference FILE` takes them: none makes the reader panic, and a picture that was read is written and read
//! again as it was.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use host::image::openexr;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fuzz_target!(|bytes: &[u8]| {
    let [given, written] = ["given.exr", "written.exr"].map(|name| FOLDER.path().join(name));
    fs::write(&given, bytes).expect("room for a small file");
    let Ok(estimate) = openexr::read(&given) else {
        return;
    };
    openexr::write(&written, &estimate).expect("what was read is written");
    assert_eq!(
        openexr::read(&written).expect("what was written is read"),
        estimate
    );
});
