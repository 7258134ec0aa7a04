//! Recorded packets, in the files that QEMU writes: none makes their reader panic.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use host::fleet::capture::Tally;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.path().join("core-0.pcap");
    fs::write(&path, bytes).expect("room for a small file");
    if let Ok(tally) = Tally::of(&path) {
        let _words = tally.to_string();
    }
});
