//! `cargo xtask` itself: what it says while cargo builds the commands, and that it becomes them. Cargo and the commands are scripts here.

use std::fs;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;
use whole_system::{program, said, script};

/// A target folder with this program, beside commands that say who they are and what they were given.
fn folder(cargo: &str) -> TempDir {
    let folder = tempfile::Builder::new()
        .prefix("it's a ")
        .tempdir()
        .expect("a folder");
    let release = folder.path().join("release");
    fs::create_dir(&release).expect("a folder");
    // Not by this process: see `script`.
    let copied = Command::new("cp")
        .arg(program("xtask"))
        .arg(release.join("xtask"))
        .status();
    assert!(copied.expect("cp is there").success());
    script(&release.join("commands"), "echo \"$$ $# $*\"; exit 7");
    script(&folder.path().join("cargo"), cargo);
    folder
}

fn run(folder: &TempDir) -> (u32, Output) {
    let child = Command::new(folder.path().join("release/xtask"))
        .args(["render", "--out", "a folder"])
        .env("CARGO", folder.path().join("cargo"))
        .env_remove("CARGO_MANIFEST_DIR")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let process = child.id();
    (process, child.wait_with_output().expect("it ends"))
}

#[test]
fn where_nothing_is_to_be_built_it_is_the_command_and_says_nothing() {
    let (process, output) = run(&folder(
        "test \"$*\" = 'build --package commands --profile release' || exit 1; echo '    Finished `release` profile' >&2",
    ));
    assert_eq!(output.status.code(), Some(7), "{}", said(&output));
    // The same process: what is sent to it, the command gets.
    assert_eq!(said(&output), format!("{process} 3 render --out a folder\n"));
}

#[test]
fn while_cargo_builds_it_says_what_is_done_and_how_far_it_is() {
    let cargo = r#"printf '   Compiling libc v0.2\n    Building [=>  ] 3/240: libc\r' >&2; sleep 6
        printf '   Compiling exr v1.0\n    Building [==> ] 200/240: exr\r    Finished `release` profile\n' >&2"#;
    let (_, output) = run(&folder(cargo));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines[0].starts_with("cargo xtask: builds the project's commands first"),
        "{said}"
    );
    assert!(
        lines[1].starts_with("cargo xtask: 3 of 240 compiled, ") && lines[1].ends_with("now at libc"),
        "{said}"
    );
    assert!(!said.contains("Compiling"), "{said}");
}

#[test]
fn a_build_that_fails_is_an_error_with_cargo_s_own_words() {
    let (_, output) = run(&folder("echo 'error: no network' >&2; exit 101"));
    assert_eq!(output.status.code(), Some(101));
    for words in ["error: no network", "error: the project's commands did not build"] {
        assert!(said(&output).contains(words), "{}", said(&output));
    }
}

#[test]
fn what_is_missing_is_named() {
    let without = folder("exit 0");
    fs::remove_file(without.path().join("release/commands")).expect("it is there");
    let (_, output) = run(&without);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("release/commands"), "{}", said(&output));
    fs::remove_file(without.path().join("cargo")).expect("it is there");
    let (_, output) = run(&without);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("cannot run") && said(&output).contains("cargo"),
        "{}",
        said(&output)
    );
}
