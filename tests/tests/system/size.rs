//! `cargo xtask size --compare`: what a change cost, against what was saved before it.

use std::fs;
use std::process::Output;

use whole_system::{said, xtask};

fn size(arguments: &[&str]) -> Output {
    xtask(&["size", "--no-install"])
        .args(arguments)
        .output()
        .expect("it starts")
}

#[test]
fn what_a_change_cost_is_told_against_a_saved_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("size.json");
    let name = file.to_str().expect("UTF-8");
    let saved = size(&["--json", name]);
    assert!(saved.status.success(), "{}", said(&saved));
    // As if an image had had another constant of 12 bytes, which is gone now.
    let json = fs::read_to_string(&file).expect("the table");
    let mut images: Vec<serde_json::Value> = serde_json::from_str(&json).expect("a list");
    images[0]["itcm_bytes"] = (images[0]["itcm_bytes"].as_u64().expect("bytes") + 12).into();
    images[0]["symbols"]["once::here"] = 12.into();
    fs::write(&file, serde_json::to_string(&images).expect("JSON")).expect("a file");
    let output = size(&["--compare", name]);
    let text = said(&output);
    assert!(output.status.success(), "{text}");
    assert_eq!(text.matches("(-12)").count(), 1, "{text}");
    let symbol = text.lines().find(|line| line.ends_with("  once::here"));
    let words: Vec<&str> = symbol
        .unwrap_or_else(|| panic!("{text}"))
        .split_whitespace()
        .collect();
    assert_eq!(words, ["-12", "0", "once::here"]);
}

#[test]
fn what_is_no_saved_table_is_refused() {
    for (file, expected) in [
        (
            "Cargo.toml",
            "not what this version of `cargo xtask size --json` writes",
        ),
        ("no/such.json", "cannot read no/such.json"),
    ] {
        let output = size(&["--compare", file]);
        let text = said(&output);
        assert!(!output.status.success() && text.contains(expected), "{text}");
    }
}
