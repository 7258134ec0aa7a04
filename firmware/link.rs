//! Every board's build script. It hands the linker its scripts: `link.x` is the start-up crate's, and includes the board's `memory.x`.
#![expect(clippy::print_stdout, reason = "a build script talks to cargo there")]

use std::env;

fn main() {
    let board = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let firmware = format!("{board}/..");
    for folder in [&firmware, &board] {
        println!("cargo::rustc-link-search={folder}");
    }
    for script in [format!("{firmware}/no_float.x"), format!("{board}/memory.x")] {
        println!("cargo::rerun-if-changed={script}");
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
