//! What a core's execution costs in cycles.
//!
//! QEMU executes instructions and knows no pipeline. So a plugin (`cycles-plugin`) records which blocks of instructions ran after
//! which, a [`flow::Recording`], and this library prices it afterwards by the
//! tables of the ARM9E-S or of the Cortex-M3: [`price()`] instruction by instruction, [`cycles()`] in all.
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

mod arm9;
pub mod branch;
pub mod class;
mod cortex_m3;
pub mod file;
pub mod flow;
pub mod options;
mod pipeline;
pub mod price;
pub mod recorder;

pub use pipeline::Estimate;
pub use price::{Assumptions, Cycles, Priced, cycles, price};
