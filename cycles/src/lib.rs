//! What a core's execution costs in cycles.
//!
//! QEMU executes instructions and knows no pipeline. So a plugin (`cycles-plugin`) records which blocks of instructions ran after
//! which, a [`flow::Recording`], and this library prices it afterwards: [`arm9::price`] by the tables of the ARM9E-S.
//!
//! By hand, until `cargo xtask profile` does it:
//!
//! ```text
//! cargo build --release -p cycles-plugin -p cycles --example price --lib
//! mkdir /tmp/wrap && cat >/tmp/wrap/qemu-system-arm <<'END' && chmod +x /tmp/wrap/qemu-system-arm
//! #!/bin/sh
//! /usr/bin/qemu-system-arm "$@" $PLUGIN
//! END
//! ENTRY=0x$(nm --demangle=auto IMAGE | grep 'Renderer>::render' | cut -d' ' -f1)
//! export PLUGIN="-plugin $PWD/target/release/libcycles_plugin.so,isa=arm,entry=$ENTRY,out=/tmp/flow"
//! PATH=/tmp/wrap:$PATH cargo xtask render --size 64x48 --cores 1 --reference none --out /tmp/out
//! target/release/examples/price /tmp/flow IMAGE
//! ```
//!
//! The script starts QEMU as its child, which so outlives the fleet and writes the file at its own end, told to stop by its packet.
//! `IMAGE` is what the render has built last in `target/firmware/images`.
#![forbid(unsafe_code)]

pub mod access;
pub mod arm9;
pub mod class;
pub mod file;
pub mod flow;
