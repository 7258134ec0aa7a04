//! The processor's exceptions.

use runtime::report_exception;

use crate::Core;

#[aarch32_rt::exception(Undefined)]
fn undefined(addr: usize) -> ! {
    report_exception::<Core>("undefined instruction", addr)
}

#[aarch32_rt::exception(PrefetchAbort)]
fn prefetch_abort(addr: usize) -> ! {
    report_exception::<Core>("prefetch abort", addr)
}

#[aarch32_rt::exception(DataAbort)]
fn data_abort(addr: usize) -> ! {
    report_exception::<Core>("data abort by the instruction", addr)
}
