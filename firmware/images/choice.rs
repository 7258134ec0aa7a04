//! A core like any other, whose tracer has one choice of another kind than `precise`: which one says `TRACER_CHOICE`.
#![no_std]
#![no_main]

use board::Core;
use choices::{Choice, Only, Single};
use node::{Clock, Fault, Network, Outcome};
use runtime::image::ImageNeeds;
use runtime::memory;
use tracer::integrator::Path;
use tracer::kronecker::Stratified;
use wire::{Boot, Name};

runtime::report_panics!(Core);

// What memory.x looks for: what is measured need not fit a core.
core::arch::global_asm!(
    ".globl __code_memory_is_doubled",
    ".set __code_memory_is_doubled, 1"
);

type Chosen = Stratified<Single<Only<{ Choice::number(option_env!("TRACER_CHOICE")) }>>>;

#[board::entry]
fn start() -> ! {
    runtime::run_with::<Core>(work)
}

#[inline(never)]
fn work(
    boot: &Boot<'_>,
    board: Name,
    network: &mut dyn Network,
    clock: &mut dyn Clock,
) -> Result<Outcome, Fault> {
    node::run::<Chosen, Path<Chosen, ImageNeeds>>(boot, board, network, clock, memory::stack_use)
}
