//! Stand-ins for programs, in tests.

use std::path::Path;
use std::process::Command;

/// Writes a program of a test: a script for `sh`. Another process writes it, because a program that any thread has open for writing while
/// another starts a process cannot be run until that has run its own.
pub(crate) fn script(path: &Path, text: &str) {
    let write = r#"printf '#!/bin/sh\n%s\n' "$2" > "$1" && chmod +x "$1""#;
    let status = Command::new("sh")
        .args(["-c", write, "sh"])
        .arg(path)
        .arg(text)
        .status();
    assert!(status.expect("a shell").success(), "{}", path.display());
}
