//! What the documents say of files and of compilers is so.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 6] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "docs/porting.md",
    "docs/scene-format.md",
    "docs/random-numbers.md",
];

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn text(file: &str) -> String {
    fs::read_to_string(repository(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// All files and folders below one, but for what is built.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name");
        if name == "target" || name == ".git" || name == "out" {
            continue;
        }
        if path.is_dir() && !path.is_symlink() {
            files(&path, found);
        }
        found.push(path);
    }
}

/// What stands between single backticks and is a path of ours: of two parts at least, with no placeholder and no other sign.
fn paths(document: &str) -> impl Iterator<Item = &str> {
    let is_of_a_path = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "/._-".contains(c);
    let quoted = document.split('`').skip(1).step_by(2);
    quoted.filter(move |word| {
        // Results, what is built, and what is the user's is not in the tree.
        let elsewhere = ["out/", "cores/", "target/", "/", "~", ".."];
        word.trim_end_matches('/').contains('/')
            && word.chars().all(is_of_a_path)
            && !elsewhere.iter().any(|start| word.starts_with(start))
    })
}

#[test]
fn the_files_that_documents_name_are_there() {
    let mut all = Vec::new();
    files(&repository(""), &mut all);
    let (mut checked, mut missing) = (0, Vec::new());
    for document in DOCUMENTS {
        let text = text(document);
        // Blocks of code have three backticks, which are an odd number.
        let text = text.replace("```", "");
        for path in paths(&text) {
            checked += 1;
            // As it is from the root, or the end of a path where the text says in which folder.
            if !all.iter().any(|file| file.ends_with(path)) {
                missing.push(format!("{document}: {path}"));
            }
        }
    }
    assert!(missing.is_empty(), "not there:\n{}", missing.join("\n"));
    assert!(checked > 60, "only {checked} paths were found");
}

#[test]
fn the_oldest_compiler_is_the_same_wherever_it_is_named() {
    let oldest = env!("CARGO_PKG_RUST_VERSION");
    for (file, words) in [
        ("README.md", format!("Rust {oldest} or newer")),
        ("CONTRIBUTING.md", format!("is Rust {oldest},")),
        (".github/workflows/ci.yml", format!("rust: [\"{oldest}\",")),
    ] {
        assert!(text(file).contains(&words), "{file} does not say {words}");
    }
}
