//! Where a command stands, and what it finds there: checkouts that were moved or copied, folders below the root, machines without rustup.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;
use whole_system::{repository, said, script, xtask};

/// A native render of a picture that takes no time.
const TINY: [&str; 9] = [
    "render",
    "--backend",
    "native",
    "--size",
    "16x12",
    "--spp",
    "4",
    "--reference",
    "none",
];

/// As much of a checkout as a command looks for, with another scene in the place of the standard one.
fn other_checkout() -> TempDir {
    let checkout = tempfile::tempdir().unwrap();
    for (file, text) in [
        ("Cargo.lock", String::new()),
        ("firmware/runtime/Cargo.toml", String::new()),
        (
            "scenes/cornell.toml",
            fs::read_to_string(repository("tests/scenes/open.toml")).unwrap(),
        ),
    ] {
        let path = checkout.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    checkout
}

/// A folder with a compiler, its library's source, a linker and an emulator, as Debian's packages put them into /usr. `cargo` is
/// what its cargo does.
fn system(cargo: &str) -> TempDir {
    let system = tempfile::tempdir().unwrap();
    let root = system.path();
    let library = root.join("lib/rustlib/src/rust/library/core/src");
    fs::create_dir_all(&library).unwrap();
    fs::write(library.join("lib.rs"), "").unwrap();
    fs::create_dir(root.join("bin")).unwrap();
    let sysroot = format!("echo '{}'", root.display());
    for (name, does) in [
        ("rustc", sysroot.as_str()),
        ("cargo", cargo),
        ("ld.lld", ""),
        ("qemu-system-arm", ""),
    ] {
        let program = root.join("bin").join(name);
        script(&program, does);
    }
    system
}

fn sha256(out: &Path) -> Value {
    let report = fs::read(out.join("report.json")).unwrap();
    serde_json::from_slice::<Value>(&report).unwrap()["image_sha256"].clone()
}

#[test]
fn a_command_works_on_the_checkout_it_stands_in_from_any_folder_of_it() {
    let checkout = other_checkout();
    let output = xtask(&TINY)
        .current_dir(checkout.path().join("firmware/runtime"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let open = repository("tests/scenes/open.toml");
    let there = tempfile::tempdir().unwrap();
    // What users name is relative to where they stand.
    fs::copy(open, there.path().join("here.toml")).unwrap();
    let words = [&TINY[..], &["here.toml", "--out", "results"]].concat();
    let output = xtask(&words).current_dir(there.path()).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    // The results of the default scene are in the checkout, beside it.
    let results = fs::read_dir(checkout.path().join("out"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    assert_eq!(sha256(&results.path()), sha256(&there.path().join("results")));
}

#[test]
fn the_firmware_is_that_of_the_checkout_where_the_command_stands() {
    let (checkout, system) = (
        other_checkout(),
        system("echo \"cargo stands in $(pwd -P)\" >&2; exit 1"),
    );
    let mut size = xtask(&["size", "--no-install"]);
    size.current_dir(checkout.path().join("scenes"));
    size.env("PATH", system.path().join("bin")).env_remove("RUSTC");
    let output = size.output().unwrap();
    let root = checkout.path().canonicalize().unwrap();
    let words = format!("cargo stands in {}\n", root.display());
    assert!(said(&output).contains(&words), "{}", said(&output));
}

#[test]
fn outside_of_a_checkout_it_says_so() {
    let elsewhere = tempfile::tempdir().unwrap();
    let mut render = xtask(&TINY);
    render
        .current_dir(elsewhere.path())
        .env_remove("CARGO_MANIFEST_DIR");
    let output = render.output().unwrap();
    assert!(!output.status.success());
    for words in [
        "is not in a checkout",
        elsewhere.path().to_str().unwrap(),
        "--out",
    ] {
        assert!(said(&output).contains(words), "{}", said(&output));
    }
}

/// A file where caches would be, and where the results would be.
#[test]
fn a_reference_that_cannot_be_kept_is_a_warning_and_a_folder_that_cannot_be_written_is_refused_first() {
    let there = tempfile::tempdir().unwrap();
    let file = there.path().join("out");
    fs::write(&file, "in the way").unwrap();
    let words = [&TINY[..7], &["--reference-spp", "4", "--out", "results"]].concat();
    let mut render = xtask(&words);
    render.current_dir(there.path()).env("XDG_CACHE_HOME", &file);
    let output = render.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    for words in ["warning", file.to_str().unwrap(), "--reference-cache"] {
        assert!(said(&output).contains(words), "{words} in: {}", said(&output));
    }
    assert!(there.path().join("results/reference.exr").is_file());

    let kept = [&words[..], &["--reference-cache", "kept"]].concat();
    let output = xtask(&kept).current_dir(there.path()).output().unwrap();
    assert!(
        output.status.success() && !said(&output).contains("warning"),
        "{}",
        said(&output)
    );
    assert_eq!(fs::read_dir(there.path().join("kept")).unwrap().count(), 1);

    let checkout = other_checkout();
    fs::write(checkout.path().join("out"), "in the way").unwrap();
    let output = xtask(&words[..9]).current_dir(checkout.path()).output().unwrap();
    assert!(!output.status.success(), "{}", said(&output));
    for words in ["cannot write to the folder out/", "--out"] {
        assert!(said(&output).contains(words), "{words} in: {}", said(&output));
    }
    assert!(!said(&output).contains("units"), "{}", said(&output));
}

/// Debian's compiler comes without a linker of its own.
#[test]
fn without_rustup_the_compiler_and_the_linker_in_path_are_taken() {
    let system = system("");
    let bin = system.path().join("bin");
    let mut toolchain = xtask(&["toolchain", "--no-install"]);
    toolchain.env("PATH", &bin).env_remove("RUSTC");
    let output = toolchain.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    for (variable, program) in [
        ("RUSTC", "rustc"),
        ("CARGO_TARGET_ARMV5TE_NONE_EABI_LINKER", "ld.lld"),
        ("CARGO_TARGET_THUMBV7M_NONE_EABI_LINKER", "ld.lld"),
    ] {
        let line = format!("export {variable}='{}'", bin.join(program).display());
        assert!(said(&output).contains(&line), "{line} in: {}", said(&output));
    }
}

#[test]
fn the_runner_of_cargo_is_found_in_a_folder_with_a_space() {
    let folder = tempfile::Builder::new().prefix("it's a ").tempdir().unwrap();
    let (runner, program) = (folder.path().join("qemu-run"), folder.path().join("the commands"));
    fs::copy(repository("firmware/qemu-run"), &runner).unwrap();
    fs::copy(whole_system::program("commands"), &program).unwrap();

    // What the shell makes of the variables is what they mean.
    let system = system("");
    let mut toolchain = std::process::Command::new(&program);
    toolchain
        .args(["toolchain", "--no-install"])
        .current_dir(repository("."));
    toolchain
        .env("PATH", system.path().join("bin"))
        .env_remove("RUSTC");
    let printed = toolchain.output().unwrap();
    assert!(printed.status.success(), "{}", said(&printed));
    let exports = String::from_utf8(printed.stdout).unwrap();
    let mut shell = std::process::Command::new("sh");
    shell
        .arg("-c")
        .arg(format!(
            "PATHS=$PATH; {exports} PATH=$PATHS; exec \"$0\" nothing.elf"
        ))
        .arg(&runner);
    let output = shell.env_remove("CARGO_MANIFEST_DIR").output().unwrap();
    // The program has been found, and says that there is no such image.
    assert!(
        said(&output).contains("cannot read") && said(&output).contains("nothing.elf"),
        "{}",
        said(&output)
    );
}

/// As on a Debian where nobody has installed rustup: its own compiler, cargo and linker are all there is in PATH.
#[test]
fn debian_s_own_compiler_and_linker_build_the_image_that_draws_the_picture() {
    let place = tempfile::tempdir().unwrap();
    let [debian, ours] = ["debian", "ours"].map(|name| place.path().join(name));
    let words = ["render", "--no-install", "--board", "versatilepb"];
    let mut render = xtask(&[&words[..], &TINY[3..]].concat());
    render.arg("--out").arg(&debian).env_clear();
    render.env("PATH", "/usr/bin:/bin").env("HOME", home());
    render.env("CARGO_TARGET_DIR", place.path().join("target"));
    let output = render.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let output = xtask(&TINY).arg("--out").arg(&ours).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(sha256(&debian), sha256(&ours));
    let images = fs::read_dir(place.path().join("target/firmware/images")).unwrap();
    let elf = images
        .map(|image| image.unwrap().path())
        .find(|path| path.extension().is_some_and(|extension| extension == "elf"))
        .unwrap();
    let comment = String::from_utf8_lossy(&fs::read(elf).unwrap()).contains("Debian LLD");
    assert!(comment, "the image says by what it was linked");
}

/// Where cargo keeps what it has downloaded.
fn home() -> std::ffi::OsString {
    std::env::var_os("HOME").expect("tests have a home")
}
