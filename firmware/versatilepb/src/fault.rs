//! Panics and the processor's exceptions.

use core::panic::PanicInfo;

use runtime::{exception, panicked};

use crate::Core;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    panicked::<Core>(info)
}

#[aarch32_rt::exception(Undefined)]
fn undefined(addr: usize) -> ! {
    exception::<Core>("undefined instruction", addr)
}

#[aarch32_rt::exception(PrefetchAbort)]
fn prefetch_abort(addr: usize) -> ! {
    exception::<Core>("prefetch abort", addr)
}

#[aarch32_rt::exception(DataAbort)]
fn data_abort(addr: usize) -> ! {
    exception::<Core>("data abort by the instruction", addr)
}
