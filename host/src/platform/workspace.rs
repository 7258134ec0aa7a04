//! Where the tree is: the checkout in which the command stands, wherever this program was compiled.
//!
//! A checkout may have been moved or copied with its `target` folder. So nothing that runs may remember a path from its build.
//! What users name is relative to the folder in which they stand; what is ours, the default scene and the default folder for results
//! included, is found from here.

use std::env;
use std::io;
use std::path::{Path, PathBuf};

/// Files that no other tree has together.
const OURS: [&str; 2] = ["Cargo.lock", "firmware/runtime/Cargo.toml"];

/// Nothing of ours around here.
#[derive(Debug, thiserror::Error)]
pub enum NoWorkspace {
    /// The current folder has been removed, or may not be entered.
    #[error("the current folder is not to be had (change into one that is there)")]
    NoFolder(#[source] io::Error),
    /// The command does not stand in a checkout.
    #[error("{} is not in a checkout of this project; change into one", .0.display())]
    Elsewhere(PathBuf),
}

/// The root of the checkout: of the current folder, or else of the package that cargo runs.
pub fn root() -> Result<PathBuf, NoWorkspace> {
    let here = env::current_dir().map_err(NoWorkspace::NoFolder)?;
    let package = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let found = root_above(&here).or_else(|| root_above(package.as_deref()?));
    found.map(Path::to_owned).ok_or(NoWorkspace::Elsewhere(here))
}

/// A file of the checkout, for people: named as short as it can be from where they stand.
pub fn file(path: &str) -> Result<PathBuf, NoWorkspace> {
    let root = root()?;
    let stands_there = env::current_dir().is_ok_and(|here| here == root);
    Ok(if stands_there {
        path.into()
    } else {
        root.join(path)
    })
}

/// The scene that a user has named, or the one that is shipped.
pub fn scene(named: Option<&Path>) -> Result<PathBuf, NoWorkspace> {
    named.map_or_else(|| file("scenes/cornell.toml"), |path| Ok(path.to_owned()))
}

/// A source file's name from the root, also where the checkout has been moved or copied since that file was compiled.
pub fn source(file: &Path) -> Option<&Path> {
    let root = root().ok()?;
    let mut rest = file.strip_prefix("/").unwrap_or(file).components();
    while !root.join(&rest).is_file() {
        rest.next()?;
    }
    Some(rest.as_path())
}

fn root_above(folder: &Path) -> Option<&Path> {
    let is_root = |folder: &&Path| OURS.iter().all(|file| folder.join(file).is_file());
    folder.ancestors().find(is_root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_that_of_the_checkout_around_a_folder_and_of_no_other() {
        let here = root().expect("tests run in the checkout");
        assert!(here.join("host/src/platform/workspace.rs").is_file());
        let other = tempfile::tempdir().expect("a folder");
        assert_eq!(root_above(other.path()), None);
        for file in OURS {
            let path = other.path().join(file);
            std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            std::fs::write(path, "").expect("a file");
        }
        for below in ["", "firmware", "firmware/runtime", "not/there/yet"] {
            assert_eq!(root_above(&other.path().join(below)), Some(other.path()));
        }
    }

    #[test]
    fn a_source_file_of_ours_is_known_wherever_it_was_compiled() {
        let name = Path::new("firmware/node/src/worker.rs");
        let ours = root().expect("tests run in the checkout").join(name);
        for file in [name, &ours, &Path::new("/moved/away").join(name)] {
            assert_eq!(source(file), Some(name));
        }
        assert_eq!(source(Path::new("/elsewhere/node/src/worker.rs")), None);
    }

    #[test]
    fn a_file_is_named_from_where_one_stands() {
        // Tests stand in the folder of their package.
        let scene = scene(None).expect("tests run in the checkout");
        assert!(scene.is_absolute() && scene.is_file(), "{}", scene.display());
    }
}
