//! Every board's build script. It hands the linker its scripts: `link.x` is the start-up crate's, and includes the workspace's
//! `memory.x`, which includes the board's `board.x`.
#![expect(clippy::print_stdout, reason = "a build script talks to cargo there")]

use std::env;

fn main() {
    let board = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let firmware = format!("{board}/..");
    let root = format!("{firmware}/..");
    for (folder, script) in [(root, "memory.x"), (firmware, "no_float.x"), (board, "board.x")] {
        println!("cargo::rustc-link-search={folder}");
        println!("cargo::rerun-if-changed={folder}/{script}");
    }
    println!("cargo::rustc-link-arg=-Tlink.x");
    println!("cargo::rustc-link-arg=-Tno_float.x");
    if env::var_os("CARGO_FEATURE_LOG").is_some() {
        // defmt's: the log's texts, which stay in the file and take no memory of the core.
        println!("cargo::rustc-link-arg=-Tdefmt.x");
    }
    // Debug information of code that was left out points to address 0 by default, which is where our code is.
    println!("cargo::rustc-link-arg=-zdead-reloc-in-nonalloc=.debug_*=0xffffffff");
}
