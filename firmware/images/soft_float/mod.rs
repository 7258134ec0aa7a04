//! What the images share whose tracer computes in floating point.

use board::Core;
use floating::{Float, Lockstep};
use node::{Clock, Fault, Network, Outcome};
use runtime::image::{ImageNeeds, ImageProfile};
use runtime::memory;
use tracer::integrator::Path;
use wire::{Boot, Name};

runtime::report_panics!(Core);

// What no_float.x looks for before it refuses.
core::arch::global_asm!(
    ".globl __floating_point_is_measured",
    ".set __floating_point_is_measured, 1",
    // What memory.x looks for: they do not fit a core.
    ".globl __code_memory_is_doubled",
    ".set __code_memory_is_doubled, 1"
);

/// One core's whole life, in the format `F`.
pub(crate) fn run<F: Float>() -> ! {
    runtime::run_with::<Core>(work::<F>)
}

#[inline(never)]
fn work<F: Float>(
    boot: &Boot<'_>,
    board: Name,
    network: &mut dyn Network,
    clock: &mut dyn Clock,
) -> Result<Outcome, Fault> {
    type Numbers<F> = Lockstep<ImageProfile, F>;
    node::run::<Numbers<F>, Path<Numbers<F>, ImageNeeds>>(boot, board, network, clock, memory::stack_use)
}
